// The error that a coarse mesh makes, as it is found without a reference.

#include "core/animation/animate.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/collider_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>

namespace paperbake {
namespace {

constexpr int last_frame = 44;

struct Simulated {
  std::map<int, Sheet> sheets;       // by frame
  std::map<int, double> mesh_error;  // [1] by frame
};

Simulated simulate(const Shot& shot, const MethodChoice& method, AnimateOptions options) {
  options.last_frame = last_frame;
  Simulated simulated;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    simulated.sheets[f.frame] = *f.sheet;
    simulated.mesh_error[f.frame] = f.statistics.mesh_error;
    return true;
  });
  return simulated;
}

AnimateOptions checked() {
  AnimateOptions options;
  options.checks_mesh = true;
  return options;
}

MethodChoice coarse(const Shot& shot) { return hybrid(shot.pattern, shot.paper, 120, {}, 0, 0); }

TEST(MeshCheck, FindsTheErrorThatFineFiniteElementsShow) {
  const Shot shot = test::s1_push();
  const Simulated on_coarse = simulate(shot, coarse(shot), checked()),
                  fine = simulate(shot, fem(1500), {});
  const PatternSamples samples(shot.pattern);
  const double side = longer_side(shot.pattern);
  int compared = 0;
  for (const int frame : {20, 36, 40, 44}) {
    const double error =
        rms_distance(samples(on_coarse.sheets.at(frame)), samples(fine.sheets.at(frame))) / side;
    // found at most a twentieth of the side ago
    const double found = on_coarse.mesh_error.at(frame);
    EXPECT_GT(found, 0) << frame;
    EXPECT_NEAR(found, error, 0.5 * error + 2e-4) << frame;
    compared += error > 1e-3;
  }
  EXPECT_GE(compared, 2) << "there is an error to be found";
}

TEST(MeshCheck, LeavesTheSheetAsItWas) {
  const Shot shot = test::s1_push();
  AnimateOptions options = checked();
  options.plasticity = Plasticity::on;
  const Simulated with = simulate(shot, coarse(shot), options);
  options.checks_mesh = false;
  const Simulated without = simulate(shot, coarse(shot), options);
  EXPECT_EQ(with.sheets.at(last_frame).x, without.sheets.at(last_frame).x);
  EXPECT_GT(with.mesh_error.at(40), 0);
  EXPECT_EQ(without.mesh_error.at(40), 0);
}

TEST(MeshCheck, SaysNothingWhereThereIsNoOneEquilibriumOrNoCoarseMesh) {
  Shot shot = test::s1_push();
  AnimateOptions moving = checked();
  moving.elastic.inertia = Inertia::dynamic;
  EXPECT_EQ(simulate(shot, coarse(shot), moving).mesh_error.at(40), 0);
  EXPECT_EQ(simulate(shot, fem(200), {}).mesh_error.at(last_frame), 0);
  EXPECT_EQ(
      simulate(shot, hybrid(shot.pattern, shot.paper, 480, {}, 0, 0), {}).mesh_error.at(last_frame),
      0)
      << "that mesh is fine";
  ColliderMesh table = test::ground();
  table.x.col(2).array() += 0.01;  // the arch is pressed against it from below
  shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(table)});
  EXPECT_EQ(simulate(shot, coarse(shot), checked()).mesh_error.at(20), 0);
}

}  // namespace
}  // namespace paperbake
