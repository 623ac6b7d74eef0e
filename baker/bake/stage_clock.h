#pragma once

#include "core/animation/cpu_clock.h"

#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace paperbake {

/// What a bake spends its time on.
enum class Stage {
  plan,  // everything before the bake: reading the scene, deciding
  simulate,
  attempts,  // others than the first
  record,    // lines of the certificate, crease attributes
  maps,
  render_mesh,    // the meshes for the whole shot
  render_frames,  // frames on these meshes
  keep_apart,     // sheets from each other, and from colliders
  judge,
  caches,
  keep,        // what a later bake can take up
  certificate  // and report, and hashes
};
inline constexpr std::size_t stages = static_cast<std::size_t>(Stage::certificate) + 1;

/// Adds up the CPU time of the stages of a bake. May be used by several threads at the same time.
class StageClock {
 public:
  StageClock();  // what the process has taken so far is `plan`

  /// A part of the work of one thread that belongs to a stage, as long as the object lives; without
  /// the parts of other stages in it.
  class Part {
   public:
    Part(StageClock*, Stage);  // null: nothing is added up
    ~Part();
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    friend class StageClock;
    void add_up();
    StageClock* clock_;
    Stage stage_;
    Part* outer_;
    double since_;  // [ms]
  };

  /// [s] of every stage, by its name; "rest": what the process has taken besides, which is what
  /// threads do that a stage starts for itself; "all": the sum of these. Of the parts that live,
  /// those of this thread are taken into account.
  std::map<std::string, double> seconds();

 private:
  void add(Stage, double ms);
  std::mutex mutex_;
  std::array<double, stages> ms_{};
};

}  // namespace paperbake
