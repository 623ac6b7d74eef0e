#pragma once

namespace paperbake {

/// Options of the curved regions and their rulings. Lengths are given in mean edge lengths h of the
/// base mesh, curvatures relative to the size of the sheet.
struct RulingOptions {
  // [rad] angle by which the sheet turns from one ruling to the next (6 degrees); 0: no rulings
  double turn_per_ruling = 0.1;
  // [rad] the sheet becomes curved where it would turn by more than this over its longer side
  double curved_above = 0.3;
  double flat_below = 0.6;  // [1] it becomes flat again below this fraction of curved_above
  // [1] largest fraction of |k1| that |k2| may have where there are rulings
  double coherent = 0.6;
  // [1] distance across the rulings over which one cone is fitted, in roots of the sheet's area
  double window = 0.15;
  // [1] regularization of this fit towards a cylinder
  double cylinder_regularization = 0.02;
  double across_most = 0.7;     // [h] largest distance between rulings
  double across_least = 0.5;    // [h] smallest distance between rulings
  double along_most = 2.0;      // [h] largest distance between vertices on a ruling
  double merge_distance = 0.2;  // [h] points closer than this are merged
  // [1] radius of the disc around an isolated moving handle that rulings do not enter, as a
  // fraction of the shorter side
  double guard = 0.3;
  double stale_fold =
      1.5;  // [1] a fold of more than this times turn_per_ruling asks for a new mesh
  // [1] largest number of triangles of a ruled mesh, relative to the base mesh
  double max_share = 1.4;
};

}  // namespace paperbake
