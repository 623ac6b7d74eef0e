#pragma once

#include "core/step2_crumple/regions.h"

namespace paperbake {

/// How well the edges of a mesh follow the bending of its curved regions.
struct MeshFit {
  double misalignment = 0;  // [1]   sum |theta| l |edge . across| / sum |theta| l: 0 on rulings
  double largest_fold = 0;  // [rad] of the edges, but for those at singular points
};
MeshFit mesh_fit(const Sheet&, const BendingField&, const Regions&);

/// When a new ruled mesh is worth its pop: rarely, and the less the more often it was refused.
class RemeshWhen {
 public:
  bool due(const MeshFit&, int frame, double most_fold) const;
  /// What became of a mesh that was due.
  void judged(bool accepted, int frame);

 private:
  int last_ = -1000;      // frame of the last ruled mesh
  int not_before_ = 0;    // frame until which nothing is tried
  int wait_ = 1;          // [frames] after the next refusal: 2, 4, 8, 16
};

}  // namespace paperbake
