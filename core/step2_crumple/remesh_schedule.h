#pragma once

#include "core/step2_crumple/regions.h"

#include <limits>

namespace paperbake {

/// How well the edges of a mesh follow the bending of its curved regions.
struct MeshFit {
  double misalignment = 0;  // [1]   sum |theta| l |edge . across| / sum |theta| l: 0 on rulings
  double largest_fold = 0;  // [rad] of the edges, but for those at singular points
};
MeshFit mesh_fit(const Sheet&, const BendingField&, const Regions&);

/// When a new ruled mesh is worth its pop: rarely, and the less the more often it was refused.
class RemeshSchedule {
 public:
  /// To be asked once at every moment.
  bool due(const MeshFit&, const FrameTime&, double max_fold);
  /// What became of a mesh that was due.
  void on_proposal_result(bool accepted, const FrameTime&);

  void archive(Serializer&);

 private:
  static constexpr double min_retry_delay = 1 / 24.0;       // [s]
  double last_ = -std::numeric_limits<double>::infinity();  // [s] time of the last ruled mesh
  // [1] of the longer side that the sheet has gone since
  double accumulated_motion_ = 0;
  double not_before_ = last_;  // [s] until then nothing is tried
  // [s] twice as long after every refusal, up to 16 times
  double retry_delay_ = min_retry_delay;
};

}  // namespace paperbake
