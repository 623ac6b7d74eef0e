#pragma once

#include "baker/bake/bake_context.h"
#include "baker/output/cache_judge.h"

#include <cstddef>
#include <memory>
#include <string>

namespace paperbake {

/// Measures the simulated frames of one sheet and adds them to the certificate: a line and the
/// handles of every frame that is written, singular points of all frames.
class CertificateRecorder {
 public:
  CertificateRecorder(const BakeContext& bake, std::size_t sheet);

  /// To be called with every simulated frame.
  void consume(const AnimatedFrame&);

 private:
  FrameRecord measure(const AnimatedFrame&) const;
  void judge_inside(const Sheet&, FrameRecord&) const;
  void count_intersections(const Sheet&, FrameRecord&);
  void record_handles(const AnimatedFrame&);

  const BakeContext& bake_;
  std::size_t sheet_;
  std::string input_hash_;
  // for frames that are not handed on; null: there are none
  std::shared_ptr<const JudgedColliders> colliders_;
  std::size_t known_singular_ = 0;
};

}  // namespace paperbake
