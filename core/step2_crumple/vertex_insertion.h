#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Makes p a vertex of the mesh: a free inner vertex nearby is moved there on the pattern,
/// otherwise the edge or the triangle under p is split. Position and velocity are interpolated.
/// Where that would take the sheet through itself, the triangle under p is split in three: that
/// moves nothing, but the vertex may come to lie a little beside p.
/// fixed    1: a vertex that must not be moved
/// returns  number of the vertex
int insert_vertex(Sheet&, const Vector2d& p, const std::vector<char>& fixed);

}  // namespace paperbake
