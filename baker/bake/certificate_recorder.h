#pragma once

#include "baker/bake/bake_context.h"
#include "baker/output/cache_judge.h"
#include "core/geometry/pattern_samples.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// Measures the simulated frames of one sheet and adds them to the certificate: a line and the
/// handles of every frame that is written, singular points of all frames.
class CertificateRecorder {
 public:
  CertificateRecorder(const BakeContext& bake, std::size_t sheet);

  /// To be called with every simulated frame.
  void consume(const AnimatedFrame&);

 private:
  /// What the next frame that is written is measured against.
  struct WrittenFrame {
    int frame;
    Points3 x, samples;  // [m] of its vertices; of places on the pattern
    Triangles triangles;
    std::vector<HandleFrame> handles;
    int crossings;
  };
  WrittenFrame look_at(const AnimatedFrame&) const;
  FrameRecord measure(const AnimatedFrame&, const WrittenFrame& now) const;
  Jam jam_of(const AnimatedFrame&, std::size_t handle) const;
  /// Since the line before. Fills in `moved` and `driven`.
  void measure_motion(const WrittenFrame& now, FrameStatistics&) const;
  /// [m] How far the wind has gone in the middle of the sheet. Only one with inertia feels it.
  double way_of_wind(const WrittenFrame& now, const FrameStatistics&) const;
  void note_what_was_not_solved(const AnimatedFrame&, FrameRecord&) const;
  /// A frame that is handed on is judged as it is in the cache.
  bool is_handed_on(int frame) const;
  void judge_inside(const Sheet&, FrameRecord&);
  void count_intersections(const Sheet&, FrameRecord&) const;
  void record_folds(const Sheet&, int frame) const;
  void record_handles(const AnimatedFrame&) const;

  const BakeContext& bake_;
  std::size_t sheet_;
  std::string input_hash_;
  // for frames that are not handed on; null: there was none yet
  std::shared_ptr<const JudgedColliders> colliders_;
  std::size_t known_singular_ = 0;
  PatternSamples samples_;
  std::optional<WrittenFrame> before_;  // none: this is the first
};

}  // namespace paperbake
