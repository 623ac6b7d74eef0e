#include "formats/files/certificate.h"

#include "core/model/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

namespace paperbake {
namespace {

/// Returns the number if it is finite: NaN and infinity in a certificate are failures of the
/// simulation. throws Error(ErrorCode::simulation) with frame, sheet and field
double finite(double value, const char* field, int frame, const std::string& sheet) {
  if (std::isfinite(value)) return value + 0.0;  // + 0.0 turns -0 into 0
  throw Error(Fault::simulation, fmt::format("frame {}, sheet \"{}\"", frame, sheet),
              fmt::format("The certificate's {} is not a finite number.", field));
}

const char* state_name(HandleRecord::State state) {
  switch (state) {
    case HandleRecord::held_state:
      return "held";
    case HandleRecord::free_state:
      return "free";
    case HandleRecord::jammed_state:
      return "jammed";
  }
  return "";
}

/// The rows of a CSV text according to RFC 4180: a quoted field may contain commas and line ends.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row{""};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      row.back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      row.emplace_back();
    else if (c == '\n' && !quoted)
      rows.push_back(std::move(row)), row.assign(1, "");
    else
      row.back() += c;
  }
  if (row.size() > 1) rows.push_back(std::move(row));
  return rows;
}

bool read_number(const std::string& text, double& value) {
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

}  // namespace

std::string frame_line(const FrameRecord& r) {
  nlohmann::ordered_json line;
  const auto add = [&](const char* field, double value) {
    line[field] = finite(value, field, r.frame, r.sheet);
  };
  line["frame"] = r.frame;
  line["sheet"] = r.sheet;
  line["triangles"] = r.triangles;
  add("stretch_mean_pct", r.stretch_mean_pct);
  add("stretch_max_pct", r.stretch_max_pct);
  add("angle_defect_max_deg", r.angle_defect_max_deg);
  add("handle_err_max_mm", r.handle_err_max_mm);
  line["singular"] = r.singular;
  line["new_singular"] = r.new_singular;
  add("elastic_ms", r.elastic_ms);
  add("geometry_ms", r.geometry_ms);
  line["substeps"] = r.substeps;
  line["newton_iterations"] = r.newton_iterations;
  line["converged"] = r.converged;
  add("energy_J", r.energy_J);
  for (const char* field : {"render_triangles", "render_stretch_mean_pct", "render_stretch_max_pct",
                            "render_ms", "render_crossings", "render_crossings_with_others"})
    line[field] = nullptr;
  if (r.render) {
    line["render_triangles"] = r.render->triangles;
    add("render_stretch_mean_pct", r.render->stretch_mean_pct);
    add("render_stretch_max_pct", r.render->stretch_max_pct);
    add("render_ms", r.render->ms);
    line["render_crossings"] = r.render->crossings;
    line["render_crossings_with_others"] = r.render->crossings_with_others;
  }
  line["crossings"] = r.crossings;
  line["crossings_with_others"] = r.crossings_with_others;
  line["touching"] = r.touching;
  line["touching_others"] = r.touching_others;
  line["on_colliders"] = r.on_colliders;
  add("inside_mm", r.inside_mm);
  line["jammed"] = nlohmann::ordered_json::array();
  for (const Jam& jam : r.jammed)
    line["jammed"].push_back(nlohmann::ordered_json::array(
        {jam.handle, finite(jam.off_mm, "jammed", r.frame, r.sheet)}));
  line["note"] = r.note;
  line["input_hash"] = r.input_hash;
  line["content_hash"] = r.content_hash;
  // names come from scene files in any encoding: bytes that are not UTF-8 must not stop the bake
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string handles_csv(const std::vector<HandleRecord>& records) {
  std::string csv = "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state\n";
  for (const HandleRecord& r : records) {
    const auto number = [&](double value, const char* field) {
      return finite(value, field, r.frame, r.sheet);
    };
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", r.frame, csv_field(r.sheet),
                       csv_field(r.handle), number(r.pattern.x(), "u"), number(r.pattern.y(), "v"),
                       number(r.keyed.x(), "keyed_x"), number(r.keyed.y(), "keyed_y"),
                       number(r.keyed.z(), "keyed_z"), number(r.held.x(), "held_x"),
                       number(r.held.y(), "held_y"), number(r.held.z(), "held_z"),
                       state_name(r.state));
  }
  return csv;
}

std::vector<HandleRecord> parse_handles_csv(const std::string& text) {
  std::vector<HandleRecord> records;
  const std::vector<std::vector<std::string>> rows = parse_csv(text);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string>& f = rows[k];
    HandleRecord r;
    double n[9];
    bool good = f.size() == 12 && read_number(f[0], n[0]) &&
                std::abs(n[0]) <= std::numeric_limits<int>::max();
    for (int i = 0; i < 8 && good; ++i) good = read_number(f[3 + i], n[1 + i]);
    if (!good || (f[11] != "held" && f[11] != "free" && f[11] != "jammed"))
      throw Error(Fault::scene, fmt::format("handles.csv, row {}", k + 1),
                  "This version of paperbake does not write such a row.");
    r.frame = static_cast<int>(n[0]);
    r.sheet = f[1], r.handle = f[2];
    r.pattern << n[1], n[2];
    r.keyed << n[3], n[4], n[5];
    r.held << n[6], n[7], n[8];
    r.state = f[11] == "held"   ? HandleRecord::held_state
              : f[11] == "free" ? HandleRecord::free_state
                                : HandleRecord::jammed_state;
    records.push_back(std::move(r));
  }
  return records;
}

std::string singular_csv(const std::vector<SingularRecord>& records) {
  std::vector<const SingularRecord*> by_birth;
  for (const SingularRecord& r : records) by_birth.push_back(&r);
  std::stable_sort(by_birth.begin(), by_birth.end(), [](const auto* p, const auto* q) {
    return p->point.frame_of_birth < q->point.frame_of_birth;
  });

  std::string csv = "id,sheet,frame,u,v,cause\n";
  std::map<std::string, int> born;  // points of each sheet so far
  for (const SingularRecord* r : by_birth) {
    const int frame = r->point.frame_of_birth;
    csv +=
        fmt::format("{},{},{},{},{},{}\n", ++born[r->sheet], csv_field(r->sheet), frame,
                    finite(r->point.pattern.x(), "u", frame, r->sheet),
                    finite(r->point.pattern.y(), "v", frame, r->sheet), csv_field(r->point.cause));
  }
  return csv;
}

}  // namespace paperbake
