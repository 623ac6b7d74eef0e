#include "core/step2_crumple/crumple.h"

#include "core/geometry/hinges.h"
#include "tests/core/step2_crumple/ridge_and_valley.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace paperbake {
namespace {

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

TEST(CrumpleTest, PersistentConflictBearsASingularPointSoonerWhenSevere) {
  const Sheet sheet = test::ridge_and_valley();
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

}  // namespace
}  // namespace paperbake
