#pragma once

#include "core/geometry/point_location.h"
#include "core/model/frame.h"
#include "core/model/shot.h"
#include "formats/cache/alembic_cache.h"
#include "formats/maps/crease_history.h"

#include <vector>

namespace paperbake {

/// Finds the guides of one sheet: its singular points and its folds, on the mesh that is handed on.
/// A fold is an edge of a simulated mesh that was a crease in any frame (crease_history.h); of
/// those that lie nearer to each other than the width of a ridge the sharpest one is kept.
class SheetGuides {
 public:
  explicit SheetGuides(const Shot&);

  /// Every frame as it is simulated, in order.
  void add(const AnimatedFrame&);

  /// The guides of this frame, which lie on its mesh: those born up to it. The frames added so far
  /// go beyond it or end with it.
  CacheGuides at(int frame, const CacheFrame& mesh);

 private:
  struct Line {
    int id = 0, birth = 0;
    std::vector<MeshPoint> places;     // not farther apart than an edge of the mesh
    std::vector<MeshPoint> beside[2];  // half the width of a ridge away on either side
  };
  void lay_on(const CacheFrame& mesh);
  std::vector<DetectedCrease> sharpest() const;
  double fold_angle(const Line&, std::size_t point, const CacheFrame&,
                    const Points3& normals) const;

  const Shot& shot_;
  double width_;  // [m] of a ridge
  CreaseThresholds thresholds_;
  std::vector<DetectedCrease> history_;
  std::vector<SingularPoint> singular_;
  bool laid_ = false;  // the rest is that of triangles_ and uv_ and of all frames so far
  Triangles triangles_;
  Points2 uv_;
  std::vector<Line> lines_;
  std::vector<MeshPoint> points_;
};

}  // namespace paperbake
