#pragma once

#include "core/render/render_surface.h"
#include "core/render/shot_record.h"

#include <cstddef>
#include <future>
#include <map>
#include <utility>
#include <vector>

namespace paperbake {

using MeshPoints = std::shared_future<std::vector<MeshPoint>>;

/// Where the vertices of a render mesh lie on simulated meshes, those of the last frames that were
/// asked for. Computed by whoever needs it first.
class MeshPointCache {
 public:
  MeshPointCache(const ShotRecord& record, const RenderSurface& surface)
      : record_(&record), surface_(&surface) {}

  /// On the mesh of the k-th frame.
  MeshPoints at(std::size_t k);
  /// Meshes of frames before the k-th will not be asked for again.
  void forget_before(std::size_t k);

 private:
  const ShotRecord* record_;
  const RenderSurface* surface_;
  std::map<int, MeshPoints> points_;  // of a mesh
};

/// The shapes of the frames of a sheet on its render mesh. What a change of the simulated mesh
/// moves is spread over the frames around it (mesh_changes.h).
class ShapeCache {
 public:
  ShapeCache(const ShotRecord&, const RenderSurface&, double fps);

  /// What a change of mesh moves, at the time of the last frame on the old mesh.
  struct Change {
    Points3 seen_before, seen_after;  // displacement (seen_by_triangles), on the old and new mesh
    Points3 curvature;                // |V|x3 [1/m]
  };
  /// Computes the shape of a frame when it is asked for. A sum of a shape and changes, which are
  /// shared with other frames.
  class Sum {
   public:
    const std::vector<MeshPoint>& places() const { return points_.get(); }
    RenderSurface::Shape operator()() const;

   private:
    friend ShapeCache;
    MeshPoints points_;
    std::shared_future<RenderSurface::Shape> shape_;
    std::vector<std::pair<std::shared_future<Change>, double>> changes_;
    const Triangles* triangles_ = nullptr;
  };

  /// k  may only grow
  Sum at(std::size_t k);

 private:
  std::shared_future<RenderSurface::Shape> shape(std::size_t k);
  /// The change of mesh before frame k.
  std::shared_future<Change> change(std::size_t k);

  const ShotRecord* record_;
  const RenderSurface* surface_;
  int half_;  // [frames] as in mesh_changes_near
  MeshPointCache points_;
  std::map<std::size_t, std::shared_future<RenderSurface::Shape>> shapes_;
  std::map<std::size_t, std::shared_future<Change>> changes_;
};

}  // namespace paperbake
