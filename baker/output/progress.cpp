#include "baker/output/progress.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace paperbake {
namespace {

std::string clock_text(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

Progress::Progress(ProgressMode mode, int frames, Passes passes)
    : frames_(frames), passes_(passes), last_(std::chrono::steady_clock::now()) {
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
  on_step_ = std::move(on_step);
  on_message_ = std::move(on_message);
}

Progress::~Progress() {
  if (bar_open_) fmt::print(stderr, "\n");
}

void Progress::simulated(const FrameRecord& record) {
  const auto taken = taken_.find(record.sheet);
  if (taken == taken_.end() || record.frame > taken->second)
    return frame(simulate_, record, record.statistics.stretch_mean, record.statistics.triangles);
  ++simulate_.done;
  ++simulate_.taken;
  if (on_step_) on_step_({simulate_.name, record.sheet, record.frame, simulate_.done, frames_});
  last_ = std::chrono::steady_clock::now();
}

void Progress::taken(const std::string& sheet, int last_frame) { taken_[sheet] = last_frame; }

void Progress::rendered(const FrameRecord& record) {
  frame(render_, record, record.statistics.render->stretch_mean,
        record.statistics.render->triangles);
}

/// A pass that has not begun is not counted: what it will take is not known.
double Progress::seconds_left() const {
  double left = 0;
  for (const Pass* pass : {&simulate_, &render_})
    if (pass->done > pass->taken)
      left += pass->seconds / (pass->done - pass->taken) * (frames_ - pass->done);
  return left;
}

void Progress::frame(Pass& pass, const FrameRecord& record, double stretch_mean, int triangles) {
  ++pass.done;
  const double stretch_mean_pct = 100 * stretch_mean;
  const auto now = std::chrono::steady_clock::now();
  pass.seconds += std::chrono::duration<double>(now - last_).count();
  last_ = now;
  if (on_step_) on_step_({pass.name, record.sheet, record.frame, pass.done, frames_});
  const int steps = passes_ == Passes::simulate ? frames_ : 2 * frames_;
  switch (style_) {
    case Style::none:
      return;
    case Style::bar: {
      constexpr int width = 30;
      const int full = width * (simulate_.done + render_.done) / std::max(1, steps);
      fmt::print(stderr, "\r[{:=<{}}{: <{}}] {} frame {}  {} left  c_m {:.4f} %  {} triangles ", "",
                 full, "", width - full, pass.name, record.frame, clock_text(seconds_left()),
                 stretch_mean_pct, triangles);
      std::fflush(stderr);
      bar_open_ = true;
      return;
    }
    case Style::plain:
      fmt::print(
          stderr,
          "{} {} frame {} ({}/{})  {} left  c_m {:.4f} %  {} triangles  {} singular points\n",
          record.sheet, pass.name, record.frame, pass.done, frames_, clock_text(seconds_left()),
          stretch_mean_pct, triangles, record.statistics.singular);
      return;
    case Style::json:
      fmt::print(stderr, "{}\n",
                 nlohmann::ordered_json{{"sheet", record.sheet},
                                        {"frame", record.frame},
                                        {"pass", pass.name},
                                        {"done", pass.done},
                                        {"frames", frames_},
                                        {"seconds_left", seconds_left()},
                                        {"stretch_mean_pct", stretch_mean_pct},
                                        {"triangles", triangles},
                                        {"singular", record.statistics.singular}}
                     .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
      return;
  }
}

void Progress::message(const std::string& sentence) {
  if (on_message_) on_message_(sentence);
  if (style_ == Style::none) return;
  if (style_ == Style::json) {
    fmt::print(stderr, "{}\n", nlohmann::json{{"message", sentence}}.dump());
    return;
  }
  if (bar_open_) fmt::print(stderr, "\n");
  bar_open_ = false;
  fmt::print(stderr, "{}\n", sentence);
}

}  // namespace paperbake
