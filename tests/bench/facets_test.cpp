#include "tests/bench/facets.h"

#include "core/step1_elastic/energies/elastic_energy.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace paperbake {
namespace {

/// A strip of 60 x 20 mm in cells of 10 mm.
Sheet strip() { return test::strip_sheet(0.06, 0.02, 6); }

/// |hinges| `turn` at the edges across the strip at these places [m], else nothing.
std::vector<double> folded_at(const Sheet& sheet, const Hinges& hinges,
                              const std::vector<double>& places, double turn) {
  std::vector<double> turns;
  for (const Hinge& hinge : hinges.hinges) {
    const double a = sheet.pattern(hinge.vertices[0], 0), b = sheet.pattern(hinge.vertices[1], 0);
    double at = 0;
    for (const double place : places)
      if (std::abs(a - place) < 1e-9 && std::abs(b - place) < 1e-9) at = turn;
    turns.push_back(at);
  }
  return turns;
}

TEST(Facets, CreasesFromBorderToBorderPartTheSheet) {
  const Sheet sheet = strip();
  const Hinges hinges = find_hinges(sheet.triangles);
  const Facets one = find_facets(sheet, hinges, folded_at(sheet, hinges, {0.02, 0.03}, 0.1), 0.2);
  EXPECT_EQ(one.area.size(), 1u);
  EXPECT_EQ(one.crease_length, 0);
  const Facets three =
      find_facets(sheet, hinges, folded_at(sheet, hinges, {0.02, 0.03}, -0.3), 0.2);
  ASSERT_EQ(three.area.size(), 3u);
  EXPECT_NEAR(three.area[0], 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(three.area[1], 0.01 * 0.02, 1e-12);
  EXPECT_NEAR(three.area[2], 0.03 * 0.02, 1e-12);
  EXPECT_NEAR(three.crease_length, 0.04, 1e-12);
}

TEST(Facets, PlasticTurnOfOneFoldedEdgeIsItsAngle) {
  const Sheet sheet = strip();
  const Hinges hinges = find_hinges(sheet.triangles);
  const std::vector<double> folded = folded_at(sheet, hinges, {0.03}, 0.4);
  PlasticMemory memory(static_cast<int>(sheet.triangles.rows()));
  // what bending.h makes of the angle: theta l/A n n^T in both triangles
  for (std::size_t h = 0; h < folded.size(); ++h)
    if (folded[h] > 0)
      for (const int t : hinges.hinges[h].triangles)
        memory.curvature(t, 0) = folded[h] * 0.02 / (0.01 * 0.02);
  const std::vector<double> turns = plastic_turns(sheet, hinges, memory);
  ASSERT_EQ(std::count(folded.begin(), folded.end(), 0.4), 1);
  ASSERT_EQ(turns.size(), folded.size());
  // The tensor of a triangle n n^T has a part in the directions across its other edges, too, which
  // are the diagonals of the two cells: theta/2 from one triangle, times l/l' (n.n')^2.
  const double diagonal = std::hypot(0.01, 0.02), cosine = 0.02 / diagonal;
  const double part = 0.4 / 2 * 0.02 / diagonal * cosine * cosine;
  int diagonals = 0;
  for (std::size_t h = 0; h < folded.size(); ++h) {
    const auto [one, other] = hinges.hinges[h].triangles;
    const double beside = memory.curvature(one, 0) + memory.curvature(other, 0);
    const bool is_diagonal = folded[h] == 0 && beside > 0;
    diagonals += is_diagonal;
    EXPECT_NEAR(turns[h], is_diagonal ? part : folded[h], 1e-12) << h;
  }
  EXPECT_EQ(diagonals, 2);
}

TEST(Facets, LawHasTheFacetsAndCreasesOfItsSource) {
  // the law integrated: mean area and mean number from the distribution itself
  for (const double height : {0.6, 0.3}) {
    const FacetLaw law(height, 0.135);
    double area = 0;
    constexpr int steps = 40000;
    constexpr double all = 8;  // [1] no root of an area is larger, but for 1e-9 of them
    for (int i = 0; i < steps; ++i) {
      const double a = all * i / steps, b = all * (i + 1) / steps, middle = 0.5 * (a + b);
      area += middle * middle * (law.share_below(b) - law.share_below(a));
    }
    EXPECT_NEAR(area * law.facets(), 1, 1e-3) << height;
    EXPECT_NEAR(law.share_below(all), 1, 1e-9);
  }
  EXPECT_NEAR(FacetLaw(0.6, 0.135).facets(), 34, 0.5);
  EXPECT_NEAR(FacetLaw(0.3, 0.135).crease_length(), 18.3, 0.1);
}

TEST(Facets, OneSampleOfTwentyIsFartherFromTheLawThanSaid) {
  const FacetLaw law(0.3, 0.135);
  std::mt19937 random(1);
  std::gamma_distribution<double> gamma(law.a, 1 / law.t);
  int far = 0;
  for (int sample = 0; sample < 400; ++sample) {
    std::vector<double> drawn;
    for (int i = 0; i < 200; ++i) drawn.push_back(std::pow(gamma(random), 2));
    far += distance_from_law(drawn, law) > 1.36;
  }
  EXPECT_NEAR(far, 20, 14);  // three deviations
  EXPECT_GT(distance_from_law(std::vector<double>(200, 1 / law.facets()), law), 5);
}

/// The load is 1 where a facet carries 4 pi^2 D over its width squared.
TEST(Facets, LoadIsThatOfEulerForClampedEnds) {
  const Paper paper;
  Sheet sheet = strip();
  const Hinges hinges = find_hinges(sheet.triangles);
  const double width = 0.06, stress = 4 * M_PI * M_PI * paper.bending_stiffness / (width * width),
               strain = stress / paper.membrane_stiffness;
  // uniaxial: the strip grows wider by Poisson's ratio; Green's strains are half the squares
  sheet.x.col(0) *= std::sqrt(1 - 2 * strain);
  sheet.x.col(1) *= std::sqrt(1 + 2 * paper.poisson * strain);
  ElasticEnergy energy(paper, sheet.pattern, sheet.triangles);
  const Facets whole = find_facets(sheet, hinges, std::vector<double>(hinges.hinges.size()), 0.2);
  const std::vector<FacetLoad> loads = facet_loads(
      sheet, hinges, whole, paper, energy.stress(sheet.x, Points3::Zero(sheet.x.rows(), 3)),
      energy.local_energies(sheet.x));
  ASSERT_EQ(loads.size(), 1u);
  EXPECT_NEAR(loads[0].load, 1, 1e-6);
  EXPECT_NEAR(std::abs(loads[0].direction.x()), 1, 1e-6);
  EXPECT_NEAR(loads[0].membrane_share, 1, 1e-6);
}

}  // namespace
}  // namespace paperbake
