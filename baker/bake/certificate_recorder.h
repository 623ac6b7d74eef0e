#pragma once

#include "baker/bake/bake_context.h"
#include "baker/output/cache_judge.h"
#include "core/geometry/pattern_samples.h"

#include <cstddef>
#include <memory>
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
  FrameRecord measure(const AnimatedFrame&);
  Jam jam_of(const AnimatedFrame&, std::size_t handle) const;
  void note_what_was_not_solved(const AnimatedFrame&, FrameRecord&);
  void judge_inside(const Sheet&, FrameRecord&) const;
  void count_intersections(const Sheet&, FrameRecord&);
  /// Since the line before.
  void measure_motion(const AnimatedFrame&, FrameStatistics&);
  void record_folds(const Sheet&, int frame);
  void record_handles(const AnimatedFrame&);

  const BakeContext& bake_;
  std::size_t sheet_;
  std::string input_hash_;
  // for frames that are not handed on; null: there are none
  std::shared_ptr<const JudgedColliders> colliders_;
  std::size_t known_singular_ = 0;
  PatternSamples samples_;
  int frame_before_ = 0;                     // of the line before
  Points3 samples_before_;                   // [m] there; empty: there is none
  std::vector<HandleFrame> handles_before_;  // of the line before
  Triangles triangles_before_;               // of the last frame that was written
  int crossings_before_ = 0;
  Points3 x_before_;
};

}  // namespace paperbake
