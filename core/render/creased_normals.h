#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// Normals for shading: smooth where paper is smooth, split where a crease of the mesh is folded.
/// Which corner has which normal does not change from frame to frame: a crease that lies flat has
/// twice the same one.
///
/// Triangles count by the weights of [Max 1999], exact on spheres, and across a crease only as far
/// as it lies flat (1 - crease_share of its fold).
class CreasedNormals {
 public:
  /// creases  edges (smaller vertex first, sorted) along which the mesh may fold sharply
  /// sharp    of each: it is a crease however little it turns; empty: none is
  CreasedNormals(const Triangles&, const std::vector<std::pair<int, int>>& creases,
                 const std::vector<char>& sharp = {});

  /// |T|x3: number of the normal of each corner. Vertex v has normal v, and more of them behind |V|
  /// where creases meet.
  const Triangles& of_corner() const { return of_corner_; }

  /// Unit normals, one a row: as many as of_corner() speaks of.
  Points3 normals(const Points3& x) const;

  /// How sharply the sheet is folded at each vertex: the largest |fold| of the creases there. |V|
  /// [rad]
  Eigen::VectorXd strength(const Points3& x) const;

 private:
  struct Crossroads {         // a vertex with creases: sectors round it, counter-clockwise
    std::vector<int> normal;  // of each sector
    // the crease (number among creases_) between this sector and the next; -1: border
    std::vector<int> after;
  };
  int vertices_ = 0, normals_ = 0;
  Triangles triangles_, of_corner_;
  std::vector<Hinge> creases_;
  std::vector<char> sharp_;  // of each
  std::vector<Crossroads> crossroads_;
};

}  // namespace paperbake
