#include "formats/files/certificate.h"

#include "core/model/error.h"
#include "formats/files/frame_statistics_table.h"
#include "formats/files/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

namespace paperbake {
namespace {

/// Returns the number if it is finite: NaN and infinity in a certificate are failures of the
/// simulation. throws Error(ErrorCode::simulation) with frame, sheet and field
double finite(double value, const char* field, int frame, const std::string& sheet) {
  if (std::isfinite(value)) return value + 0.0;  // + 0.0 turns -0 into 0
  throw Error(ErrorCode::simulation, fmt::format("frame {}, sheet \"{}\"", frame, sheet),
              fmt::format("The certificate's {} is not a finite number.", field));
}

/// In the order of HandleFrame::State.
constexpr const char* state_names[] = {"free", "held", "soft", "jammed"};

std::optional<HandleFrame::State> state_of(const std::string& name) {
  const auto* const found = std::find(std::begin(state_names), std::end(state_names), name);
  if (found == std::end(state_names)) return std::nullopt;
  return static_cast<HandleFrame::State>(found - std::begin(state_names));
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
    else if (c == '\n' && !quoted) {
      rows.push_back(std::move(row));
      row.assign(1, "");
    } else
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
  Json line;
  line["frame"] = r.frame;
  line["sheet"] = r.sheet;
  visit_frame_statistics([&](const auto& field) {
    if (!field.name) return;
    const auto* value = find_statistic(r.statistics, field);
    Json& place = line[field.name];
    if (!value) return;  // null
    if constexpr (std::is_floating_point_v<typename std::decay_t<decltype(field)>::Value>)
      place = finite(field.unit.of(*value), field.name, r.frame, r.sheet);
    else
      place = *value;
  });
  const auto place = [&](bool exists, const Vector2d& at, const char* field) -> Json {
    if (!exists) return {};
    return {finite(1e3 * at.x(), field, r.frame, r.sheet),
            finite(1e3 * at.y(), field, r.frame, r.sheet)};
  };
  const WorstPlaces& worst = r.worst;
  line["render_stretch_at_mm"] =
      place(r.statistics.render.has_value(), worst.stretch_at, "render_stretch_at_mm");
  line["inside_at_mm"] = place(!worst.inside_of.empty(), worst.inside_at, "inside_at_mm");
  line["inside_of"] = worst.inside_of.empty() ? Json() : Json(worst.inside_of);
  if (r.twin) line["twin_pct"] = finite(100 * *r.twin, "twin_pct", r.frame, r.sheet);
  line["jammed"] = Json::array();
  for (const Jam& jam : r.jammed) {
    Json& entry = line["jammed"].emplace_back(
        Json::array({jam.handle, finite(jam.off_mm, "jammed", r.frame, r.sheet)}));
    if (!jam.taut_to.empty()) entry.push_back(jam.taut_to);
  }
  line["note"] = r.note;
  line["input_hash"] = r.input_hash;
  line["content_hash"] = r.content_hash;
  // names come from scene files in any encoding: bytes that are not UTF-8 must not stop the bake
  return json_line(line);
}

std::optional<FrameRecord> parse_frame_line(const std::string& text) try {
  const Json line = parse_json(text);
  FrameRecord r;
  r.frame = line.at("frame");
  r.sheet = line.at("sheet");
  if (const auto found = line.find("render_triangles"); found != line.end() && !found->is_null())
    r.statistics.render.emplace();
  visit_frame_statistics([&](const auto& field) {
    auto* value = find_statistic(r.statistics, field);
    if (!field.name || !value || !line.contains(field.name)) return;
    using Value = typename std::decay_t<decltype(field)>::Value;
    const Json& place = line[field.name];
    if constexpr (std::is_floating_point_v<Value>)
      *value = field.unit.to_si(place.get<double>());
    else
      *value = place.get<Value>();
  });
  const auto read_place = [&](const char* field, Vector2d& at) {
    const auto found = line.find(field);
    if (found == line.end() || found->is_null()) return;
    at << 1e-3 * found->at(0).get<double>(), 1e-3 * found->at(1).get<double>();
  };
  read_place("render_stretch_at_mm", r.worst.stretch_at);
  read_place("inside_at_mm", r.worst.inside_at);
  if (const auto of = line.find("inside_of"); of != line.end() && !of->is_null())
    r.worst.inside_of = *of;
  if (const auto twin = line.find("twin_pct"); twin != line.end() && twin->is_number())
    r.twin = 0.01 * twin->get<double>();
  for (const Json& jam : line.at("jammed"))
    r.jammed.push_back(
        {jam.at(0), jam.at(1), jam.size() > 2 ? jam.at(2).get<std::string>() : std::string()});
  r.note = line.at("note");
  r.input_hash = line.at("input_hash");
  r.content_hash = line.at("content_hash");
  return r;
} catch (const Json::exception&) {
  return std::nullopt;
}

std::vector<std::optional<FrameRecord>> parse_frame_lines(const std::string& text) {
  std::vector<std::optional<FrameRecord>> records;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) records.push_back(parse_frame_line(line));
  return records;
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
                       state_names[r.state]);
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
    const std::optional<HandleFrame::State> state = good ? state_of(f[11]) : std::nullopt;
    if (!state)
      throw Error(ErrorCode::scene, fmt::format("handles.csv, row {}", k + 1),
                  "This version of paperbake does not write such a row.");
    r.frame = static_cast<int>(n[0]);
    r.sheet = f[1];
    r.handle = f[2];
    r.pattern << n[1], n[2];
    r.keyed << n[3], n[4], n[5];
    r.held << n[6], n[7], n[8];
    r.state = *state;
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
