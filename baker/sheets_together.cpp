#include "baker/sheets_together.h"

#include "core/measure.h"

namespace paperbake {
namespace {

Eigen::AlignedBox3d box_of(const Points3& x) { return {Vector3d(x.colwise().minCoeff()), Vector3d(x.colwise().maxCoeff())}; }

int crossings_of(const Points3& x, const Triangles& triangles) { return crossings(Sheet{{}, x, {}, triangles, {}}); }

}  // namespace

int SheetsTogether::add(const std::string& name, int frame, const Sheet& sheet) {
  int count = 0;
  std::vector<Placed>& placed = placed_[frame];
  const Eigen::AlignedBox3d here = box_of(sheet.x);
  for (const Placed& other : placed) {
    if (other.name == name || !here.intersects(box_of(other.x))) continue;
    Points3 x(sheet.x.rows() + other.x.rows(), 3);
    x << sheet.x, other.x;
    Triangles triangles(sheet.triangles.rows() + other.triangles.rows(), 3);
    triangles << sheet.triangles, (other.triangles.array() + static_cast<int>(sheet.x.rows())).matrix();
    count += crossings_of(x, triangles) - crossings_of(sheet.x, sheet.triangles) - crossings_of(other.x, other.triangles);
  }
  placed.push_back({name, sheet.x, sheet.triangles});
  return count;
}

}  // namespace paperbake
