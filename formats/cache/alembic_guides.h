#pragma once

#include "formats/cache/alembic_archive.h"
#include "formats/cache/alembic_cache.h"

#include <string>
#include <vector>

/// Singular points and folds as the AbcGeom schemas of points and curves define them.
namespace paperbake::alembic {

/// The stored samples of the guides of one sheet at one frame.
struct GuideFrame {
  struct Geometry {
    // sizes: of the curves; for points their numbers, as 64-bit integers
    Sample bounds, positions, sizes, id, birth, angle;
  };
  Geometry points, folds;
};

/// Stores the values of a frame in the file: y up, 32-bit floats.
GuideFrame store_guides(Archive&, const CacheGuides&);

/// Names of the objects: of the points and of the folds.
struct GuideLabels {
  std::string points, folds;
};

/// An Xform with Points and an Xform with linear Curves; nothing for no frames.
std::vector<Object> guide_objects(Archive&, const std::vector<GuideFrame>&, const GuideLabels&);

}  // namespace paperbake::alembic
