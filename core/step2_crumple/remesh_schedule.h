#pragma once

#include "core/step2_crumple/regions.h"

#include <limits>

namespace paperbake {

/// How well the edges of a mesh follow the bending in its curved regions.
struct MeshFit {
  double misalignment = 0;  // [1] sum |theta| l |edge . across| / sum |theta| l: 0 on rulings
  double largest_fold = 0;  // [rad] largest |theta| of an edge that meets no singular point
};
MeshFit mesh_fit(const Sheet&, const BendingField&, const Regions&);

/// Decides when to propose a new ruled mesh; backs off exponentially after rejections.
class RemeshSchedule {
 public:
  /// True when a new mesh should be tried. To be called once at every FrameTime.
  /// max_fold  [rad] dihedral angle beyond which a mesh counts as outdated
  bool due(const MeshFit&, const FrameTime&, double max_fold);
  /// Reports what became of a mesh that was due.
  void on_proposal_result(bool accepted, const FrameTime&);

  void archive(Serializer&);

 private:
  static constexpr double min_retry_delay = 1 / 24.0;       // [s] wait after the first rejection
  double last_ = -std::numeric_limits<double>::infinity();  // [s] time of the last ruled mesh
  // [1] how far the sheet has moved since then, in longer sides
  double accumulated_motion_ = 0;
  double not_before_ = last_;  // [s] nothing is proposed before this time
  // [s] doubled by every rejection, up to 16 times the shortest
  double retry_delay_ = min_retry_delay;
};

}  // namespace paperbake
