#pragma once

#include "core/geometry/point_location.h"
#include "core/render/crease_memory.h"
#include "core/render/creased_normals.h"
#include "core/render/render_mesh.h"
#include "core/render/shape_fit.h"
#include "core/render/subdivision.h"
#include "core/render/untangle.h"

#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

enum class Quality { draft, shot, hero };

/// A frame on the render mesh of the shot.
struct RenderFrame {
  Points3 x;               // |V|x3 [m]
  Points3 normals;         // unit; numbered as RenderSurface::normal_of_corner says
  Eigen::VectorXd crease;  // |V| [rad] how sharply the sheet is folded there
  // [1] how far each crease of the mesh is one at least, since the paper remembers it; empty: it
  // remembers none
  std::vector<double> remembered;
  // layers that passed through each other were separated (untangle.h)
  bool kept_apart = false;
  // how many pairs of triangles passed through each other at these positions, which are those of a
  // step on the way to x; often x itself, rounded to 32 bits as a file has it
  struct Counted {
    Points3 x;  // |V|x3 [m]
    int crossings = 0;
  } counted;
};

/// Brings simulated frames, whatever their mesh, to one render mesh for the whole shot: onto the
/// curved surface that the simulated mesh stands for (curved_surface.h), then smoothed and given
/// true lengths (shape_fit.h, strain_limit.h). For the finest quality the result is subdivided once
/// (subdivision.h).
class RenderSurface {
 public:
  /// refine  [1] 1: every triangle is divided into four at the end, 0: none is
  RenderSurface(RenderMesh, const ShapeFitOptions&, int refine);
  RenderSurface(RenderSurface&&);
  RenderSurface& operator=(RenderSurface&&);
  ~RenderSurface();

  const RenderMesh& mesh() const { return fine_ ? fine_->mesh : coarse_; }
  const Triangles& normal_of_corner() const {
    return (fine_normals_ ? *fine_normals_ : coarse_normals_).of_corner();
  }

  /// Where the vertices of mesh() lie on a simulated mesh; to be kept as long as that mesh does not
  /// change. For a vertex outside it, as on a finer border, the nearest triangle is extended.
  std::vector<MeshPoint> locate_on(const Points2& pattern, const Triangles&) const;

  /// Says which of the points that the mesh was made for are held from now on. Must be called
  /// before the first frame, and before lengths are limited or crossings counted: what these need
  /// is made here, because a mesh may be given up before. Expensive when other points are held than
  /// before.
  void hold(const std::vector<int>& points);

  /// The curved surface of a sheet, at the vertices of the mesh before any subdivision.
  struct Shape {
    Points3 x;          // |V|x3 [m]
    Points3 curvature;  // |V|x3 [1/m] Sxx, Sxy, Syy
  };
  const Triangles& triangles_of_shape() const { return coarse_.triangles; }
  /// places  from locate_on() for the mesh of the sheet
  /// May be called by several threads at the same time, as all that follow.
  Shape shape(const Sheet&, const std::vector<MeshPoint>& places) const;

  /// shape    of the sheet, or near it
  /// held_at  |held points|x3 [m] where they are, exactly
  RenderFrame frame(const Sheet&, const std::vector<MeshPoint>& places, Shape shape,
                    const Points3& held_at) const;
  RenderFrame frame(const Sheet& sheet, const std::vector<MeshPoint>& places,
                    const Points3& held_at) const {
    return frame(sheet, places, shape(sheet, places), held_at);
  }

  /// The vertices of mesh() on the flat triangles of the simulated mesh. |V|x3 [m]
  Points3 linear_positions(const Sheet&, const std::vector<MeshPoint>& places) const;

  /// False where the layers of a simulated sheet are so far from each other that
  /// intersecting_triangles() are none, wherever the vertices of mesh() lie on them.
  bool may_have_intersecting_triangles(const Sheet&) const;

  /// The triangles of the simulated sheet at which linear_positions(), joined by the triangles of
  /// mesh(), pass through each other although the sheet does not, because its layers are very near
  /// each other. In order.
  std::vector<int> intersecting_triangles(const Sheet&, const std::vector<MeshPoint>& places) const;

  /// Computes everything else that a frame has from its positions.
  void shade(RenderFrame&) const;
  /// Brings edge lengths back to the limit.
  void limit_strain(Points3& x) const;
  double worst_edge(const Points3& x) const;
  const std::vector<char>& is_held() const { return is_held_; }

  /// Number of pairs of triangles of mesh() that pass through each other. x  |V|x3 [m]
  int crossings(const Points3& x) const;

 private:
  bool keep_apart(Points3& x, const Sheet&, const std::vector<MeshPoint>&) const;

  struct ForFrames;

  SimulatedEdges simulated_edges_;
  RenderMesh coarse_;
  ShapeFitOptions fit_options_;
  CreasedNormals coarse_normals_;
  CreasesOfMesh coarse_creases_;
  std::optional<Subdivision> fine_;
  std::optional<CreasedNormals> fine_normals_;
  std::optional<CreasesOfMesh> fine_creases_;
  std::optional<Untangler> apart_;         // of mesh()
  double mean_edge_ = 0;                   // [m] of mesh()
  std::unique_ptr<ForFrames> for_frames_;  // made by the first hold()
  std::vector<int> held_;                  // vertices, one for each held point
  std::vector<char> is_held_;              // for the vertices of mesh()
};

/// Makes the render mesh of a shot. Draft, shot and hero have edges of 5, 2 and 1 mm on a sheet of
/// 0.2 m and proportional ones on other sheets, and at most 400,000 triangles. Hero is the mesh of
/// shot with every triangle divided into four.
/// simulated_edge  [m] mean edge of the simulated meshes; a sixth of it is the smoothing length
/// features        with simulated edges, if there are any, the mesh can return to any simulated
///                 shape exactly
RenderSurface make_render_surface(const Pattern&, const RenderFeatures&, double simulated_edge,
                                  Quality);

}  // namespace paperbake
