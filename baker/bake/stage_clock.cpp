#include "baker/bake/stage_clock.h"

#include <algorithm>

namespace paperbake {
namespace {

constexpr const char* names[stages] = {"plan",  "simulate",    "attempts",      "record",
                                       "maps",  "render_mesh", "render_frames", "keep_apart",
                                       "judge", "caches",      "keep",          "certificate"};

thread_local StageClock::Part* innermost = nullptr;

/// CPU time of all threads. [ms]
double process_ms() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

}  // namespace

StageClock::StageClock() { add(Stage::plan, process_ms()); }

void StageClock::add(Stage stage, double ms) {
  const std::lock_guard lock(mutex_);
  ms_[static_cast<std::size_t>(stage)] += ms;
}

StageClock::Part::Part(StageClock* clock, Stage stage)
    : clock_(clock), stage_(stage), outer_(innermost), since_(cpu_ms()) {
  if (outer_) outer_->add_up();
  innermost = this;
}

/// Hands on the time since the last call.
void StageClock::Part::add_up() {
  const double now = cpu_ms();
  if (clock_) clock_->add(stage_, now - since_);
  since_ = now;
}

StageClock::Part::~Part() {
  add_up();
  if (outer_) outer_->since_ = since_;
  innermost = outer_;
}

std::map<std::string, double> StageClock::seconds() {
  if (innermost) innermost->add_up();
  const std::lock_guard lock(mutex_);
  const double all = process_ms();
  std::map<std::string, double> seconds{{"all", 1e-3 * all}};
  double rest = all;
  for (std::size_t k = 0; k < stages; ++k) {
    seconds[names[k]] = 1e-3 * ms_[k];
    rest -= ms_[k];
  }
  seconds["rest"] = 1e-3 * std::max(0.0, rest);
  return seconds;
}

}  // namespace paperbake
