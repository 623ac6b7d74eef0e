#pragma once

#include "baker/bake/bake_context.h"

#include <cstddef>
#include <string>

namespace paperbake {

/// Measures the simulated frames of one sheet and adds them to the certificate: a line and the
/// handles of every frame that is written, singular points of all frames.
class CertificateRecorder {
 public:
  CertificateRecorder(const BakeContext& bake, std::size_t sheet)
      : bake_(bake), sheet_(sheet), input_hash_(bake.plan.start_hash[sheet]) {}

  /// To be called with every simulated frame.
  void consume(const AnimatedFrame&);

 private:
  FrameRecord measure(const AnimatedFrame&) const;
  void count_intersections(const Sheet&, FrameRecord&);
  void record_folds(const Sheet&, int frame);
  void record_handles(const AnimatedFrame&);

  const BakeContext& bake_;
  std::size_t sheet_;
  std::string input_hash_;
  std::size_t known_singular_ = 0;
};

}  // namespace paperbake
