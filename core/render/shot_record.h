#pragma once

#include "core/geometry/hinges.h"
#include "core/model/frame.h"
#include "core/model/shot.h"
#include "core/render/render_mesh.h"

#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace paperbake {

/// What is kept of one frame of a shot to render it on the mesh of the whole shot. It is small:
/// positions in 32 bits, meshes shared.
struct RecordedFrame {
  int frame = 0;
  // index in ShotRecord::meshes
  int mesh = 0;
  using Positions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Positions x;                               // [m]
  Positions carried;                         // [m] AnimatedFrame::carried
  std::vector<CreaseEdge> folded;            // edges of creases that are folded by now
  std::vector<RememberedCrease> remembered;  // as in Sheet
  // handles that hold the sheet
  std::vector<int> held;
  Points3 held_at;  // [m] where they hold it
  Points3 keyed;    // [m] and where they were keyed to
};

/// Everything that was simulated in a shot of one sheet, and what a mesh for all its frames has to
/// represent.
class ShotRecord {
 public:
  struct Mesh {
    Points2 pattern;
    Triangles triangles;
  };

  void add(const AnimatedFrame&);

  const std::vector<RecordedFrame>& frames() const { return frames_; }
  const std::vector<Mesh>& meshes() const { return meshes_; }
  Sheet sheet(const RecordedFrame&) const;  // without velocities and singular points
  Sheet carried(const RecordedFrame&) const;

  /// Points: the handles, in order, the rims of their discs, and all singular points of the shot.
  /// Creases: edges that were sharply folded for two frames, or for a quarter of the shot where
  /// that is less; the sharper they were, the less time it takes. The heaviest are those across
  /// which a render mesh without them would err most.
  RenderFeatures features(const Shot&) const;
  /// Whether its paper may have creases: it has singular points or folds, was modelled with sharp
  /// edges, or touched what may have creased it.
  bool may_be_creased() const {
    return !singular_.empty() || !folds_.empty() || begins_sharp_ || touched_;
  }

  /// A triangle of one of the meshes.
  struct SimulatedTriangle {
    int mesh, triangle;
    bool operator<(const SimulatedTriangle& other) const {
      return std::tie(mesh, triangle) < std::tie(other.mesh, other.triangle);
    }
  };
  /// The edges of these triangles that lie inside the sheet, each once, in an order that depends on
  /// the edges alone.
  std::vector<CreaseSegment> edges(const std::set<SimulatedTriangle>&) const;

  /// Mean edge of the meshes, averaged over the frames. [m]
  double edge() const;

 private:
  struct FoldedEdge {
    Vector2d a, b;
    // [1] sum over the frames of the squared error in length of an edge that runs across the fold
    double error = 0;
  };
  void remember(const Sheet&, const Hinges&, bool same_mesh, RecordedFrame&);

  std::vector<Mesh> meshes_;
  std::vector<RecordedFrame> frames_;
  std::map<std::array<long, 4>, FoldedEdge> creases_;  // by their ends, in units of 1e-7 m
  // of the last mesh, each with the number of its hinge, at its sharpest
  std::vector<std::pair<std::size_t, RememberedCrease>> creases_so_far_;
  std::vector<SingularPoint> singular_;
  std::vector<PrescribedCrease> folds_;
  double edges_ = 0;
  bool begins_sharp_ = false, touched_ = false;
};

}  // namespace paperbake
