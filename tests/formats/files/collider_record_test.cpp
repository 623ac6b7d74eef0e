#include "formats/files/collider_record.h"

#include "core/geometry/rigid_motion.h"
#include "core/model/error.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

ColliderRecord two_sheets_over_a_moving_plane() {
  ColliderMesh plane{"ground \"A\"", Points3(4, 3), Triangles(2, 3), {}};
  plane.x << -0.5, -0.5, 0.1 / 3, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0;
  plane.triangles << 0, 1, 2, 0, 2, 3;
  plane.frames.own() = {plane.x, (plane.x / 7).rowwise() + Eigen::RowVector3d(1e-17, 1.0 / 7, -3)};
  ColliderRecord record;
  record.first_frame = 10;
  record.of_sheet["above"] = {plane, plane};
  plane.triangles.col(1).swap(plane.triangles.col(2));
  record.of_sheet["below"] = {record.of_sheet["above"][0], plane};
  record.of_sheet["below"][1].paper_side = ColliderMesh::PaperSide::inside;
  return record;
}

TEST(ColliderRecord, ReadsBackToTheLastBit) {
  const ColliderRecord record = two_sheets_over_a_moving_plane();
  const ColliderRecord read = parse_collider_json(collider_json(record));
  EXPECT_EQ(read.first_frame, 10);
  ASSERT_EQ(read.of_sheet.size(), 2u);
  for (const auto& [sheet, meshes] : record.of_sheet) {
    const auto& found = read.of_sheet.at(sheet);
    ASSERT_EQ(found.size(), meshes.size());
    for (std::size_t c = 0; c < meshes.size(); ++c) {
      EXPECT_EQ(found[c].name, meshes[c].name);
      EXPECT_EQ(found[c].x, meshes[c].x);
      EXPECT_EQ(found[c].triangles, meshes[c].triangles) << sheet << " " << c;
      EXPECT_EQ(found[c].paper_side == ColliderMesh::PaperSide::inside,
                meshes[c].paper_side == ColliderMesh::PaperSide::inside);
      ASSERT_EQ(found[c].frames.size(), 2u);
      EXPECT_EQ(found[c].frames[1], meshes[c].frames[1]);
    }
  }
  EXPECT_NE(read.of_sheet.at("above")[1].triangles, read.of_sheet.at("below")[1].triangles);
}

TEST(ColliderRecord, FramesOfWhatMovesAsAWholeAreToldByTheirMotion) {
  ColliderMesh cone{"cone", Points3(4, 3), Triangles(2, 3), {}};
  cone.x << 0, 0, 0.3, 0.2, 0, 0, 0, 0.1, 0, -0.1, -0.1, 0;
  cone.triangles << 0, 1, 2, 0, 2, 3;
  const RigidMotion motion{
      Eigen::AngleAxisd(2.5, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix(),
      Vector3d(3, -1, 0.7)};
  const Points3 mirrored = cone.x * Vector3d(1, 1, -1).asDiagonal();
  cone.frames.own() = {cone.x, moved(motion, cone.x), mirrored};
  ColliderRecord record;
  record.of_sheet["sheet"] = {cone};
  const std::string text = collider_json(record);
  const ColliderMesh read = parse_collider_json(text).of_sheet.at("sheet")[0];
  ASSERT_EQ(read.frames.size(), 3u);
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_LT((read.frames[f] - cone.frames[f]).cwiseAbs().maxCoeff(), 1e-7) << f;
  const auto count = [&](const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("\"turn\""), 2u) << text;  // a mirror image is no motion
}

TEST(ColliderRecord, WhatIsDamagedIsRefused) {
  const std::string text = collider_json(two_sheets_over_a_moving_plane());
  EXPECT_THROW(parse_collider_json(""), Error);
  EXPECT_THROW(parse_collider_json("{}"), Error);
  EXPECT_THROW(parse_collider_json(text.substr(0, text.size() / 2)), Error);
  std::string wrong = text;
  wrong.replace(wrong.find("[0,2,3]"), 7, "[0,2,9]");
  EXPECT_THROW(parse_collider_json(wrong), Error);
}

TEST(ColliderRecord, AMotionThatIsNoneAndVerticesThatAreNowhereAreRefused) {
  const auto with = [](const std::string& frame, const std::string& x = "0") {
    return R"({"first_frame":1,"colliders":[{"name":"c","vertices":[[)" + x +
           R"(,0,0],[1,0,0],[0,1,0]],"triangles":[[0,1,2]],"frames":[)" + frame +
           R"(]}],"turned":{"paper":[]},"inside_of":{"paper":[]}})";
  };
  const std::string straight = R"({"turn":[1,0,0,0,1,0,0,0,1],"shift":[0,0,1]})";
  EXPECT_EQ(parse_collider_json(with(straight)).of_sheet.at("paper")[0].frames[0](0, 2), 1);
  for (const char* damaged :
       {R"({"turn":[1e308,1e308,1e308,1e308,1e308,1e308,1e308,1e308,1e308],"shift":[0,0,0]})",
        R"({"turn":[2,0,0,0,2,0,0,0,2],"shift":[0,0,0]})",
        R"({"turn":[-1,0,0,0,1,0,0,0,1],"shift":[0,0,0]})",
        R"({"turn":[1,0,0,0,1,0,0,0,1,0],"shift":[0,0,0]})",
        R"({"turn":[1,0,0,0,1,0,0,0,1],"shift":[0,0,0,0]})",
        R"({"turn":[1,0,0,0,1,0,0,0,1],"shift":[1e200,0,0]})", "[1e200,0,0,1,0,0,0,1,0]"})
    EXPECT_THROW(parse_collider_json(with(damaged)), Error) << damaged;
  EXPECT_THROW(parse_collider_json(with(straight, "1e200")), Error);
}

}  // namespace
}  // namespace paperbake
