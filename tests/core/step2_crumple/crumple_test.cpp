#include "core/step2_crumple/crumple.h"

#include "core/animation/animate.h"
#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/geometry/random.h"
#include "core/step2_crumple/edge_flips.h"
#include "core/step2_crumple/singular_points.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <set>

namespace paperbake {
namespace {

/// How far the folded edges of the sheet run across its rulings instead of along them:
/// sum |theta| l |across . edge| / sum |theta| l.
double misalignment(const Sheet& sheet, const Vector2d& across) {
  double off = 0, all = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d edge =
        (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).transpose();
    const double weight = std::abs(dihedral_angle(sheet.x, hinge)) * edge.norm();
    off += weight * std::abs(edge.normalized().dot(across));
    all += weight;
  }
  return off / all;
}

TEST(CrumpleTest, EdgesFlipTowardsTheRulingsOfACylinder) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.25, 5);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {  // rulings at 40 degrees
    const double c = std::cos(0.7), s = std::sin(0.7), R = 0.04;
    const double u = c * sheet.pattern(v, 0) + s * sheet.pattern(v, 1),
                 w = -s * sheet.pattern(v, 0) + c * sheet.pattern(v, 1);
    sheet.x.row(v) << R * std::sin(u / R), w, R * (std::cos(u / R) - 1);
  }
  const Vector2d across(std::cos(0.7), std::sin(0.7));
  const double before = misalignment(sheet, across), stretch = length_distortion(sheet).mean;
  const Points3 curvature = vertex_curvature(sheet);
  EXPECT_GT(flip_towards_rulings(sheet, curvature, 0.8), 5);
  EXPECT_LT(misalignment(sheet, across), 0.8 * before);
  EXPECT_LT(length_distortion(sheet).mean, stretch);  // edges along rulings keep their length
  test::expect_sound(sheet, 0.01);
  EXPECT_EQ(flip_towards_rulings(sheet, curvature, 0.8), 0);  // nothing is left to flip
}

/// Energies of a sheet that stores nothing.
LocalEnergies nothing_stored(const Sheet& sheet) {
  return {Eigen::VectorXd::Zero(sheet.triangles.rows()),
          Eigen::VectorXd::Zero(sheet.triangles.rows()), Points2::Zero(sheet.pattern.rows(), 2)};
}

TEST(CrumpleTest, NoFoldedEdgeFlipsOnASheetWithThreeSingularPoints) {
  Sheet smooth = test::hex_sheet(0.1, 0.1, 8, 0.25, 5);
  for (int v = 0; v < smooth.pattern.rows(); ++v)
    smooth.x(v, 2) = 12 * std::pow(smooth.pattern(v, 0) + smooth.pattern(v, 1) - 0.1, 2);
  Sheet broken = smooth;
  for (const double u : {0.03, 0.05, 0.07}) broken.singular.push_back({{u, 0.05}, 1, "test"});
  const auto folded_edges = [](const Sheet& sheet) {
    std::set<std::pair<int, int>> edges;
    for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
      if (std::abs(dihedral_angle(sheet.x, hinge)) > 4 * M_PI / 180)
        edges.insert(std::minmax(hinge.vertices[0], hinge.vertices[1]));
    return edges;
  };
  const auto before = folded_edges(broken);
  ASSERT_GT(before.size(), 50u);
  const auto flips = [](Sheet& sheet) {
    Crumple crumple(test::rectangle(0.1, 0.1), Paper{}, {}, 1, 0);
    int flips = 0;
    for (int frame = 1; frame <= 4; ++frame)
      flips += crumple
                   .step(sheet, std::vector<char>(sheet.pattern.rows(), 1), {frame},
                         {0.005, true, true}, [&] { return nothing_stored(sheet); })
                   .flips;
    return flips;
  };
  EXPECT_GT(flips(smooth), 5);
  EXPECT_LT(flips(broken), 5);
  const auto after = folded_edges(broken);
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
}

TEST(CrumpleTest, FlatSheetKeepsItsNearlyDelaunayMesh) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  EXPECT_EQ(flip_towards_rulings(sheet, vertex_curvature(sheet), 0.8), 0);
}

TEST(CrumpleTest, SaddleHasConflictsAndACylinderHasNone) {
  Sheet cylinder = test::hex_sheet(0.1, 0.1, 10);
  test::roll(cylinder, 0.03);
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    // curvatures of +-24 1/m, in steps of a centimetre: 12 degrees in each direction
    saddle.x(v, 2) = 12 * (a * a - b * b);
  }
  const std::vector<char> none;
  const Conflicts smooth = find_conflicts(cylinder, vertex_curvature(cylinder), none, {});
  EXPECT_EQ(std::count(smooth.exceeds.begin(), smooth.exceeds.end(), 1), 0);
  const Conflicts torn = find_conflicts(saddle, vertex_curvature(saddle), none, {});
  EXPECT_GT(std::count(torn.exceeds.begin(), torn.exceeds.end(), 1), 20);
  const std::vector<char> all(saddle.pattern.rows(), 1);
  const Conflicts held = find_conflicts(saddle, vertex_curvature(saddle), all, {});
  EXPECT_EQ(std::count(held.exceeds.begin(), held.exceeds.end(), 1), 0);
}

/// A crease along a row of edges that is a ridge on the right and a valley on the left; the two
/// meet in the middle.
Sheet ridge_and_valley() {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  int middle = 0;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(0.05, 0.05)).rowwise().norm().minCoeff(&middle);
  for (int v = 0; v < sheet.x.rows(); ++v)
    // 0.4 rad on the edges next to the middle
    sheet.x(v, 2) = 40 * std::abs(sheet.pattern(v, 1) - sheet.pattern(middle, 1)) *
                    (sheet.pattern(v, 0) - sheet.pattern(middle, 0));
  return sheet;
}

TEST(CrumpleTest, ConflictShowsWhereFoldsOfBothSignsMeet) {
  Sheet sheet = ridge_and_valley();
  const Points3 curvature = vertex_curvature(sheet);
  CrumpleOptions folds_alone;
  folds_alone.conflict_turn = folds_alone.threshold_near_apex = 10;
  const auto count = [&](const CrumpleOptions& options) {
    const Conflicts c = find_conflicts(sheet, curvature, {}, options);
    return std::count(c.exceeds.begin(), c.exceeds.end(), 1);
  };
  EXPECT_GE(count(folds_alone), 1);
  const Conflicts c = find_conflicts(sheet, curvature, {}, folds_alone);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!c.exceeds[v]) continue;
    // near the middle, not all along the crease
    EXPECT_LT((sheet.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm(), 0.021);
  }
  CrumpleOptions blind = folds_alone;
  blind.conflict_folds = blind.fold_threshold_near_apex = 10;
  EXPECT_EQ(count(blind), 0);
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (c.exceeds[v]) sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
  CrumpleOptions greedy = folds_alone;
  greedy.fold_threshold_near_apex = 0.01;
  EXPECT_GT(count(greedy), count(folds_alone));  // next to a singular point
}

TEST(CrumpleTest, PersistentConflictBearsASingularPointSoonerWhenSevere) {
  const Sheet sheet = ridge_and_valley();
  // the travel in a frame [1] of the longer side; the conflict is the same in every frame
  const auto frames_to_birth = [&](const CrumpleOptions& options, double travel, double dt = 0.04) {
    Crumple crumple(test::rectangle(0.1, 0.1), Paper{}, options, 1, 0);
    for (int frame = 1; frame <= 80; ++frame) {
      Sheet now = sheet;
      const auto stored = [&] { return nothing_stored(now); };
      if (crumple.step(now, {}, {frame, dt}, {travel, true, true}, stored).births > 0) return frame;
    }
    return 0;
  };
  CrumpleOptions options;
  options.conflict_turn = options.threshold_near_apex = options.fold_threshold_near_apex = 10;
  options.max_triangles = 1000;
  options.persistence = 0.02;
  EXPECT_EQ(frames_to_birth(options, 0.004), 5);
  EXPECT_EQ(frames_to_birth(options, 0.002), 10);
  EXPECT_EQ(frames_to_birth(options, 0.002, 0.01), 10);  // whatever time it takes
  EXPECT_EQ(frames_to_birth(options, 0.1), 4);           // a frame counts for half a percent
  EXPECT_EQ(frames_to_birth(options, 0), 0);             // nothing is born where nothing moves
  options.fold_threshold_near_apex = 0.2;
  options.persistence_severe = 0.006;
  EXPECT_EQ(frames_to_birth(options, 0.003), 2);
}

TEST(CrumpleTest, ThresholdsAreHigherNextToASingularPoint) {
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    saddle.x(v, 2) = 12 * (a * a - b * b);
  }
  int inner = 0;
  for (int v = 0; v < saddle.pattern.rows(); ++v)
    if ((saddle.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm() <
        (saddle.pattern.row(inner) - Eigen::RowVector2d(0.05, 0.05)).norm())
      inner = v;
  saddle.singular.push_back({saddle.pattern.row(inner).transpose(), 1, "test"});
  const auto exceeds = [&](double threshold_near_apex) {
    CrumpleOptions options;
    options.threshold_near_apex = threshold_near_apex;
    const Conflicts c = find_conflicts(saddle, vertex_curvature(saddle), {}, options);
    return std::count(c.exceeds.begin(), c.exceeds.end(), 1);
  };
  EXPECT_EQ(exceeds(0.14) - exceeds(1.0), 6);  // the six neighbours of the point in the lattice
}

}  // namespace
}  // namespace paperbake
