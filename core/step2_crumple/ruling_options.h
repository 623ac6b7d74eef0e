#pragma once

namespace paperbake {

/// Curved regions and their rulings. Lengths in spacings h of the base mesh, curvatures by the size
/// of the sheet.
struct RulingOptions {
  // [rad] how far the sheet turns from ruling to ruling (6 degrees); 0: no rulings
  double facet_turn = 0.1;
  // [rad] the sheet is curved where it turns this much over its longer side ...
  double curved_above = 0.3;
  double flat_below = 0.6;  // [1]   ... until it turns less than this share of it
  // [1]   share of the first curvature that the second may have where there are rulings
  double coherent = 0.6;
  // [1]   of the root of the sheet's area: how far across rulings one cone is fitted
  double window = 0.15;
  double cylinder_regularization = 0.02;  // [1]   towards a cylinder
  double across_most = 0.7;               // [h]   distance of rulings at most
  double across_least = 0.5;              // [h]   and at least
  double along_most = 2.0;                // [h]   vertices on a ruling
  double merge_distance = 0.2;            // [h]   points as near as this become one
  // [1]   of the shorter side: disc round a lone handle that moves which rulings do not enter
  double guard = 0.3;
  double stale_fold = 1.5;  // [1]   of facet_turn: a larger fold asks for a new mesh
  // [1]   of the triangles of the base mesh that the ruled one may have
  double max_share = 1.4;
};

}  // namespace paperbake
