#pragma once

#include "core/step2_crumple/bending_field.h"
#include "core/step2_crumple/cone_fit.h"
#include "core/step2_crumple/ruling_options.h"

#include <vector>

namespace paperbake {

class Serializer;

/// A part of the sheet that bends in one direction, like a generalised cone. Points in no region
/// count as flat.
struct CurvedRegion {
  int id;       // stays the same from frame to frame
  int sign;     // +1 bulges towards the normal, -1 away from it
  double area;  // [m2] on the pattern
  double bend;  // [rad m] integral of |k1| over the area: turning angle x length of the rulings
  Cone cone;
};

/// The flat and curved regions of a sheet, tracked through the frames. A point becomes curved above
/// one threshold and flat again below a lower one, and a region keeps its id as long as it covers
/// much of the same part of the pattern; so nothing flickers. source [Schreck 2015, section 4];
/// hysteresis and ids are this project's
class Regions {
 public:
  Regions(const Pattern&, const RulingOptions&);

  /// Updates the regions from the bending of the sheet in the next frame.
  void update(const BendingField&);

  const SampleGrid& grid() const { return grid_; }
  // principal curvatures at the sample points of the grid
  const std::vector<Principal>& bending() const { return bending_; }
  // region of each sample point, as an index into all(); -1: flat
  const std::vector<int>& region_of_sample() const { return region_of_sample_; }
  const std::vector<CurvedRegion>& all() const { return regions_; }

  void archive(Serializer&);  // everything but the bending, which is computed anew

 private:
  std::vector<int> grow_regions(std::vector<int>& sign_of) const;
  void assign_ids(const std::vector<int>& old_ids);
  void fit_cones(const std::vector<int>& sign_of);

  SampleGrid grid_;
  RulingOptions options_;
  double curved_above_;  // [1/m]
  std::vector<Principal> bending_;
  std::vector<char> curved_;  // 1: the sample point is curved, with hysteresis
  std::vector<int> region_of_sample_;
  std::vector<CurvedRegion> regions_;
  int next_id_ = 0;
};

}  // namespace paperbake
