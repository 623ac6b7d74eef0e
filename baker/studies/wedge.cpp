#include "baker/studies/wedge.h"

#include "baker/bake/bake.h"
#include "baker/check/verify.h"
#include "baker/job/file_names.h"
#include "baker/job/job_settings.h"
#include "baker/job/options.h"
#include "baker/job/version.h"
#include "baker/output/output_folder.h"
#include "baker/output/preview.h"
#include "baker/output/say.h"
#include "baker/studies/accuracy_search.h"
#include "core/model/error.h"
#include "formats/cache/alembic_reader.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/certificate.h"
#include "formats/files/frame_statistics_table.h"
#include "formats/files/json.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <sys/file.h>
#include <unistd.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

constexpr int max_pictures = 64;

/// Held by one process at a time; the others wait.
class WaitingLock {
 public:
  explicit WaitingLock(const fs::path& file)
      : lock_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
    while (lock_ >= 0 && ::flock(lock_, LOCK_EX) != 0)
      if (errno != EINTR) break;
    if (lock_ < 0)
      throw Error(ErrorCode::folder, file.string(),
                  std::string("The output folder is not writable: ") + std::strerror(errno) + ".",
                  "Choose another with -o.");
  }
  ~WaitingLock() { ::close(lock_); }
  WaitingLock(const WaitingLock&) = delete;
  WaitingLock& operator=(const WaitingLock&) = delete;

 private:
  int lock_;
};

std::string text_or_nothing(const fs::path& file) { return read_file(file).value_or(""); }

/// A JSON object of a file; empty when there is none.
Json read_object(const fs::path& file) {
  const std::optional<Json> read = try_parse_json(text_or_nothing(file));
  return read && read->is_object() ? *read : Json::object();
}

Json literal(const Axis& axis, const std::string& value) {
  return axis.number ? parse_json(value) : Json(value);
}

/// What a variation was asked to be and to write, as far as it is known without reading the scene.
std::string inputs_key(const BakeSettings& settings) {
  std::string bytes = program_version;
  for (const auto& [name, given] : settings.given)
    if (name != "output" && name != "scene" && name != "threads" && name != "progress")
      bytes += "/" + name + "=" + given.text;
  for (const SetValue& set : settings.set) bytes += fmt::format("/{}={}", set.key, set.value);
  for (const std::string& format : settings.formats) bytes += "/" + format;
  bytes += sections_text(settings, settings.scene.parent_path());
  // presets that are files
  if (settings.preset) bytes += "/" + text_or_nothing(*settings.preset);
  for (const JobSection& sheet : settings.sheets)
    for (const JobValue& value : sheet.values)
      if (value.key == "preset") bytes += "/" + text_or_nothing(value.text);
  return hex(content_hash(bytes + "/" + text_or_nothing(settings.scene)));
}

/// The columns of a bake's results, in the order of wedge.csv.
std::vector<std::string> result_columns() {
  std::vector<std::string> names;
  visit_frame_statistics([&](const auto& field) {
    if (field.column.name) names.push_back(field.column.name);
  });
  names.push_back("crease_length_m");
  return names;
}

/// What is varied and what it is in this variation.
Json values_object(const Wedge& wedge, int index) {
  Json values = Json::object();
  const std::vector<std::string> texts = values_of(wedge.axes, index);
  for (std::size_t k = 0; k < texts.size(); ++k)
    values[wedge.axes[k].key] = literal(wedge.axes[k], texts[k]);
  return values;
}

Json progress_record(const char* type, const Wedge& wedge, int index) {
  return {{"type", type},
          {"index", index},
          {"variations", wedge.count()},
          {"folder", wedge.folder(index).string()},
          {"values", values_object(wedge, index)}};
}

Json empty_record(const Wedge& wedge, int index, const std::string& inputs) {
  Json record{{"index", index}, {"values", values_object(wedge, index)}, {"exit_code", nullptr}};
  for (const std::string& name : result_columns()) record[name] = nullptr;
  record["job_hash"] = "";
  record["folder"] = wedge.name(index);
  record["message"] = "";
  record["inputs"] = inputs;
  return record;
}

/// Frames of a certificate that have the number of the last one: one for each sheet.
std::vector<FrameRecord> last_frames(const fs::path& lines) {
  std::vector<FrameRecord> last;
  for (std::optional<FrameRecord>& record : parse_frame_lines(text_or_nothing(lines)))
    if (record) {
      if (!last.empty() && last.front().frame != record->frame) last.clear();
      last.push_back(std::move(*record));
    }
  return last;
}

/// Takes the numbers of a certificate into a record, unless it is that of another job.
void take_certificate(Json& record, const fs::path& folder, const std::string& job_hash) {
  const Json summary = read_object(folder / "cert" / "summary.json");
  if (job_hash.empty() || summary.value("job_hash", "") != job_hash) return;
  const std::vector<FrameRecord> last = last_frames(folder / "cert" / "frames.jsonl");
  const auto of_shot = [&](const std::string& pointer) {
    return summary.value(Json::json_pointer("/" + pointer), Json());
  };
  visit_frame_statistics([&](const auto& field) {
    if (!field.column.name) return;
    Json& place = record[field.column.name];
    const std::string name = field.shot_name;
    switch (field.column.value) {
      case WedgeColumn::mean:
        place = of_shot(name + "/mean");
        break;
      case WedgeColumn::largest:
        place = of_shot(name + "/max");
        break;
      case WedgeColumn::of_shot:
        place = of_shot(name);
        break;
      case WedgeColumn::last_frame: {
        double sum = 0;
        for (const FrameRecord& r : last) sum += statistic_value(r.statistics, field).value_or(0);
        place = sum;
        break;
      }
    }
  });
  record["crease_length_m"] = of_shot("crease_length_m");
}

std::string in_lines(const Json& json) { return json_lines(json) + "\n"; }

void write_record(const Wedge& wedge, int index, const Json& record) {
  write_atomically(wedge.state(index, ".json"), in_lines(record));
}

std::string cell_text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : json_line(value);
}

// ---- the table and the picture

std::string table_csv(const Wedge& wedge, const std::vector<Json>& records) {
  std::vector<std::string> columns{"exit_code"};
  for (const std::string& name : result_columns()) columns.push_back(name);
  columns.insert(columns.end(), {"job_hash", "folder"});
  std::string text = "index";
  for (const Axis& axis : wedge.axes) text += "," + axis.key;
  for (const std::string& name : columns) text += "," + name;
  for (const Json& record : records) {
    text += "\n" + cell_text(record["index"]);
    for (const Axis& axis : wedge.axes)
      text += "," + csv_field(cell_text(record["values"][axis.key]));
    for (const std::string& name : columns)
      text += "," + (record[name].is_null() ? "" : csv_field(cell_text(record[name])));
  }
  return text + "\n";
}

/// The same to be read: numbers with four digits, columns below each other.
std::string table_text(const Wedge& wedge, const std::vector<Json>& records) {
  const auto shown = [](const Json& value) {
    if (value.is_null()) return std::string("-");
    return value.is_number_float() ? fmt::format("{:.4g}", value.get<double>()) : cell_text(value);
  };
  std::vector<std::vector<std::string>> columns{{"folder"}};
  for (const Axis& axis : wedge.axes) columns.push_back({axis.key});
  columns.push_back({"exit_code"});
  for (const std::string& name : result_columns()) columns.push_back({name});
  for (const Json& record : records) {
    auto column = columns.begin();
    (column++)->push_back(shown(record["folder"]));
    for (const Axis& axis : wedge.axes) (column++)->push_back(shown(record["values"][axis.key]));
    (column++)->push_back(shown(record["exit_code"]));
    for (const std::string& name : result_columns()) (column++)->push_back(shown(record[name]));
  }
  std::vector<std::string> lines(records.size() + 1);
  for (const std::vector<std::string>& column : columns) {
    std::size_t width = 0;
    for (const std::string& text : column) width = std::max(width, text.size());
    for (std::size_t k = 0; k < column.size(); ++k)
      lines[k] += fmt::format("{}{:>{}}", lines[k].empty() ? "" : "  ", column[k], width);
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

std::string table_json(const Wedge& wedge, const std::vector<Json>& records) {
  Json keys = Json::array();
  for (const Axis& axis : wedge.axes) keys.push_back(axis.key);
  return in_lines({{"program", "paperbake"},
                   {"version", program_version},
                   {"keys", keys},
                   {"variations", records}});
}

/// What the last frame of a variation is like, as far as its files tell.
Panel last_frame(const Wedge& wedge, int index, const Json& record) {
  Panel panel;
  panel.caption.push_back(
      wedge.name(index) +
      (record["exit_code"] == 0 ? "" : fmt::format("  exit {}", json_line(record["exit_code"]))));
  for (const auto& [key, value] : record["values"].items())
    panel.caption.push_back(fmt::format("{} {}", key, cell_text(value)));
  const BakeSettings settings = wedge.settings(index);
  const fs::path folder = wedge.folder(index),
                 cache = folder /
                         (legal_shot_name(settings.name.empty() ? settings.scene.stem().string()
                                                                : settings.name,
                                          {}) +
                          ".abc");
  if (record["c_m_pct"].is_null() || !fs::is_regular_file(cache)) return panel;
  const AlembicReader reader(cache);
  for (std::size_t s = 0; s < reader.sheets().size(); ++s)
    panel.sheets.push_back(reader.frame(s, reader.sheets()[s].frames - 1));
  const std::vector<HandleRecord> handles =
      parse_handles_csv(text_or_nothing(folder / "cert" / "handles.csv"));
  for (const HandleRecord& handle : handles)
    if (handle.frame == handles.back().frame && handle.state != HandleFrame::free)
      panel.handles.push_back(handle);
  return panel;
}

Image picture(const Wedge& wedge, const std::vector<Json>& records) {
  std::vector<Panel> panels;
  for (const Json& record : records)
    if (static_cast<int>(panels.size()) < max_pictures)
      panels.push_back(last_frame(wedge, record["index"], record));
  const std::string first =
      panels.size() < records.size() ? fmt::format("the first {} of ", panels.size()) : "";
  return contact_sheet(fmt::format("{}, {}{} variations, last frames",
                                   wedge.common.scene.stem().string(), first, records.size()),
                       panels);
}

int code_of(const std::vector<Json>& records) {
  int worst = 0;
  bool missed = false;
  for (const Json& record : records) {
    const int code = record["exit_code"];
    if (code == gate_missed)
      missed = true;
    else
      worst = std::max(worst, code);
  }
  return worst > 0 ? worst : missed ? gate_missed : 0;
}

}  // namespace

Wedge::Wedge(BakeSettings settings, std::vector<Axis> varied)
    : common(std::move(settings)), axes(std::move(varied)), output(common.output) {
  common.formats.insert({"abc", "cert"});
  if (!common.given.count("threads")) common.threads = 1;
}

std::string Wedge::name(int index) const {
  return fmt::format("{:0{}}", index, std::max<std::size_t>(4, std::to_string(count()).size()));
}

std::filesystem::path Wedge::state(int index, const char* ending) const {
  return output / ".state" / (name(index) + ending);
}

BakeSettings Wedge::settings(int index) const {
  BakeSettings settings = varied(common, axes, index);
  settings.output = folder(index);
  if (settings.debug_pictures) settings.debug_pictures = *settings.debug_pictures / name(index);
  return settings;
}

int bake_variation(const Wedge& wedge, int index, const std::function<bool()>& stop) {
  if (index < 1 || index > wedge.count())
    throw Error(ErrorCode::command, fmt::format("--index {}", index),
                fmt::format("There are variations 1 to {}.", wedge.count()));
  make_folder(wedge.output / ".state");
  const WaitingLock mine(wedge.state(index, ".lock"));
  BakeSettings settings = wedge.settings(index);
  const std::string inputs = inputs_key(settings);
  Json record = empty_record(wedge, index, inputs);
  forget_end(wedge, index);
  try {
    const BakePlan plan = plan_with_accuracy(settings, [](const std::string&) {});
    record["job_hash"] = plan.job_hash;
    record["exit_code"] = bake_with_progress(settings, plan, stop).exit_code;
  } catch (const Error& error) {
    if (error.code == ErrorCode::stopped) throw;
    record["exit_code"] = static_cast<int>(error.code);
    record["message"] = error.what();
  } catch (const std::exception& error) {
    record["exit_code"] = static_cast<int>(ErrorCode::simulation);
    record["message"] = error.what();
  }
  if (record["message"] != "") say_line("paperbake: " + record["message"].get<std::string>());
  take_certificate(record, wedge.folder(index), record["job_hash"]);
  write_record(wedge, index, record);
  return record["exit_code"];
}

std::string describe_variation(const Wedge& wedge, int index) {
  const Json record = read_object(wedge.state(index, ".json"));
  std::string line = wedge.name(index);
  const Json values = record.value("values", Json::object());
  for (const auto& [key, value] : values.items())
    line += fmt::format(" {}={}", key, cell_text(value));
  const std::string message = record.value("message", "");
  return line + fmt::format(": exit code {}", json_line(record.value("exit_code", Json()))) +
         (message.empty() ? "" : "\n" + message);
}

std::string variation_start(const Wedge& wedge, int index) {
  return json_line(progress_record("variation_start", wedge, index));
}

std::string variation_end(const Wedge& wedge, int index, int ended) {
  const Json record = read_object(wedge.state(index, ".json"));
  const std::string message = record.value("message", "");
  Json told = progress_record("variation_end", wedge, index);
  told["ended"] = ended;
  told["exit_code"] = record.value("exit_code", Json());
  told["error"] = message.empty() ? Json() : Json(message);
  return json_line(told);
}

std::vector<std::string> folders_left(const Wedge& wedge) {
  std::set<std::string> own;
  for (int index = 1; index <= wedge.count(); ++index) own.insert(wedge.name(index));
  std::vector<std::string> left;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(wedge.output / ".state", none)) {
    const fs::path& lock = entry.path();  // which every variation has
    const std::string name = lock.stem().string();
    const bool is_number = name.find_first_not_of("0123456789") == std::string::npos;
    if (lock.extension() == ".lock" && is_number && own.count(name) == 0 &&
        fs::is_directory(wedge.output / name, none))
      left.push_back(name);
  }
  std::sort(left.begin(), left.end());
  return left;
}

void forget_end(const Wedge& wedge, int index) {
  std::error_code none;
  fs::remove(wedge.state(index, ".json"), none);
}

void note_end(const Wedge& wedge, int index, int exit_code) {
  const WaitingLock mine(wedge.state(index, ".lock"));
  const std::string inputs = inputs_key(wedge.settings(index));
  if (read_object(wedge.state(index, ".json")).value("inputs", "") == inputs) return;
  Json record = empty_record(wedge, index, inputs);
  record["exit_code"] = exit_code;
  record["message"] =
      fmt::format("It ended before its time; see {}.", wedge.state(index, ".log").string());
  write_record(wedge, index, record);
}

WedgeOutcome finish_wedge(const Wedge& wedge) {
  const WaitingLock one_at_a_time(wedge.output / ".state" / "table.lock");
  WedgeOutcome outcome;
  std::vector<Json> records;
  for (int index = 1; index <= wedge.count(); ++index) {
    Json record = read_object(wedge.state(index, ".json"));
    if (record.value("inputs", "") != inputs_key(wedge.settings(index))) return outcome;
    record.erase("inputs");
    records.push_back(std::move(record));
  }
  outcome.complete = true;
  outcome.exit_code = code_of(records);
  const fs::path csv = wedge.output / "wedge.csv", json = wedge.output / "wedge.json",
                 png = wedge.output / "wedge.png";
  outcome.files = {csv, json, png};
  outcome.table = table_text(wedge, records);
  const std::string table = table_csv(wedge, records), text = table_json(wedge, records);
  if (fs::is_regular_file(png) && text_or_nothing(csv) == table && text_or_nothing(json) == text)
    return outcome;
  write_atomically(csv, table);
  write_png(png, picture(wedge, records));
  write_atomically(json, text);  // the last: with it the others are known to be of the same bakes
  return outcome;
}

}  // namespace paperbake
