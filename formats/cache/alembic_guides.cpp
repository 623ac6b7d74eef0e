#include "formats/cache/alembic_guides.h"

#include "formats/cache/alembic_properties.h"
#include "formats/files/bytes_of.h"

#include <cstdint>

namespace paperbake::alembic {
namespace {

constexpr const char* points_schema = "AbcGeom_Points_v1";
constexpr const char* curves_schema = "AbcGeom_Curve_v2";

std::string whole_number_of(const char* scope) {
  return parameter_metadata(scope, "", 1, "int32_t");
}

Sample store_whole(Archive& archive, const std::vector<int>& numbers) {
  return store(archive, bytes_of_values(std::vector<std::int32_t>(numbers.begin(), numbers.end())));
}

using Geometry = GuideFrame::Geometry;

std::vector<Sample> column(const std::vector<GuideFrame>& frames, Geometry GuideFrame::*guide,
                           Sample Geometry::*channel) {
  std::vector<Sample> samples;
  for (const GuideFrame& frame : frames) samples.push_back(frame.*guide.*channel);
  return samples;
}

Object points_of(const std::vector<GuideFrame>& frames, const std::string& name) {
  const auto array = [&](const char* property, const std::string& metadata, Pod pod,
                         std::uint32_t extent, Sample Geometry::*channel) {
    return animated(property, metadata, PropertyType::array, pod, extent,
                    column(frames, &GuideFrame::points, channel));
  };
  std::vector<Property> members{
      box_property(".selfBnds", column(frames, &GuideFrame::points, &Geometry::bounds)),
      array("P", point_metadata, Pod::f32, 3, &Geometry::positions),
      array(".pointIds", "", Pod::u64, 1, &Geometry::sizes),
      compound(".arbGeomParams", "",
               {array("point_id", whole_number_of("vtx"), Pod::i32, 1, &Geometry::id),
                array("birth", whole_number_of("vtx"), Pod::i32, 1, &Geometry::birth)})};
  return {name + "Shape",
          object_metadata(points_schema),
          {compound(".geom", geometry_metadata(points_schema), std::move(members))},
          {}};
}

Object folds_of(Archive& archive, const std::vector<GuideFrame>& frames, const std::string& name) {
  const auto array = [&](const char* property, const std::string& metadata, Pod pod,
                         std::uint32_t extent, Sample Geometry::*channel) {
    return animated(property, metadata, PropertyType::array, pod, extent,
                    column(frames, &GuideFrame::folds, channel));
  };
  const std::vector<char> linear{1, 0, 0, 0};  // straight, open, without a basis
  const std::vector<Sample> type(frames.size(), store(archive, bytes_of_values(linear)));
  std::vector<Property> members{
      box_property(".selfBnds", column(frames, &GuideFrame::folds, &Geometry::bounds)),
      array("P", point_metadata, Pod::f32, 3, &Geometry::positions),
      array("nVertices", "", Pod::i32, 1, &Geometry::sizes),
      animated("curveBasisAndType", "", PropertyType::scalar, Pod::u8, 4, type),
      compound(".arbGeomParams", "",
               {array("fold_id", whole_number_of("uni"), Pod::i32, 1, &Geometry::id),
                array("birth", whole_number_of("uni"), Pod::i32, 1, &Geometry::birth),
                array("angle", parameter_metadata("vtx", "", 1), Pod::f32, 1, &Geometry::angle)})};
  return {name + "Shape",
          object_metadata(curves_schema),
          {compound(".geom", geometry_metadata(curves_schema), std::move(members))},
          {}};
}

}  // namespace

GuideFrame store_guides(Archive& archive, const CacheGuides& guides) {
  GuideFrame frame;
  const Floats3 points = y_up(guides.points), folds = y_up(guides.folds);
  frame.points.bounds = store(archive, bytes_of_values(box_of(points).sides));
  frame.points.positions = store(archive, bytes_of_values(points));
  frame.points.sizes = store(archive, bytes_of_values(std::vector<std::uint64_t>(
                                          guides.point_id.begin(), guides.point_id.end())));
  frame.points.id = store_whole(archive, guides.point_id);
  frame.points.birth = store_whole(archive, guides.point_birth);
  frame.folds.bounds = store(archive, bytes_of_values(box_of(folds).sides));
  frame.folds.positions = store(archive, bytes_of_values(folds));
  frame.folds.sizes = store_whole(archive, guides.fold_size);
  frame.folds.id = store_whole(archive, guides.fold_id);
  frame.folds.birth = store_whole(archive, guides.fold_birth);
  frame.folds.angle = store(archive, bytes_of_values(guides.angle.cast<float>().eval()));
  return frame;
}

std::vector<Object> guide_objects(Archive& archive, const std::vector<GuideFrame>& frames,
                                  const GuideLabels& labels) {
  if (frames.empty()) return {};
  return {
      below_xform(archive, labels.points, column(frames, &GuideFrame::points, &Geometry::bounds),
                  points_of(frames, labels.points)),
      below_xform(archive, labels.folds, column(frames, &GuideFrame::folds, &Geometry::bounds),
                  folds_of(archive, frames, labels.folds))};
}

}  // namespace paperbake::alembic
