#pragma once

#include "core/model/sheet.h"

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace paperbake {

/// Custom properties of an object, by name.
using AuthoredProperties =
    std::map<std::string, std::variant<double, std::string, std::vector<double>>>;

/// What an artist has put on the mesh of a sheet, corner by corner of its triangles.
struct AuthoredSurface {
  struct UvSet {
    std::string name;
    Points2 uv;  // 3|T|x2, v up: corner k of triangle t in row 3t + k
  };
  Points2 pattern;      // |V|x2 [m] where the vertices of the artist's mesh lie on the pattern
  Triangles triangles;  // |T|x3
  std::vector<UvSet> uv_sets;
  std::vector<std::string> materials;
  // |T| of each triangle, in `materials`; -1: none. Empty without materials
  std::vector<int> material_of;
  AuthoredProperties properties;
};

/// The same on another mesh of the sheet.
struct MeshSurface {
  struct UvSet {
    std::string name;
    Points2 uv;           // v up
    Triangles of_corner;  // |T|x3 row of uv
  };
  std::vector<UvSet> uv_sets;
  std::vector<std::string> materials;
  std::vector<int> material_of;  // as in AuthoredSurface
  AuthoredProperties properties;
};

}  // namespace paperbake
