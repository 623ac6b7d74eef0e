#pragma once

#include "core/geometry/point_location.h"
#include "core/render/creased_normals.h"
#include "core/render/render_mesh.h"
#include "core/render/shape_fit.h"
#include "core/render/strain_limit.h"
#include "core/render/subdivision.h"
#include "core/render/untangle.h"

#include <optional>
#include <vector>

namespace paperbake {

enum class Quality { draft, shot, hero };

/// A frame on the mesh of the whole shot.
struct RenderFrame {
  Points3 x;               // |V|x3 [m]
  Points3 normals;         // unit, numbered as RenderSurface::normal_of_corner says
  Eigen::VectorXd crease;  // |V| [rad] how sharply the sheet is folded there
  // layers that passed through each other were taken apart (untangle.h)
  bool kept_apart = false;
};

/// Puts simulated frames, whatever their mesh, on one mesh: curved as the simulated one stands for
/// (curved_surface.h), made smooth and true in its lengths (shape_fit.h, strain_limit.h) and,
/// where it is to be finer than that pays, subdivided once.
class RenderSurface {
 public:
  /// refine  [1] 0, or 1: every triangle in four at the end
  RenderSurface(RenderMesh, const ShapeFitOptions&, int refine);

  const RenderMesh& mesh() const { return fine_ ? fine_->mesh : coarse_; }
  const Triangles& normal_of_corner() const {
    return (fine_normals_ ? *fine_normals_ : coarse_normals_).of_corner();
  }

  /// Where the vertices lie on a simulated mesh; to be kept while that does not change. Beside it,
  /// as a border that is finer may be, the nearest triangle goes on.
  std::vector<MeshPoint> locate_on(const Points2& pattern, const Triangles&) const;

  /// From now on these of the points that the mesh was made for are held. To be called before the
  /// first frame; dear when they are others than before.
  void hold(const std::vector<int>& points);

  /// places  of this mesh on the sheet's
  /// held_at  |held points|x3 [m] where they are, exactly
  /// Several threads may ask at the same time.
  RenderFrame frame(const Sheet&, const std::vector<MeshPoint>& places,
                    const Points3& held_at) const;

  /// The vertices of mesh() on the flat simulated triangles. |V|x3 [m]
  Points3 linear_positions(const Sheet&, const std::vector<MeshPoint>& places) const;

  /// Layers of the sheet are so near each other that, joined by the triangles of mesh(), its
  /// facets() pass through each other though the sheet does not.
  bool linear_surface_intersects(const Sheet&, const std::vector<MeshPoint>& places) const;

  /// What else a frame has, from its positions.
  void shade(RenderFrame&) const;
  /// Lengths back to the limit.
  void limit_strain(Points3& x) const { (fine_ ? *fine_limit_ : coarse_limit_)(x, is_held_); }
  double worst_edge(const Points3& x) const {
    return (fine_ ? *fine_limit_ : coarse_limit_).worst(x);
  }
  const std::vector<char>& is_held() const { return is_held_; }

  /// Pairs of triangles of mesh() that pass through each other. x  |V|x3 [m]
  int crossings(const Points3& x) const;

 private:
  // the simulated edges cut through triangles of the mesh; they are among its edges
  enum class Facets { cut, own };
  bool keep_apart(Points3& x, const Sheet&, const std::vector<MeshPoint>&) const;

  Facets facets_;
  RenderMesh coarse_;
  ShapeFit shape_fit_;
  StrainLimit coarse_limit_;
  CreasedNormals coarse_normals_;
  std::optional<Subdivision> fine_;
  std::optional<StrainLimit> fine_limit_;
  std::optional<CreasedNormals> fine_normals_;
  std::optional<Untangler> apart_;  // of mesh()
  std::vector<int> held_;           // vertices, one for each held point
  std::vector<char> is_held_;       // of the vertices of mesh()
};

/// The render mesh of a shot. Edges of 5, 2 or 1 mm on a sheet of 0.2 m, and as much longer as it
/// is larger; at most 400,000 triangles. Hero is shot in four.
/// simulated_edge  [m] mean edge of the meshes that were simulated: a sixth of it is what is
///                 smoothed over
/// features  with simulated edges, when there are any: then the mesh can go back to any simulated
///           shape exactly
RenderSurface make_render_surface(const Pattern&, const RenderFeatures&, double simulated_edge,
                                  Quality);

}  // namespace paperbake
