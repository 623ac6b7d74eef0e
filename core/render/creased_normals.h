#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// Normals for shading: smooth where the paper is smooth, split where a crease of the mesh is
/// folded. The numbers of the normals at each corner do not change from frame to frame: along a
/// crease that lies flat the same normal is there under two numbers.
///
/// Triangles are weighted as in [Max 1999], which is exact on spheres. Across a crease they count
/// only as far as it lies flat (1 - crease_share of its dihedral angle) and is no crease that is
/// remembered.
class CreasedNormals {
 public:
  /// creases  edges (smaller vertex first, sorted) along which the mesh may fold sharply
  /// sharp    of each crease: it is sharp however small its angle; empty: none is
  CreasedNormals(const Triangles&, const std::vector<std::pair<int, int>>& creases,
                 const std::vector<char>& sharp = {});

  /// |T|x3 number of the normal at each corner. Vertex v has normal v; where creases meet it has
  /// further normals, numbered from |V| on.
  const Triangles& of_corner() const { return of_corner_; }

  /// Unit normals, one in each row, as many as of_corner() refers to.
  /// least  crease_share that each crease has at least, numbered as they were given; empty: none
  Points3 normals(const Points3& x, const std::vector<double>& least = {}) const;

  /// How sharply the sheet is folded at each vertex: the largest |dihedral angle| of its creases.
  /// |V| [rad]
  Eigen::VectorXd strength(const Points3& x) const;

 private:
  struct Crossroads {         // a vertex with creases: the sectors around it, counter-clockwise
    std::vector<int> normal;  // number of the normal of each sector
    // index in creases_ of the crease between this sector and the next; -1: border
    std::vector<int> after;
  };
  int vertices_ = 0, normals_ = 0;
  Triangles triangles_, of_corner_;
  std::vector<Hinge> creases_;
  std::vector<char> sharp_;          // of each crease
  std::vector<std::size_t> number_;  // of each crease among those that were given
  std::vector<Crossroads> crossroads_;
};

}  // namespace paperbake
