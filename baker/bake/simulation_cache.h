#pragma once

#include "baker/bake/bake_context.h"
#include "baker/output/cache_judge.h"
#include "baker/output/sheet_guides.h"

#include <cstddef>
#include <memory>
#include <optional>

namespace paperbake {

/// Hands the simulated meshes of one sheet to the caches, for --mesh simulation. A frame is
/// deferred until the next one is there, so that its velocity is the central difference of the true
/// motion of the sheet, even where its mesh changes.
class SimulationCache {
 public:
  SimulationCache(const BakeContext& bake, std::size_t sheet);

  /// To be called with every simulated frame, after the certificate has its line.
  void consume(const AnimatedFrame&);
  /// After the last frame.
  void finish() { flush_deferred(nullptr); }

 private:
  void defer(const AnimatedFrame&);
  void flush_deferred(const Sheet* next);
  Points3 resample(const Sheet& other) const;

  const BakeContext& bake_;
  std::size_t sheet_;
  std::shared_ptr<const JudgedColliders> colliders_;
  std::optional<SheetGuides> guides_;
  Sheet before_, now_;  // the frame before the deferred one, and the deferred one
  std::optional<CacheFrame> deferred_;
  int deferred_frame_ = 0;
};

}  // namespace paperbake
