#include "core/geometry/constrained_delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>

namespace paperbake {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Edges = std::vector<std::pair<int, int>>;

/// Inserts a point that is probably near the vertex inserted last. The walk to it begins there.
/// Only where it ends on an edge or outside, where the face depends on the way, does it begin at
/// infinity: faces get the same order as if all walks did.
Cdt::Vertex_handle insert_near(Cdt& cdt, const Kernel::Point_2& point, Cdt::Vertex_handle last) {
  if (last != Cdt::Vertex_handle()) {
    Cdt::Locate_type where;
    int number;
    const Cdt::Face_handle face = cdt.locate(point, where, number, last->face());
    if (where == Cdt::FACE) return cdt.insert(point, where, face, number);
  }
  return cdt.insert(point);
}

/// Marks each face with 1 on the paper and 0 outside it: on the way in from infinity, every border
/// edge that is crossed changes the side. (Testing where the centroid lies is not enough: three
/// points on one side of a polygon may span a triangle of 1e-23 m2 outside the paper.)
void mark_paper(Cdt& cdt, const Edges& chords) {
  Edges inner = chords;
  for (auto& [a, b] : inner)
    if (a > b) std::swap(a, b);
  std::sort(inner.begin(), inner.end());
  for (auto face : cdt.all_face_handles()) face->info() = -1;
  std::vector<Cdt::Face_handle> open{cdt.infinite_face()};
  open.front()->info() = 0;
  while (!open.empty()) {
    const Cdt::Face_handle face = open.back();
    open.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Cdt::Face_handle next = face->neighbor(i);
      if (next->info() >= 0) continue;
      const auto [a, b] =
          std::minmax(face->vertex(Cdt::cw(i))->info(), face->vertex(Cdt::ccw(i))->info());
      const bool border = face->is_constrained(i) &&
                          !std::binary_search(inner.begin(), inner.end(), std::make_pair(a, b));
      next->info() = border ? 1 - face->info() : face->info();
      open.push_back(next);
    }
  }
}

}  // namespace

std::optional<Triangles> constrained_delaunay(const std::vector<Vector2d>& points,
                                              const Edges& border, const Edges& chords) {
  Cdt cdt;
  cdt.infinite_vertex()->info() = -1;
  std::vector<Cdt::Vertex_handle> handles(points.size());
  try {
    for (std::size_t i = 0; i < points.size(); ++i) {
      handles[i] = insert_near(cdt, Kernel::Point_2(points[i].x(), points[i].y()),
                               i > 0 ? handles[i - 1] : Cdt::Vertex_handle());
      handles[i]->info() = static_cast<int>(i);
    }
    for (const Edges* edges : {&border, &chords})
      for (const auto& [a, b] : *edges) cdt.insert_constraint(handles[a], handles[b]);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  // edges that cross exactly at a vertex throw no exception: two points then share a vertex, or a
  // vertex lies on an edge
  if (cdt.number_of_vertices() < points.size()) return std::nullopt;
  for (const Edges* edges : {&border, &chords})
    for (const auto& [a, b] : *edges)
      if (!cdt.is_edge(handles[a], handles[b])) return std::nullopt;

  mark_paper(cdt, chords);
  std::vector<int> flat;
  for (auto face : cdt.finite_face_handles())
    if (face->info() == 1)
      for (int i = 0; i < 3; ++i) flat.push_back(face->vertex(i)->info());
  return Triangles(Eigen::Map<Triangles>(flat.data(), static_cast<int>(flat.size() / 3), 3));
}

}  // namespace paperbake
