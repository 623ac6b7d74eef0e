#include "baker/output/progress.h"

#include "baker/job/version.h"
#include "baker/output/say.h"
#include "core/model/error.h"
#include "formats/files/json.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <mutex>
#include <unistd.h>

namespace paperbake {
namespace {

std::mutex under_way_mutex;
Progress* under_way = nullptr;  // that of the bake, from start() on

std::string clock_text(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

void print_json(const Json& object) { say_line(json_line(object)); }

std::string result_of(const ProgressEnd& end) {
  switch (end.exit_code) {
    case 0:
      return "done";
    case 4:
      return "gates missed";
    case 5:
      return "stopped";
    default:
      return "failed";
  }
}

/// One line, whatever it had.
std::string one_line(const std::string& text) {
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != '\n')
      line += text[i];
    else if (i + 1 < text.size())
      line += ' ';
  return line;
}

}  // namespace

Progress::Progress(ProgressMode mode, int frames, Passes passes)
    : passes_(passes),
      simulate_{"simulated", frames},
      render_{"rendered", frames},
      begun_(std::chrono::steady_clock::now()),
      last_(begun_) {
  switch (mode) {
    case ProgressMode::automatic:
      style_ = isatty(STDERR_FILENO) ? Style::bar : Style::plain;
      break;
    case ProgressMode::plain:
      style_ = Style::plain;
      break;
    case ProgressMode::json:
      style_ = Style::json;
      break;
    case ProgressMode::none:
      style_ = Style::none;
      break;
  }
}

Progress::Progress(std::function<void(const ProgressStep&)> on_step,
                   std::function<void(const std::string&)> on_message, int frames, Passes passes)
    : Progress(ProgressMode::none, frames, passes) {
  style_ = Style::functions;
  on_step_ = std::move(on_step);
  on_message_ = std::move(on_message);
}

Progress::~Progress() {
  {
    const std::lock_guard lock(under_way_mutex);
    if (under_way == this) under_way = nullptr;
  }
  if (bar_open_) paperbake::say("\n");
}

void Progress::log_to(const std::filesystem::path& path) {
  log_.reset(std::fopen(path.c_str(), "a"));
  if (!log_)
    throw Error(ErrorCode::folder, path.string(),
                fmt::format("The log cannot be written: {}.", std::strerror(errno)),
                "Choose another file with --log.");
}

/// The log is read while it grows; a disk that is full costs the log alone.
void Progress::log(const std::string& line) {
  if (!log_) return;
  fmt::print(log_.get(), "{:%Y-%m-%dT%H:%M:%SZ} {}\n", fmt::gmtime(std::time(nullptr)),
             one_line(line));
  std::fflush(log_.get());
}

void Progress::start(const ProgressStart& start) {
  {
    const std::lock_guard lock(under_way_mutex);
    under_way = this;
  }
  several_sheets_ = start.sheets.size() > 1;
  log(fmt::format("paperbake {}: {}, frames {}-{}, to {}", program_version, start.name,
                  start.frames.first, start.frames.last, start.output.string()));
  if (style_ != Style::json) return;
  print_json({{"type", "start"},
              {"version", program_version},
              {"name", start.name},
              {"output", start.output.string()},
              {"first_frame", start.frames.first},
              {"last_frame", start.frames.last},
              {"frame_step", start.frames.step},
              {"frames", simulate_.frames},
              {"passes", passes_ == Passes::simulate ? 1 : 2},
              {"sheets", start.sheets},
              {"job_hash", start.job_hash}});
}

bool Progress::end_abruptly(const Error& error) {
  const std::lock_guard lock(under_way_mutex);
  if (!under_way || under_way->ended_) return false;
  under_way->ended_ = true;
  under_way->tell_end({static_cast<int>(error.code), {}, {}, error.what()});
  return true;
}

void Progress::end(const ProgressEnd& end) {
  const std::lock_guard lock(under_way_mutex);
  if (ended_.exchange(true)) return;
  tell_end(end);
}

void Progress::tell_end(const ProgressEnd& end) {
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  log(fmt::format("{} after {}, exit code {}{}", result_of(end), clock_text(seconds), end.exit_code,
                  end.error.empty() ? "" : ": " + end.error));
  if (style_ == Style::json)
    return print_json({{"type", "end"},
                       {"exit_code", end.exit_code},
                       {"result", result_of(end)},
                       {"seconds", seconds},
                       {"gates_missed", end.gates_missed},
                       {"files",
                        [&] {
                          std::vector<std::string> files;
                          for (const auto& file : end.files) files.push_back(file.string());
                          return files;
                        }()},
                       {"error", end.error.empty() ? Json() : Json(end.error)}});
  if (style_ != Style::none || end.gates_missed.empty()) return;
  const std::size_t more = end.gates_missed.size() - 1;
  say_line(fmt::format("gate missed: {}{}", end.gates_missed.front(),
                       more > 0 ? fmt::format(" ({} more in cert/summary.json)", more) : ""));
}

void Progress::simulated(const FrameRecord& record) {
  const auto taken = taken_.find(record.sheet);
  if (taken == taken_.end() || record.frame > taken->second)
    return frame(simulate_, record, record.statistics.stretch_mean, record.statistics.triangles);
  ++simulate_.done;
  ++simulate_.taken;
  if (on_step_)
    on_step_({simulate_.name, record.sheet, record.frame, simulate_.done, simulate_.frames});
  last_ = std::chrono::steady_clock::now();
}

void Progress::taken(const std::string& sheet, int last_frame) { taken_[sheet] = last_frame; }

void Progress::begin_again() {
  simulate_ = {simulate_.name, simulate_.frames};
  taken_.clear();
  last_ = std::chrono::steady_clock::now();
}

void Progress::rendered(const FrameRecord& record) {
  frame(render_, record, record.statistics.render->stretch_mean,
        record.statistics.render->triangles);
}

/// A pass that has not begun is not counted: what it will take is not known.
double Progress::seconds_left() const {
  double left = 0;
  for (const Pass* pass : {&simulate_, &render_})
    if (const int own = pass->done - pass->taken; own > 0)
      left += (own > 1 ? (pass->seconds - pass->first) / (own - 1) : pass->seconds) *
              (pass->frames - pass->done);
  return left;
}

std::string Progress::frame_text(const Pass& pass, const FrameRecord& record,
                                 double stretch_mean) const {
  const int points = record.statistics.singular;
  const std::string of = record.frame == pass.done
                             ? fmt::format("{} of {}", record.frame, pass.frames)
                             : fmt::format("{} ({} of {})", record.frame, pass.done, pass.frames);
  return fmt::format("{}{} frame {}, {} left, stretched {:.3f} %, {}",
                     several_sheets_ ? record.sheet + ": " : "", pass.name, of,
                     clock_text(seconds_left()), 100 * stretch_mean,
                     points == 1 ? "1 sharp point" : fmt::format("{} sharp points", points));
}

void Progress::frame(Pass& pass, const FrameRecord& record, double stretch_mean, int triangles) {
  if (ended_) return;
  ++pass.done;
  const auto now = std::chrono::steady_clock::now();
  pass.seconds += std::chrono::duration<double>(now - last_).count();
  if (pass.done - pass.taken == 1) pass.first = pass.seconds;
  last_ = now;
  if (on_step_) on_step_({pass.name, record.sheet, record.frame, pass.done, pass.frames});
  const std::string text = frame_text(pass, record, stretch_mean);
  log(text);
  switch (style_) {
    case Style::none:
    case Style::functions:
      return;
    case Style::bar: {
      constexpr int width = 20;
      const int steps = simulate_.frames + (passes_ == Passes::simulate ? 0 : render_.frames),
                full = width * (simulate_.done + render_.done) / std::max(1, steps);
      // clear to the end of the line: the text before may have been longer
      paperbake::say(fmt::format("\r[{:=<{}}{: <{}}] {}\033[K", "", full, "", width - full, text));
      bar_open_ = true;
      return;
    }
    case Style::plain:
      say_line(text);
      return;
    case Style::json:
      return print_json({{"type", "frame"},
                         {"sheet", record.sheet},
                         {"frame", record.frame},
                         {"pass", pass.name},
                         {"done", pass.done},
                         {"frames", pass.frames},
                         {"seconds_left", seconds_left()},
                         {"stretch_mean_pct", 100 * stretch_mean},
                         {"triangles", triangles},
                         {"singular", record.statistics.singular}});
  }
}

void Progress::say(const char* type, const char* prefix, const std::string& sentence) {
  if (ended_) return;
  if (on_message_) on_message_(prefix + sentence);
  log(prefix + sentence);
  if (style_ == Style::none || style_ == Style::functions) return;
  if (style_ == Style::json) return print_json({{"type", type}, {"message", sentence}});
  if (bar_open_) paperbake::say("\n");
  bar_open_ = false;
  say_line(prefix + sentence);
}

}  // namespace paperbake
