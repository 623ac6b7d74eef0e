#include "formats/cache/alembic_properties.h"

#include <algorithm>

namespace paperbake::alembic {
namespace {

constexpr const char* xform_object =
    "schema=AbcGeom_Xform_v3;schemaObjTitle=AbcGeom_Xform_v3:.xform";
constexpr const char* xform_schema = "schema=AbcGeom_Xform_v3";
constexpr const char* box_metadata = "interpretation=box";

}  // namespace

std::string geometry_metadata(const std::string& schema) {
  return "schema=" + schema + ";schemaBaseType=AbcGeom_GeomBase_v1";
}

std::string object_metadata(const std::string& schema, const std::string& compound) {
  return geometry_metadata(schema) + ";schemaObjTitle=" + schema + ":" + compound;
}

std::string parameter_metadata(const std::string& scope, const std::string& interpretation,
                               int extent, const std::string& number, int list) {
  return "arrayExtent=" + std::to_string(list) + ";geoScope=" + scope +
         (interpretation.empty() ? "" : ";interpretation=" + interpretation) +
         ";isGeomParam=true;podExtent=" + std::to_string(extent) + ";podName=" + number;
}

Floats3 y_up(const Points3& rows) {
  Floats3 turned(rows.rows(), 3);
  turned << rows.col(0).cast<float>(), rows.col(2).cast<float>(), -rows.col(1).cast<float>();
  turned.array() += 0.0f;  // -0 becomes 0, so that equal values have equal keys
  return turned;
}

Box box_of(const Floats3& points) {
  Box box;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      box.sides[axis] = std::min<double>(box.sides[axis], points(i, axis));
      box.sides[axis + 3] = std::max<double>(box.sides[axis + 3], points(i, axis));
    }
  return box;
}

Box around(const Box& a, const Box& b) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.sides[axis] = std::min(a.sides[axis], b.sides[axis]);
    box.sides[axis + 3] = std::max(a.sides[axis + 3], b.sides[axis + 3]);
  }
  return box;
}

Property animated(std::string name, std::string metadata, PropertyType type, Pod pod,
                  std::uint32_t extent, std::vector<Sample> samples) {
  return {std::move(name),      std::move(metadata), type, pod, extent,
          TimeSampling::frames, std::move(samples),  {}};
}

Property compound(std::string name, std::string metadata, std::vector<Property> members) {
  Property property;
  property.name = std::move(name);
  property.metadata = std::move(metadata);
  property.members = std::move(members);
  return property;
}

Property box_property(const char* name, std::vector<Sample> samples) {
  return animated(name, box_metadata, PropertyType::scalar, Pod::f64, 6, std::move(samples));
}

Object below_xform(Archive& archive, const std::string& name, std::vector<Sample> bounds,
                   Object shape) {
  const char inherits = 1;
  Property inherited{".inherits",
                     "",
                     PropertyType::scalar,
                     Pod::boolean,
                     1,
                     TimeSampling::identity,
                     {store(archive, {&inherits, 1})},
                     {}};
  std::vector<Property> transform{box_property(".childBnds", std::move(bounds)), inherited};
  return {name,
          xform_object,
          {compound(".xform", xform_schema, std::move(transform))},
          {std::move(shape)}};
}

}  // namespace paperbake::alembic
