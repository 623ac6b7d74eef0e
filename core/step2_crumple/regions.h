#pragma once

#include "core/step2_crumple/bending_field.h"
#include "core/step2_crumple/cone_fit.h"
#include "core/step2_crumple/ruling_options.h"

#include <vector>

namespace paperbake {

class Serializer;

/// A part of the sheet that bends one way, like a generalised cone. What is in no region counts as
/// flat.
struct CurvedRegion {
  int id;       // the same from frame to frame
  int sign;     // +1 bulges towards the normal, -1 away from it
  double area;  // [m2] on the pattern
  double bend;  // [rad m] integral of |k1|: turn x length of the rulings
  Cone cone;
};

/// Flat and curved regions of a sheet, followed through the frames. A place becomes curved above
/// one threshold and flat again below a lower one, and a region keeps its number by what it covers
/// of the pattern, so that nothing flickers. source [Schreck 2015, section 4]; hysteresis and
/// numbering are this project's
class Regions {
 public:
  Regions(const Pattern&, const RulingOptions&);

  /// Looks at the sheet of the next frame.
  void update(const BendingField&);

  const SampleGrid& grid() const { return grid_; }
  // at the places of the grid
  const std::vector<Principal>& bending() const { return bending_; }
  // number in all() of each place; -1: flat
  const std::vector<int>& region_of_sample() const { return region_of_sample_; }
  const std::vector<CurvedRegion>& all() const { return regions_; }

  void archive(Serializer&);  // all but the bending, which is looked at anew

 private:
  std::vector<int> grow_regions(std::vector<int>& sign_of) const;
  void assign_ids(const std::vector<int>& old_ids);
  void fit_cones(const std::vector<int>& sign_of);

  SampleGrid grid_;
  RulingOptions options_;
  double curved_above_;  // [1/m]
  std::vector<Principal> bending_;
  std::vector<char> curved_;  // with hysteresis
  std::vector<int> region_of_sample_;
  std::vector<CurvedRegion> regions_;
  int next_id_ = 0;
};

}  // namespace paperbake
