#include "baker/progress.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace paperbake {
namespace {

std::string clock_text(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60) : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

Progress::Progress(ProgressMode mode, int frames) : frames_(frames), begun_(std::chrono::steady_clock::now()) {
  switch (mode) {
    case ProgressMode::automatic: style_ = isatty(STDERR_FILENO) ? Style::bar : Style::plain; break;
    case ProgressMode::plain: style_ = Style::plain; break;
    case ProgressMode::json: style_ = Style::json; break;
    case ProgressMode::none: style_ = Style::none; break;
  }
}

Progress::~Progress() {
  if (bar_open_) fmt::print(stderr, "\n");
}

void Progress::frame(const std::string& sheet, int frame, double stretch_mean_pct, int triangles, int singular) {
  ++done_;
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  const double left = spent / done_ * (frames_ - done_);
  switch (style_) {
    case Style::none: return;
    case Style::bar: {
      constexpr int width = 30;
      const int full = width * done_ / std::max(1, frames_);
      fmt::print(stderr, "\r[{:=<{}}{: <{}}] frame {}  {} left  c_m {:.4f} %  {} triangles ", "", full, "", width - full, frame,
                 clock_text(left), stretch_mean_pct, triangles);
      std::fflush(stderr);
      bar_open_ = true;
      return;
    }
    case Style::plain:
      fmt::print(stderr, "{} frame {} ({}/{})  {} left  c_m {:.4f} %  {} triangles  {} singular points\n", sheet, frame, done_,
                 frames_, clock_text(left), stretch_mean_pct, triangles, singular);
      return;
    case Style::json:
      fmt::print(stderr, "{}\n", nlohmann::ordered_json{{"sheet", sheet}, {"frame", frame}, {"done", done_}, {"frames", frames_},
                                                        {"seconds_left", left}, {"stretch_mean_pct", stretch_mean_pct},
                                                        {"triangles", triangles}, {"singular", singular}}.dump());
      return;
  }
}

void Progress::say(const std::string& sentence) {
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
