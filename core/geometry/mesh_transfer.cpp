#include "core/geometry/mesh_transfer.h"

#include <utility>

namespace paperbake {

MeshTransfer::MeshTransfer(const Points2& pattern, const Triangles& triangles, const Points2& to)
    : triangles_(triangles) {
  const PointLocator locator(pattern, triangles);
  places_.reserve(to.rows());
  for (int v = 0; v < to.rows(); ++v) places_.push_back(locator.locate(to.row(v)));
}

Points3 MeshTransfer::operator()(const Points3& per_vertex) const {
  Points3 carried(static_cast<int>(places_.size()), 3);
  for (std::size_t v = 0; v < places_.size(); ++v)
    carried.row(v) = interpolate(places_[v], triangles_, per_vertex);
  return carried;
}

Sheet on_other_mesh(const Sheet& sheet, Points2 pattern, Triangles triangles) {
  const MeshTransfer onto(sheet.pattern, sheet.triangles, pattern);
  return on_other_mesh(sheet, std::move(pattern), std::move(triangles), onto);
}

Sheet on_other_mesh(const Sheet& sheet, Points2 pattern, Triangles triangles,
                    const MeshTransfer& onto) {
  Sheet other;
  other.x = onto(sheet.x);
  other.v = onto(sheet.v);
  other.pattern = std::move(pattern);
  other.triangles = std::move(triangles);
  other.singular = sheet.singular;
  other.prescribed_creases = sheet.prescribed_creases;
  other.crease_edges = sheet.crease_edges;
  return other;
}

}  // namespace paperbake
