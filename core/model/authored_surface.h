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

/// What the numbers of an attribute are: texture coordinates (2, v up), a colour (3, or 4 with
/// alpha), or whatever the artist means by them (1 to 4).
enum class AttributeKind { uv, colour, number };

/// One to four numbers in each row.
using AttributeValues =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, Eigen::Dynamic, 4>;

/// Numbers that an artist has put on a mesh under a name.
struct AuthoredAttribute {
  std::string name;
  AttributeKind kind = AttributeKind::number;
  AttributeValues values;
};

/// What an artist has put on the mesh of a sheet, corner by corner of its triangles.
struct AuthoredSurface {
  Points2 pattern;      // |V|x2 [m] where the vertices of the artist's mesh lie on the pattern
  Triangles triangles;  // |T|x3
  // of 3|T| rows: corner k of triangle t has row 3t + k; the uv sets come first
  std::vector<AuthoredAttribute> attributes;
  std::vector<std::string> materials;
  // |T| of each triangle, in `materials`; -1: none. Empty without materials
  std::vector<int> material_of;
  AuthoredProperties properties;
};

/// The same on another mesh of the sheet.
struct MeshSurface {
  struct Attribute {
    std::string name;
    AttributeKind kind = AttributeKind::number;
    AttributeValues values;
    Triangles of_corner;  // |T|x3 row of the values
  };
  std::vector<Attribute> attributes;  // the uv sets come first
  std::vector<std::string> materials;
  std::vector<int> material_of;  // as in AuthoredSurface
  AuthoredProperties properties;
};

/// Whether the first attribute is a uv set.
template <class Attribute>
bool has_uv(const std::vector<Attribute>& attributes) {
  return !attributes.empty() && attributes.front().kind == AttributeKind::uv;
}

}  // namespace paperbake
