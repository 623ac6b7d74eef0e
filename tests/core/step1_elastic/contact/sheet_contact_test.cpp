#include "core/step1_elastic/contact/sheet_contact.h"

#include "core/geometry/intersections.h"
#include "core/geometry/proximity.h"
#include "tests/core/test_meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace paperbake {
namespace {

constexpr double frame = 1.0 / 24;  // [s]

/// A second sheet beside the first on the pattern, so far away that no features of the two are
/// neighbours; its `x` stays as it is.
Sheet join(const Sheet& a, const Sheet& b) {
  const int n = static_cast<int>(a.pattern.rows());
  Sheet both;
  both.pattern.resize(n + b.pattern.rows(), 2);
  both.pattern << a.pattern, b.pattern.rowwise() + Eigen::RowVector2d(1, 0);
  both.x.resize(both.pattern.rows(), 3);
  both.x << a.x, b.x;
  both.v = Points3::Zero(both.x.rows(), 3);
  both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  both.triangles << a.triangles, (b.triangles.array() + n).matrix();
  return both;
}

/// Two crumpled layers, one over the other and closer than dhat: hundreds of pairs of all kinds.
Sheet two_layers(double gap) {
  Sheet low = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), high = test::hex_sheet(0.1, 0.1, 5, 0.2, 2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.2 * gap, 0.2 * gap);
  for (Sheet* s : {&low, &high})
    for (int v = 0; v < s->x.rows(); ++v) s->x(v, 2) += noise(random) + (s == &high ? gap : 0);
  return join(low, high);
}

/// [m] dhat of two_layers(), however far apart they are
double dhat_of_layers() {
  const Sheet layers = two_layers(1);
  return SheetContact(layers.pattern, layers.triangles).dhat();
}

Points3 still(const Sheet& sheet) { return Points3::Zero(sheet.x.rows(), 3); }

/// Energy with a new list of pairs.
double energy_at(SheetContact& contact, const Points3& x) {
  contact.begin(x, {});
  return contact.energy(x);
}

TEST(SelfContactTest, GradientMatchesTheEnergyWithManyActivePairs) {
  const Sheet sheet = two_layers(0.4 * dhat_of_layers());
  SheetContact contact(sheet.pattern, sheet.triangles);
  contact.begin(sheet.x, {});
  ASSERT_GT(contact.touching(sheet.x), 200);
  Points3 gradient = still(sheet);
  contact.differentiate(sheet.x, gradient, nullptr);
  ASSERT_GT(gradient.norm(), 1e-2);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 10; ++k) {
    Points3 way = still(sheet);
    for (int i = 0; i < way.size(); ++i) way.data()[i] = normal(random);
    const double step = 1e-9;
    const double slope =
        (energy_at(contact, sheet.x + step * way) - energy_at(contact, sheet.x - step * way)) /
        (2 * step);
    EXPECT_NEAR(slope, gradient.cwiseProduct(way).sum(), 1e-5 * gradient.norm());
  }
}

TEST(SelfContactTest, HessianIsExactWhereNormalsDoNotTurnAndIsNeverIndefinite) {
  // vertices over the inside of one large triangle, moving up and down: the normal does not turn
  Sheet low = test::flat_sheet((Points2(3, 2) << 0, 0, 1, 0, 0, 1).finished(),
                               (Triangles(1, 3) << 0, 1, 2).finished());
  Sheet high = test::hex_sheet(0.1, 0.1, 4, 0.2, 2);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Sheet apart = join(low, high);
  const double dhat = SheetContact(apart.pattern, apart.triangles).dhat();
  high.x.rowwise() += Eigen::RowVector3d(0.2, 0.2, 0.5 * dhat);
  for (int v = 0; v < high.x.rows(); ++v) high.x(v, 2) += 0.05 * dhat * normal(random);
  const Sheet sheet = join(low, high);
  const int n = static_cast<int>(sheet.x.rows());
  std::vector<int> block(n);
  std::vector<std::pair<int, int>> all;
  for (int i = 0; i < n; ++i)
    for (int j = block[i] = i; j-- > 0;) all.emplace_back(i, j);
  BlockCholesky matrix(n, all);
  SheetContact contact(sheet.pattern, sheet.triangles);
  contact.begin(sheet.x, {});
  contact.bind(matrix, block);
  ASSERT_GT(contact.touching(sheet.x), 15);
  Points3 gradient = still(sheet), before = still(sheet), after = still(sheet), way = still(sheet);
  contact.differentiate(sheet.x, gradient, &matrix);
  const Eigen::MatrixXd second = matrix.dense();
  for (int v = 0; v < n; ++v) way(v, 2) = normal(random);
  const double step = 1e-8;
  contact.differentiate(sheet.x - step * way, before, nullptr);
  contact.differentiate(sheet.x + step * way, after, nullptr);
  const Points3 change = (after - before) / (2 * step);
  const Eigen::VectorXd told = second * Eigen::Map<const Eigen::VectorXd>(way.data(), way.size());
  ASSERT_GT(told.norm(), 1);
  double error = 0;  // of the forces along z: those across turn with the normal
  for (int v = 0; v < n; ++v) error = std::max(error, std::abs(change(v, 2) - told[3 * v + 2]));
  EXPECT_LT(error, 1e-5 * told.norm());

  const Sheet layers = two_layers(0.4 * dhat_of_layers());
  const int m = static_cast<int>(layers.x.rows());
  all.clear();
  block.resize(m);
  for (int i = 0; i < m; ++i)
    for (int j = block[i] = i; j-- > 0;) all.emplace_back(i, j);
  BlockCholesky larger(m, all);
  SheetContact many(layers.pattern, layers.triangles);
  many.begin(layers.x, {});
  many.bind(larger, block);
  Points3 unused = still(layers);
  many.differentiate(layers.x, unused, &larger);
  const Eigen::VectorXd eigenvalues = larger.dense().selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(eigenvalues.maxCoeff(), 1);
  EXPECT_GT(eigenvalues.minCoeff(), -1e-9 * eigenvalues.maxCoeff());
}

TEST(SelfContactTest, EveryPairCloserThanDhatDuringTheStepIsInTheList) {
  const double dhat = dhat_of_layers();
  const Sheet sheet = two_layers(3 * dhat);
  Points3 move = still(sheet);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int v = 0; v < move.rows(); ++v)
    move.row(v) << 1.5 * dhat * normal(random), 1.5 * dhat * normal(random),
        1.5 * dhat * normal(random);
  SheetContact contact(sheet.pattern, sheet.triangles);
  contact.begin(sheet.x, {});
  contact.update_candidates(sheet.x, move);
  std::set<std::pair<std::set<int>, Features>> listed;
  for (const ContactPair& p : contact.pairs())
    listed.insert({{p.vertices.begin(), p.vertices.end()}, p.features});
  int within = 0;
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {
    const Points3 x = sheet.x + share * move;
    const auto to_triangle = [](const std::array<Vector3d, 4>& corners) {
      return vertex_to_triangle(corners).distance();
    };
    for (int v = 0; v < x.rows(); ++v)
      for (int t = 0; t < sheet.triangles.rows(); ++t) {
        const Eigen::RowVector3i c = sheet.triangles.row(t);
        if ((c.array() == v).any()) continue;
        const auto at = [&](const auto& points, int k) {
          return Vector3d(points(k, 0), points(k, 1),
                          points.cols() > 2 ? points(k, points.cols() - 1) : 0.0);
        };
        const double d = to_triangle({at(x, v), at(x, c[0]), at(x, c[1]), at(x, c[2])});
        const auto flat = [&](int k) {
          return Vector3d(sheet.pattern(k, 0), sheet.pattern(k, 1), 0);
        };
        if (d >= std::min(contact.dhat(),
                          0.3 * to_triangle({flat(v), flat(c[0]), flat(c[1]), flat(c[2])})))
          continue;
        ++within;
        EXPECT_TRUE(listed.count({{v, c[0], c[1], c[2]}, Features::vertex_and_triangle}))
            << v << " " << t;
      }
  }
  EXPECT_GT(within, 20);
}

TEST(SelfContactTest, AFlatOrGentlyRolledSheetIsCollisionFreeAndHasNoActivePair) {
  Sheet sheet = test::hex_sheet(0.2, 0.2, 10, 0.2);
  const Points3 flat = sheet.x;
  test::roll(sheet, 0.2);  // 1 rad: with more, the straight motion would fold it
  SheetContact contact(sheet.pattern, sheet.triangles);
  EXPECT_TRUE(contact.is_collision_free(flat, flat, {}));
  EXPECT_TRUE(contact.is_collision_free(flat, sheet.x, {}));
  contact.begin(sheet.x, {});
  EXPECT_EQ(contact.touching(sheet.x), 0);
}

TEST(SelfContactTest, ALayerThatJumpsThroughAnotherOrEndsCloseToItIsNotCollisionFree) {
  const Sheet sheet = two_layers(0.02);
  SheetContact contact(sheet.pattern, sheet.triangles);
  const auto lowered = [&](double by) {
    Points3 x = sheet.x;
    for (int v = 0; v < x.rows(); ++v)
      if (sheet.pattern(v, 0) > 0.5) x(v, 2) -= by;
    return x;
  };
  EXPECT_TRUE(contact.is_collision_free(sheet.x, lowered(0.005), {}));
  EXPECT_FALSE(contact.is_collision_free(sheet.x, lowered(0.0195), {}));
  EXPECT_FALSE(contact.is_collision_free(sheet.x, lowered(0.04), {}));
}

TEST(SelfContactTest, PairsThatHandlesBringTogetherAreExcluded) {
  Sheet sheet = test::strip_sheet(0.3, 0.03, 20);
  // a ring whose ends meet and are held there
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double a = 2 * M_PI * sheet.pattern(v, 0) / 0.3;
    sheet.x.row(v) << 0.3 / (2 * M_PI) * std::sin(a), sheet.pattern(v, 1),
        0.3 / (2 * M_PI) * (1 - std::cos(a));
  }
  sheet.x.bottomRows<2>().rowwise() += Eigen::RowVector3d(0, 0, 1e-4);
  const PositionConstraints ends{
      {0, sheet.x.row(0)}, {1, sheet.x.row(1)}, {40, sheet.x.row(0)}, {41, sheet.x.row(1)}};
  SheetContact contact(sheet.pattern, sheet.triangles);
  contact.begin(sheet.x, {});
  EXPECT_GT(contact.touching(sheet.x), 0);
  contact.begin(sheet.x, ends);
  EXPECT_EQ(contact.touching(sheet.x), 0);
}

/// Whether an edge of triangle s passes through triangle t.
bool passes_through(const Sheet& sheet, int s, int t) {
  const auto corner = [&](int of, int i) -> Vector3d {
    return sheet.x.row(sheet.triangles(of, i % 3));
  };
  for (int i = 0; i < 3; ++i)
    if (pierces(corner(s, i), corner(s, i + 1), {corner(t, 0), corner(t, 1), corner(t, 2)}))
      return true;
  return false;
}

/// Whether the two features of a pair belong to triangles of the two layers that pass through each
/// other.
bool belongs_to_crossing_triangles(const Sheet& sheet, const ContactPair& pair) {
  const auto around = [&](int first, int last) {
    std::vector<int> triangles;
    for (int t = 0; t < sheet.triangles.rows(); ++t)
      if (std::all_of(pair.vertices.begin() + first, pair.vertices.begin() + last,
                      [&](int v) { return (sheet.triangles.row(t).array() == v).any(); }))
        triangles.push_back(t);
    return triangles;
  };
  const int cut = second_of(pair.features);
  for (const int s : around(0, cut))
    for (const int t : around(cut, 4))
      if (passes_through(sheet, s, t) || passes_through(sheet, t, s)) return true;
  return false;
}

TEST(SelfContactTest, PairsThatBeginTouchingOrCrossingAreLeftOutUntilTheyHaveSeparated) {
  for (const double slope : {0.0, 0.01}) {
    Sheet sheet = two_layers(1e-3);
    // in one plane, or through each other
    const auto set_upper = [&](double slope, double height) {
      for (int v = 0; v < sheet.x.rows(); ++v) {
        const bool upper = sheet.pattern(v, 0) > 0.5;
        sheet.x(v, 2) = upper ? height + slope * (sheet.pattern(v, 0) - 1.05) : 0;
      }
    };
    set_upper(slope, 0);
    EXPECT_EQ(crossings(sheet) > 0, slope > 0);
    SheetContact contact(sheet.pattern, sheet.triangles);
    contact.begin(sheet.x, {});
    ASSERT_FALSE(contact.pairs().empty());
    for (const ContactPair& pair : contact.pairs())
      EXPECT_FALSE(belongs_to_crossing_triangles(sheet, pair));
    Points3 gradient = still(sheet);
    EXPECT_TRUE(std::isfinite(contact.differentiate(sheet.x, gradient, nullptr)));
    EXPECT_TRUE(gradient.allFinite());

    set_upper(0, 0.4 * contact.dhat());
    contact.begin(sheet.x, {});
    EXPECT_GT(contact.touching(sheet.x), 100) << slope;
  }
}

}  // namespace
}  // namespace paperbake
