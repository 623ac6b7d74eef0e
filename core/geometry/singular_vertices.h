#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Whether a singular point is at this vertex: to a nanometre, because it is a vertex in every mesh
/// that a step may begin with.
bool is_at_vertex(const SingularPoint&, const Sheet&, int vertex);

/// |V| 1: the vertex is a singular point.
std::vector<char> singular_vertices(const Sheet&);

}  // namespace paperbake
