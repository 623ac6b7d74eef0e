#pragma once

#include "core/geometry/hinges.h"
#include "core/geometry/point_location.h"
#include "core/render/shot_record.h"
#include "formats/cache/alembic_cache.h"

#include <array>
#include <vector>

namespace paperbake {

/// What a shot does to its paper, at the vertices of the mesh that is rendered: what the maps show
/// between them. Numbers of the same meaning have the same sign and unit
/// (formats/maps/crease_map.h):
///
///   foldAngle     [rad] fold.angle: turn of the sheet at this frame
///   foldPlastic   [rad] fold.plastic: what of it the paper keeps; only with plasticity
///   foldPeak      [rad] fold.peak: the foldAngle of largest magnitude so far
///   apexDistance  [m]   apex.dist: to the nearest singular point so far, on the pattern; without
///   one the sheet's diagonal
///   apexAge       [s]   age.apex: since the birth of that point; -1 without one
///
/// Rounded to 1e-4 rad, 1e-5 m and 1e-4 s, for layers are text.
class CreaseAttributes {
 public:
  CreaseAttributes(const Shot&, double fold_width, double fps);

  /// Every frame as it is simulated, in order.
  void add(const AnimatedFrame&);

  /// The layers of frame k of the record; k only grows. `record` has been given the same frames.
  std::vector<CacheLayer> at(std::size_t k, const ShotRecord& record, const Points2& pattern);

 private:
  /// The turn about the edge opposite each corner of each triangle, where it is a crease; 0: none.
  struct SharpEdges {
    std::vector<std::array<float, 3>> now, plastic;  // |T| [rad]
  };
  static SharpEdges sharp_edges(const Sheet&, const Hinges&, const Points3& curvature,
                                const Points3& plastic);
  Eigen::VectorXd turns(const ShotRecord::Mesh&, const Points3& smooth,
                        const std::vector<std::array<float, 3>>& sharp) const;
  struct SimulatedCreases {
    // |V|x3 [rad] turn of the smooth paper at the vertices of the simulated mesh
    Points3 now, plastic;
    SharpEdges sharp;
    std::size_t singular;  // points so far
  };
  struct CreaseAngles {
    Eigen::VectorXd now, plastic;  // [rad] at the vertices of the rendered mesh
  };
  CreaseAngles angles(std::size_t k, const ShotRecord&, const Points2& pattern);

  double diagonal_, fold_width_, fps_;
  std::vector<SimulatedCreases> folds_;  // of each frame
  std::vector<SingularPoint> singular_;
  std::size_t next_ = 0;  // frame whose folds are not yet in the peak
  Eigen::VectorXd peak_;  // [rad]
  int mesh_ = -1;         // that places_ lie on
  std::vector<MeshPoint> places_;
};

}  // namespace paperbake
