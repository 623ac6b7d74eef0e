#include "core/render/untangle_sheets.h"

#include "core/geometry/box_of.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"

#include <algorithm>

namespace paperbake {
namespace {

bool any(const std::vector<int>& counts) {
  return std::any_of(counts.begin(), counts.end(), [](int count) { return count > 0; });
}

}  // namespace

SheetUntangler::SheetUntangler(const std::vector<RenderSurface>& sheets) : sheets_(sheets) {
  std::vector<const RenderMesh*> meshes;
  for (const RenderSurface& sheet : sheets) meshes.push_back(&sheet.mesh());
  if (meshes.size() > 1) apart_.emplace(meshes);
}

Points3 SheetUntangler::in_a_row(const std::vector<Points3>& of_sheets) const {
  long vertices = 0;
  for (const Points3& x : of_sheets) vertices += x.rows();
  Points3 all(vertices, 3);
  long from = 0;
  for (const Points3& x : of_sheets) {
    all.middleRows(from, x.rows()) = x;
    from += x.rows();
  }
  return all;
}

std::vector<Points3> SheetUntangler::linear_positions(
    const std::vector<Simulated>& simulated) const {
  std::vector<Points3> linear_positions;
  for (std::size_t s = 0; s < sheets_.size(); ++s)
    linear_positions.push_back(
        sheets_[s].linear_positions(simulated[s].sheet, *simulated[s].places));
  return linear_positions;
}

std::vector<int> SheetUntangler::crossings(const std::vector<Points3>& x) const {
  std::vector<int> counts(x.size(), 0);
  if (x.size() < 2) return counts;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (std::size_t s = 0; s < x.size(); ++s) {
    boxes.push_back(box_of(x[s]));
    for (std::size_t t = 0; t < s; ++t)
      if (boxes[s].intersects(boxes[t]))
        counts[s] += crossings_between(Sheet{{}, x[s], {}, sheets_[s].mesh().triangles, {}},
                                       Sheet{{}, x[t], {}, sheets_[t].mesh().triangles, {}});
  }
  return counts;
}

bool SheetUntangler::linear_surfaces_intersect(const std::vector<Simulated>& simulated) const {
  if (simulated.size() < 2 || !any(crossings(linear_positions(simulated)))) return false;
  for (std::size_t s = 0; s < simulated.size(); ++s)
    for (std::size_t t = 0; t < s; ++t)
      if (crossings_between(simulated[s].sheet, simulated[t].sheet) > 0) return false;
  return true;
}

void SheetUntangler::keep_apart(std::vector<RenderFrame>& frames,
                                const std::vector<Simulated>& simulated) const {
  if (!apart_) return;
  std::vector<Points3> of_sheets;
  for (const RenderFrame& frame : frames) of_sheets.push_back(frame.x);
  if (!any(crossings(of_sheets))) return;
  std::vector<char> held;
  for (const RenderSurface& sheet : sheets_)
    held.insert(held.end(), sheet.is_held().begin(), sheet.is_held().end());
  const auto part = [&](const Points3& x, std::size_t s) -> Points3 {
    long from = 0;
    for (std::size_t t = 0; t < s; ++t) from += of_sheets[t].rows();
    return x.middleRows(from, of_sheets[s].rows());
  };
  const Untangler::Lengths lengths{[&](Points3& x) {
                                     std::vector<Points3> mended;
                                     for (std::size_t s = 0; s < sheets_.size(); ++s)
                                       sheets_[s].limit_strain(mended.emplace_back(part(x, s)));
                                     x = in_a_row(mended);
                                   },
                                   [&](const Points3& x) {
                                     double worst = 0;
                                     for (std::size_t s = 0; s < sheets_.size(); ++s)
                                       worst = std::max(worst, sheets_[s].worst_edge(part(x, s)));
                                     return worst;
                                   }};
  Points3 x = in_a_row(of_sheets);
  apart_->untangle_alternating(x, in_a_row(linear_positions(simulated)), lengths, held);
  for (std::size_t s = 0; s < frames.size(); ++s) {
    const Points3 now = part(x, s);
    if (now == frames[s].x) continue;
    frames[s].x = now;
    frames[s].kept_apart = true;
    sheets_[s].shade(frames[s]);
  }
}

}  // namespace paperbake
