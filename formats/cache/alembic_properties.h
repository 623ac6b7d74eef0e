#pragma once

#include "core/model/sheet.h"
#include "formats/cache/alembic_archive.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

/// What the schemas of AbcGeom have in common: boxes, positions, properties over time, transforms.
namespace paperbake::alembic {

// Metadata: readers recognise objects and channels only by these texts.
inline constexpr const char* point_metadata = "geoScope=vtx;interpretation=point";

/// Of the compound that holds a geometry.
/// schema  name and version, for example "AbcGeom_PolyMesh_v1"
std::string geometry_metadata(const std::string& schema);

/// Of the object that the compound belongs to.
/// compound  name of the compound
std::string object_metadata(const std::string& schema, const std::string& compound = ".geom");

/// Of an array that belongs to a geometry.
/// scope           what has one element of it: "vtx" a vertex, "fvr" a corner of a face, "uni" a
///                 curve
/// interpretation  what it means to readers, for example "normal"; empty: numbers
/// extent          numbers per element
/// list            elements that belong together
std::string parameter_metadata(const std::string& scope, const std::string& interpretation,
                               int extent, const std::string& number = "float32_t", int list = 1);

using Floats3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A bounding box.
struct Box {
  static constexpr double huge = std::numeric_limits<double>::max();
  // [m] min x y z, max x y z, as in the file; initially empty, as readers expect of an empty mesh
  std::array<double, 6> sides{huge, huge, huge, -huge, -huge, -huge};
};

Box box_of(const Floats3& points);
Box around(const Box&, const Box&);

/// From z up to y up, in 32 bits; -0 becomes 0, so that equal values have equal keys.
Floats3 y_up(const Points3& rows);

/// A property with a sample for each frame.
Property animated(std::string name, std::string metadata, PropertyType, Pod, std::uint32_t extent,
                  std::vector<Sample>);
Property compound(std::string name, std::string metadata, std::vector<Property> members);
Property box_property(const char* name, std::vector<Sample>);

/// A shape below an Xform that carries its name and transforms nothing, as programs expect it.
/// bounds  of each frame
Object below_xform(Archive&, const std::string& name, std::vector<Sample> bounds, Object shape);

}  // namespace paperbake::alembic
