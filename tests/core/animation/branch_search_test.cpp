#include "core/animation/branch_search.h"

#include "core/animation/animate.h"
#include "core/methods/fem.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr double length = 0.1, width = 0.05;

/// A strip whose hinged ends are closer by `shortening` of its length, on the elastica with one or
/// two half waves.
struct Strip {
  Sheet sheet = test::strip_sheet(length, width, 16);
  Elastic elastic{Paper{}, {}};
  StepInput input;
  ElasticReport report;

  Strip(int half_waves, double shortening) {
    for (int v = 0; v < sheet.x.rows(); ++v) {
      const double s = sheet.pattern(v, 0) / length;
      sheet.x.row(v) << (1 - shortening) * s * length, sheet.pattern(v, 1),
          0.6 * length / half_waves * std::sqrt(shortening) * std::sin(half_waves * M_PI * s);
      if (s < 1e-9 || s > 1 - 1e-9) input.constraints.push_back({v, sheet.x.row(v)});
    }
    elastic.set_mesh(sheet);
    for (int k = 0; k < 6; ++k) step();
  }
  void step() { report = elastic.step(sheet, input, 1 / 24.0); }
};

// Two half waves store four times as much as one: each of them is the arch of half the length at
// the same shortening.
TEST(BranchSearchTest, AStripInTheHighModeIsBroughtToTheLowOne) {
  Strip strip(2, 0.1);
  // [J] closed form of the elastica
  const double arch = 1.0126 * Paper{}.bending_stiffness / length * width;
  ASSERT_NEAR(strip.report.energy / arch, 4, 0.08);
  const BranchSearch found =
      probe_branches(strip.sheet, strip.elastic, strip.input, {1 / 24.0, 1, 6});
  EXPECT_TRUE(found.taken);
  EXPECT_NEAR(found.before / arch, 4, 0.08);
  EXPECT_NEAR(found.after / arch, 1, 0.02);
  EXPECT_NE(note_of(found).find("bistable: a probe found a branch 75 % lower"), std::string::npos)
      << note_of(found);
  strip.step();
  EXPECT_TRUE(strip.report.converged);
  EXPECT_NEAR(strip.report.energy / arch, 1, 0.02);
  for (const PositionConstraint& c : strip.input.constraints)
    EXPECT_LT((strip.sheet.x.row(c.vertex).transpose() - c.target).norm(), 1e-12);
}

TEST(BranchSearchTest, ALowArchHasAMirrorImageOfEqualEnergyAndStaysWhereItIs) {
  Strip strip(1, 0.001), alone(1, 0.001);
  ASSERT_GT(strip.sheet.x.col(2).maxCoeff(), 0.0015);
  ASSERT_TRUE(strip.sheet.x == alone.sheet.x);
  const BranchSearch found =
      probe_branches(strip.sheet, strip.elastic, strip.input, {1 / 24.0, 1, 6});
  EXPECT_FALSE(found.taken);
  EXPECT_TRUE(found.equal);
  EXPECT_NE(note_of(found).find("bistable: another branch of equal energy"), std::string::npos)
      << note_of(found);
  for (int k = 0; k < 3; ++k) {  // no trace to the last bit, in the following steps either
    EXPECT_TRUE(strip.sheet.x == alone.sheet.x && strip.sheet.v == alone.sheet.v) << k;
    for (Strip* s : {&strip, &alone}) {
      s->input.constraints[0].target.x() += 1e-4;
      s->step();
    }
  }
}

TEST(BranchSearchTest, ASheetWithOnlyOneShapeGetsNoNote) {
  Strip flat(1, 0);
  const BranchSearch found = probe_branches(flat.sheet, flat.elastic, flat.input, {1 / 24.0, 1, 6});
  EXPECT_FALSE(found.taken || found.equal);
  EXPECT_EQ(note_of(found), "");
}

struct Played {
  std::vector<Points3> x;
  std::vector<std::string> notes;
  std::vector<double> energy;
};
Played play(const Shot& shot, int last_frame, int probe_every) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.plasticity = Plasticity::on;
  options.probe_every = probe_every;
  Played played;
  animate(shot, fem(100), options, [&](const AnimatedFrame& f) {
    played.x.push_back(f.sheet->x);
    played.notes.push_back(f.note);
    played.energy.push_back(f.statistics.energy);
    return true;
  });
  return played;
}

TEST(BranchSearchTest, ASearchThatFindsNothingChangesNoBitOfAShot) {
  const Shot shot = test::s1_push();
  const Played off = play(shot, 20, 0), on = play(shot, 20, 5);
  ASSERT_EQ(off.x.size(), 20u);
  for (std::size_t f = 0; f < off.x.size(); ++f) EXPECT_TRUE(off.x[f] == on.x[f]) << f;
  for (std::size_t f = 0; f < off.x.size(); ++f) {
    if ((f + 1) % 5 != 0) {
      EXPECT_EQ(on.notes[f], "") << f;
    }
  }
}

}  // namespace
}  // namespace paperbake
