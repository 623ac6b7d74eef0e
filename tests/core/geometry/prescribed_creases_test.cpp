#include "core/geometry/prescribed_creases.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <utility>

namespace paperbake {
namespace {

/// A sheet with a crease along y = 0.1 from x = 0 to 0.4, which is not folded in the first frame,
/// and another one along x = 0.2, which was folded by -0.5 rad before it.
Sheet creased_sheet(std::vector<CreaseEdge> edges = {}) {
  Sheet sheet;
  sheet.prescribed_creases = {{{{0, 0.1}, {0.4, 0.1}}, 0, false},
                              {{{0.2, 0}, {0.2, 0.2}}, -0.5, true}};
  sheet.crease_edges = std::move(edges);
  return sheet;
}

/// Part of the first crease.
CreaseEdge part(double from, double to, double rest, bool folded = true,
                std::optional<double> pressed = {}) {
  return {{from, 0.1}, {to, 0.1}, rest, folded, pressed};
}

CreaseEdge state(const Sheet& sheet, double from, double to) {
  return crease_edge(sheet, sheet.prescribed_creases[0], {from, 0.1}, {to, 0.1});
}

TEST(PrescribedCreasesTest, AnEdgeOfUnknownStateHasThatOfTheFirstFrame) {
  const Sheet sheet = creased_sheet();
  const CreaseEdge flat = state(sheet, 0, 0.1);
  EXPECT_FALSE(flat.folded);
  EXPECT_EQ(flat.rest_angle, 0);
  EXPECT_FALSE(flat.pressed);
  EXPECT_EQ(flat.a, Vector2d(0, 0.1));
  EXPECT_EQ(flat.b, Vector2d(0.1, 0.1));
  const CreaseEdge drawn = crease_edge(sheet, sheet.prescribed_creases[1], {0.2, 0}, {0.2, 0.1});
  EXPECT_TRUE(drawn.folded);
  EXPECT_EQ(drawn.rest_angle, -0.5);
}

TEST(PrescribedCreasesTest, OnAFinerMeshEachPartHasTheStateOfItsWhole) {
  const Sheet sheet = creased_sheet({part(0, 0.2, 1.5, true, 2.5), part(0.2, 0.4, 0, false)});
  for (int k = 0; k < 8; ++k) {
    const bool backwards = k % 2;
    const double from = 0.05 * k, to = from + 0.05;
    const CreaseEdge edge = backwards ? state(sheet, to, from) : state(sheet, from, to);
    EXPECT_EQ(edge.folded, k < 4) << k;
    EXPECT_NEAR(edge.rest_angle, k < 4 ? 1.5 : 0, 1e-15);
    EXPECT_EQ(edge.pressed, k < 4 ? std::optional<double>(2.5) : std::nullopt);
  }
}

TEST(PrescribedCreasesTest, OnACoarserMeshAnEdgeHasTheMeanOfItsKnownParts) {
  // of the edge from 0.1 to 0.4, a third is not known; the first part reaches beyond it
  const Sheet sheet = creased_sheet(
      {part(0, 0.2, 1.2), part(0.3, 0.2, 0.6), {{0.2, 0}, {0.2, 0.1}, -3, true, 1.0}});
  const CreaseEdge edge = state(sheet, 0.1, 0.4);
  EXPECT_TRUE(edge.folded);
  EXPECT_NEAR(edge.rest_angle, 0.5 * (1.2 + 0.6), 1e-12);
  EXPECT_FALSE(edge.pressed) << "the crease across it is another one";
  // shares count by their length
  EXPECT_NEAR(state(sheet, 0, 0.3).rest_angle, (2 * 1.2 + 0.6) / 3, 1e-12);
}

TEST(PrescribedCreasesTest, AnEdgeIsFoldedWhereAnyPartIsAndNeighboursDoNotCount) {
  const Sheet sheet = creased_sheet({part(0, 0.1, 0.9), part(0.1, 0.2, 0, false)});
  EXPECT_TRUE(state(sheet, 0, 0.2).folded);
  EXPECT_TRUE(state(sheet, 0.1, 0.05).folded);
  EXPECT_FALSE(state(sheet, 0.1, 0.2).folded) << "it touches the folded part in a point";
  EXPECT_FALSE(state(sheet, 0.3, 0.4).folded) << "nothing is known of it";
}

TEST(PrescribedCreasesTest, TheStateSurvivesAFinerMeshAndTheWayBack) {
  Sheet sheet = creased_sheet({part(0, 0.2, 1.5), part(0.2, 0.4, -0.5)});
  const std::vector<CreaseEdge> first = sheet.crease_edges;
  std::vector<CreaseEdge> fine, coarse;
  for (int k = 0; k < 10; ++k) fine.push_back(state(sheet, 0.04 * k, 0.04 * (k + 1)));
  sheet.crease_edges = fine;
  for (const CreaseEdge& edge : first) coarse.push_back(state(sheet, edge.a.x(), edge.b.x()));
  for (std::size_t e = 0; e < first.size(); ++e) {
    EXPECT_NEAR(coarse[e].rest_angle, first[e].rest_angle, 1e-12);
    EXPECT_TRUE(coarse[e].folded);
  }
}

TEST(PrescribedCreasesTest, OnlyEdgesOnAFoldedPartOfACreaseAreFolded) {
  Sheet sheet = test::strip_sheet(0.4, 0.2, 4);  // vertices 2 i and 2 i + 1 at x = 0.1 i
  sheet.prescribed_creases = {{{{0.1, 0}, {0.1, 0.2}}, 0, false},
                              {{{0.2, 0}, {0.2, 0.2}}, -0.5, true}};
  EXPECT_FALSE(is_folded(sheet, 2, 3)) << "on a crease that is not folded yet";
  EXPECT_TRUE(is_folded(sheet, 4, 5));
  EXPECT_TRUE(is_folded(sheet, 5, 4));
  EXPECT_FALSE(is_folded(sheet, 6, 7)) << "on no crease";
  EXPECT_FALSE(is_folded(sheet, 2, 5)) << "ends on two of them";
  sheet.crease_edges = {{{0.1, 0}, {0.1, 0.1}, 0.5, true, {}}};
  EXPECT_TRUE(is_folded(sheet, 2, 3));
  sheet.prescribed_creases.clear();
  EXPECT_FALSE(is_folded(sheet, 2, 3));
}

TEST(PrescribedCreasesTest, FoldedCreasesAreThoseThatAreFoldedSomewhere) {
  Sheet sheet = creased_sheet();
  sheet.prescribed_creases.push_back({{{0, 0.15}, {0.4, 0.15}}, 0, false});
  ASSERT_EQ(folded_creases(sheet).size(), 1u);
  EXPECT_EQ(folded_creases(sheet)[0].angle, -0.5);
  sheet.crease_edges = {part(0, 0.1, 0, false)};
  EXPECT_EQ(folded_creases(sheet).size(), 1u);
  sheet.crease_edges.push_back(part(0.1, 0.2, 0.3));
  const std::vector<PrescribedCrease> folded = folded_creases(sheet);
  ASSERT_EQ(folded.size(), 2u);
  EXPECT_EQ(folded[0].line, sheet.prescribed_creases[0].line) << "whole, and in their order";
  EXPECT_EQ(folded[1].angle, -0.5);
}

}  // namespace
}  // namespace paperbake
