#include "core/step2_crumple/crumple.h"

#include "core/animate.h"
#include "core/curvature.h"
#include "core/hinges.h"
#include "core/measure.h"
#include "core/random.h"
#include "core/step2_crumple/flips.h"
#include "core/step2_crumple/singular_points.h"
#include "tests/test_meshes.h"
#include "tests/test_shots.h"

#include <gtest/gtest.h>

#include <set>

namespace paperbake {
namespace {

double twice_area(const Sheet& sheet, int t) {
  const Vector2d a = sheet.pattern.row(sheet.triangles(t, 0)), b = sheet.pattern.row(sheet.triangles(t, 1)), c = sheet.pattern.row(sheet.triangles(t, 2));
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

void expect_sound(const Sheet& sheet, double area) {
  double sum = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    EXPECT_GT(twice_area(sheet, t), 0) << t;
    sum += 0.5 * twice_area(sheet, t);
  }
  EXPECT_NEAR(sum, area, 1e-12);
  const Hinges hinges = find_hinges(sheet.triangles);  // throws when an edge has three triangles
  const long edges = (3 * sheet.triangles.rows() + static_cast<long>(hinges.hinges.size())) - 2 * static_cast<long>(hinges.hinges.size());
  EXPECT_EQ(sheet.pattern.rows() - edges + sheet.triangles.rows(), 1);  // Euler: a disc
}

/// How much of the fold of the sheet lies on edges across its bending: sum |theta| l |d.e| / sum |theta| l.
double misalignment(const Sheet& sheet, const Vector2d& across) {
  double off = 0, all = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d edge = (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).transpose();
    const double weight = std::abs(fold_angle(sheet.x, hinge)) * edge.norm();
    off += weight * std::abs(edge.normalized().dot(across));
    all += weight;
  }
  return off / all;
}

TEST(Flips, EdgesTurnTowardsTheRulingsOfACylinder) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.25, 5);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {  // rulings at 40 degrees
    const double c = std::cos(0.7), s = std::sin(0.7), R = 0.04;
    const double u = c * sheet.pattern(v, 0) + s * sheet.pattern(v, 1), w = -s * sheet.pattern(v, 0) + c * sheet.pattern(v, 1);
    sheet.x.row(v) << R * std::sin(u / R), w, R * (std::cos(u / R) - 1);
  }
  const Vector2d across(std::cos(0.7), std::sin(0.7));
  const double before = misalignment(sheet, across), stretch = length_distortion(sheet).mean;
  const Points3 curvature = vertex_curvature(sheet);
  EXPECT_GT(flip_towards_rulings(sheet, curvature, 0.8), 5);
  EXPECT_LT(misalignment(sheet, across), 0.8 * before);
  EXPECT_LT(length_distortion(sheet).mean, stretch);  // chords along rulings keep their length
  expect_sound(sheet, 0.01);
  EXPECT_EQ(flip_towards_rulings(sheet, curvature, 0.8), 0);  // it has come to an end
}

TEST(Flips, AFlatSheetKeepsANearDelaunayMesh) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  EXPECT_EQ(flip_towards_rulings(sheet, vertex_curvature(sheet), 0.8), 0);
}

TEST(Conflict, ACylinderHasNoneASaddleHas) {
  Sheet cylinder = test::hex_sheet(0.1, 0.1, 10);
  test::roll(cylinder, 0.03);
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    saddle.x(v, 2) = 12 * (a * a - b * b);  // +-24 1/m, in steps of a centimetre: 12 degrees in each direction
  }
  const std::vector<char> none;
  const Conflicts smooth = find_conflicts(cylinder, vertex_curvature(cylinder), none, {});
  EXPECT_EQ(std::count(smooth.beyond.begin(), smooth.beyond.end(), 1), 0);
  const Conflicts torn = find_conflicts(saddle, vertex_curvature(saddle), none, {});
  EXPECT_GT(std::count(torn.beyond.begin(), torn.beyond.end(), 1), 20);
  const std::vector<char> all(saddle.pattern.rows(), 1);
  const Conflicts held = find_conflicts(saddle, vertex_curvature(saddle), all, {});
  EXPECT_EQ(std::count(held.beyond.begin(), held.beyond.end(), 1), 0);
}

/// A crease along a row that is a ridge on the right and a valley on the left: the two meet in the middle.
Sheet ridge_and_valley() {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  int middle = 0;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(0.05, 0.05)).rowwise().norm().minCoeff(&middle);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 40 * std::abs(sheet.pattern(v, 1) - sheet.pattern(middle, 1)) * (sheet.pattern(v, 0) - sheet.pattern(middle, 0));  // 0.4 rad on the next edges
  return sheet;
}

TEST(Conflict, ShowsWhereFoldsOfBothSignsMeet) {
  Sheet sheet = ridge_and_valley();
  const Points3 curvature = vertex_curvature(sheet);
  CrumpleOptions folds_alone;
  folds_alone.conflict_turn = folds_alone.absorbed_turn = 10;
  const auto count = [&](const CrumpleOptions& options) {
    const Conflicts c = find_conflicts(sheet, curvature, {}, options);
    return std::count(c.beyond.begin(), c.beyond.end(), 1);
  };
  EXPECT_GE(count(folds_alone), 1);
  const Conflicts c = find_conflicts(sheet, curvature, {}, folds_alone);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!c.beyond[v]) continue;
    EXPECT_LT((sheet.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm(), 0.021);  // not all along the crease
  }
  CrumpleOptions blind = folds_alone;
  blind.conflict_folds = blind.absorbed_folds = 10;
  EXPECT_EQ(count(blind), 0);
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (c.beyond[v]) sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
  CrumpleOptions greedy = folds_alone;
  greedy.absorbed_folds = 0.01;
  EXPECT_GT(count(greedy), count(folds_alone));  // beside a singular point
}

TEST(Conflict, BringsAPointWhenItHasLastedSoonerWhereItIsSharp) {
  const Sheet sheet = ridge_and_valley();
  const auto frames_to_birth = [&](const CrumpleOptions& options) {
    Crumple crumple(test::rectangle(0.1, 0.1), Paper{}, options, 1, 0);
    for (int frame = 1; frame <= 40; ++frame) {
      Sheet now = sheet;  // the conflict is the same in every frame
      if (crumple.operate(now, {}, frame, true).births > 0) return frame;
    }
    return 0;
  };
  CrumpleOptions options;
  options.conflict_turn = options.absorbed_turn = options.absorbed_folds = 10;
  options.most_triangles = 1000;
  options.lasting = 5;
  EXPECT_EQ(frames_to_birth(options), 5);
  options.absorbed_folds = 0.2;
  options.lasting_sharp = 2;
  EXPECT_EQ(frames_to_birth(options), 2);
}

TEST(Random, GaussianDrawsHaveMeanZeroDeviationOneAndNoCorrelation) {
  constexpr int n = 20000;
  Vector2d mean(0, 0);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (int k = 0; k < n; ++k) {
    const Vector2d g = gaussian(7, 0, k, 0);
    mean += g / n;
    scatter += g * g.transpose() / n;
  }
  const double error = 4 / std::sqrt(double(n));  // four standard errors
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), error);
  EXPECT_NEAR(scatter(0, 0), 1, 1.5 * error);
  EXPECT_NEAR(scatter(1, 1), 1, 1.5 * error);
  EXPECT_NEAR(scatter(0, 1), 0, error);
}

TEST(SingularPoint, LawScattersByThePapersDeviationAboutTheMiddleOfTheConflict) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Pattern pattern = test::rectangle(0.1, 0.1);
  int inner = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if ((sheet.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm() < (sheet.pattern.row(inner) - Eigen::RowVector2d(0.05, 0.05)).norm()) inner = v;
  Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2), std::vector<char>(sheet.pattern.rows(), 1)};
  Paper paper;
  Vector2d mean(0, 0);
  double variance = 0;
  constexpr int n = 4000;
  std::set<std::pair<double, double>> places;
  for (unsigned seed = 0; seed < n; ++seed) {
    const auto p = draw_singular_point(sheet, pattern, paper, conflicts, {inner}, {}, seed, 0, 0);
    ASSERT_TRUE(p);
    EXPECT_TRUE(*p == *draw_singular_point(sheet, pattern, paper, conflicts, {inner}, {}, seed, 0, 0));  // no hidden state
    places.emplace(p->x(), p->y());
    const Vector2d off = *p - sheet.pattern.row(inner).transpose();
    mean += off / n;
    variance += off.squaredNorm() / (2 * n);
  }
  EXPECT_EQ(places.size(), std::size_t(n));
  EXPECT_LT(mean.norm(), 4 * paper.apex_scatter / std::sqrt(double(n)));
  EXPECT_NEAR(std::sqrt(variance) / paper.apex_scatter, 1, 0.05);
}

/// 200 draws about one vertex: mean and deviation of each direction.
struct Draws {
  Vector2d mean{0, 0}, deviation{0, 0};  // [m]
};
constexpr int draws = 200;
Draws draw_about(const Vector2d& middle, const Paper& paper) {
  const Pattern pattern = test::rectangle(0.1, 0.1);
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  int member = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if ((sheet.pattern.row(v).transpose() - middle).norm() < (sheet.pattern.row(member).transpose() - middle).norm()) member = v;
  sheet.pattern.row(member) = middle.transpose();
  const Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2), std::vector<char>(sheet.pattern.rows(), 1)};
  Draws result;
  std::vector<Vector2d> points;
  for (unsigned seed = 0; seed < draws; ++seed) points.push_back(*draw_singular_point(sheet, pattern, paper, conflicts, {member}, {}, seed, 0, 0));
  for (const Vector2d& p : points) result.mean += p / draws;
  for (const Vector2d& p : points) result.deviation += (p - result.mean).cwiseAbs2() / (draws - 1);
  result.deviation = result.deviation.cwiseSqrt();
  return result;
}

// of 200 normal draws the deviation is known to 1/sqrt(2 x 199) = 5 %, the mean to 1/sqrt(200) deviations; 3.3 of these: 99.9 %
TEST(SingularPoint, TwoHundredDrawsHaveTheDeviationOfTheGrade) {
  for (const double sigma : {0.002, 0.005, 0.010}) {
    Paper paper;
    paper.apex_scatter = sigma;
    const Draws inside = draw_about({0.05, 0.05}, paper);
    for (int i : {0, 1}) {
      EXPECT_NEAR(inside.deviation[i] / sigma, 1, 3.3 / std::sqrt(2.0 * (draws - 1))) << sigma;
      EXPECT_NEAR(inside.mean[i], 0.05, 3.3 * sigma / std::sqrt(double(draws))) << sigma;
    }
  }
}

// refused draws are drawn anew: a normal law cut off at a = (3 mm - middle)/sigma has the mean sigma m, m = phi(a)/(1 - Phi(a)),
// and the variance sigma^2 (1 + a m - m^2)
TEST(SingularPoint, NearTheBorderTheLawIsTheGaussianCutOffAtTheMargin) {
  const Paper paper;
  const double sigma = paper.apex_scatter, margin = CrumpleOptions{}.border_share * 0.1;
  for (const double v : {0.005, 0.008, 0.012}) {
    const Draws near = draw_about({0.05, v}, paper);
    const double a = (margin - v) / sigma;
    const double m = std::exp(-0.5 * a * a) / std::sqrt(2 * M_PI) / (0.5 * std::erfc(a / std::sqrt(2.0)));
    const double mean = v + sigma * m, deviation = sigma * std::sqrt(1 + a * m - m * m);
    ASSERT_LT(deviation, 0.97 * sigma) << "the border is not felt: this proves nothing";
    EXPECT_NEAR(near.mean.y(), mean, 3.3 * deviation / std::sqrt(double(draws))) << v;
    EXPECT_NEAR(near.deviation.y() / deviation, 1, 0.2) << v;  // a cut normal has lighter tails than 3.3 x 5 % = 17 % allows for
    EXPECT_NEAR(near.mean.x(), 0.05, 3.3 * sigma / std::sqrt(double(draws))) << v;
    EXPECT_NEAR(near.deviation.x() / sigma, 1, 3.3 / std::sqrt(2.0 * (draws - 1))) << v;
  }
}

TEST(SingularPoint, TheMiddleOfAConflictIsWhereTheSheetBulgesNotTheWorstVertex) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Vector2d core(0.043, 0.052);
  for (int v = 0; v < sheet.x.rows(); ++v)  // a dome of 12 mm: positive curvature in it, negative round it
    sheet.x(v, 2) = 0.004 * std::exp(-(sheet.pattern.row(v).transpose() - core).squaredNorm() / (2 * 0.012 * 0.012));
  const Conflicts conflicts = find_conflicts(sheet, vertex_curvature(sheet), {}, {});
  std::vector<int> members;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (conflicts.beyond[v]) members.push_back(v);
  ASSERT_FALSE(members.empty());
  const int worst = *std::max_element(members.begin(), members.end(), [&](int a, int b) { return conflicts.turn[a] < conflicts.turn[b]; });
  EXPECT_GT((sheet.pattern.row(worst).transpose() - core).norm(), 0.002);  // cells of 10 mm
  EXPECT_LT((middle_of_conflict(sheet, conflicts, members) - core).norm(), 0.0015);

  Conflicts saddle = conflicts;  // where nothing bulges the turning angles decide
  std::fill(saddle.core.begin(), saddle.core.end(), 0.0);
  EXPECT_LT((middle_of_conflict(sheet, saddle, {worst}) - sheet.pattern.row(worst).transpose()).norm(), 1e-12);
}

TEST(SingularPoint, KeepsItsDistanceFromBorderAndOtherPoints) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Pattern pattern = test::rectangle(0.1, 0.1);
  const CrumpleOptions options;
  Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2), std::vector<char>(sheet.pattern.rows(), 1)};
  std::vector<int> members;  // along the front border
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (sheet.pattern(v, 1) < 0.012 && sheet.pattern(v, 1) > 1e-9) members.push_back(v);
  ASSERT_GT(members.size(), 3u);
  sheet.singular.push_back({Vector2d(0.05, 0.0085), 1, "test"});
  for (unsigned seed = 0; seed < 500; ++seed) {
    const auto p = draw_singular_point(sheet, pattern, Paper{}, conflicts, members, options, seed, 0, 1);
    if (!p) continue;
    EXPECT_GE((*p - sheet.singular[0].pattern).norm(), options.min_spacing);
    EXPECT_GE((nearest_border_point(pattern, *p) - *p).norm(), options.border_share * 0.1 - 1e-12);
  }
}

TEST(SingularPoint, BecomesAVertexWhereverItFallsAndTheMeshStaysSound) {
  int exact = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.1, seed);
    test::roll(sheet, 0.05);
    std::vector<char> fixed(sheet.pattern.rows(), seed % 2);  // every other time no vertex may move: only splits
    for (int k = 0; k < 5; ++k) {
      const Vector2d p(0.05 + 0.04 * uniform(seed, 2 * k), 0.05 + 0.04 * uniform(seed, 2 * k + 1));
      const int v = insert_vertex(sheet, p, fixed);
      const double beside = (sheet.pattern.row(v).transpose() - p).norm();
      EXPECT_LT(beside, 0.2 * 0.0167);  // of a height: further in where a fold would be cut short
      exact += beside < 1e-15;
      sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
      EXPECT_NEAR(sheet.x(v, 1), sheet.pattern(v, 1), 2e-3);  // on the cylinder's chord
      EXPECT_EQ(sheet.v.rows(), sheet.pattern.rows());
      fixed.resize(sheet.pattern.rows(), 0);
    }
    expect_sound(sheet, 0.01);
  }
  EXPECT_GT(exact, 0.7 * 60 * 5);
}

TEST(SingularPoint, AFoldedRingIsNotCutShortAndAFlipNotTakenThroughAnotherLayer) {
  // two triangles folded by 90 degrees: a point just beyond the fold stays in its own triangle
  Sheet bent = test::flat_sheet((Points2(4, 2) << 0, 0, 0.1, 0, 0.05, 0.08, 0.05, -0.08).finished(), (Triangles(2, 3) << 0, 1, 2, 1, 0, 3).finished());
  bent.x.row(3) << 0.05, 0, -0.08;
  insert_vertex(bent, {0.05, 0.004}, {});
  EXPECT_LT(length_distortion(bent).largest, 1e-12);
  EXPECT_EQ(bent.triangles.rows(), 4);

  // a saddle of two triangles over a longer diagonal, and a blade that stands between the two diagonals
  Sheet pair = test::flat_sheet((Points2(4, 2) << 0, 0, 0.1, 0, 0.05, 0.03, 0.05, -0.03).finished(), (Triangles(2, 3) << 0, 1, 2, 1, 0, 3).finished());
  pair.x.row(2)[2] = pair.x.row(3)[2] = 0.004;
  Sheet bladed = pair;
  bladed.pattern.conservativeResize(7, 2);
  bladed.pattern.bottomRows<3>() << 1, 0, 1.1, 0, 1, 0.1;
  bladed.x.conservativeResize(7, 3);
  bladed.x.bottomRows<3>() << 0.03, 0, 0.002, 0.07, 0, 0.002, 0.05, 0, 0.0025;
  bladed.triangles.conservativeResize(3, 3);
  bladed.triangles.row(2) << 4, 5, 6;
  EXPECT_EQ(flip_towards_rulings(pair, Points3::Zero(4, 3), 0.8), 1);
  EXPECT_EQ(flip_towards_rulings(bladed, Points3::Zero(7, 3), 0.8), 0);
}

struct Played {
  std::vector<Sheet> sheets;
  std::vector<AnimatedFrame> frames;
};
Played play(const Shot& shot, const Method& method, int last_frame) {
  AnimateOptions options;
  options.last_frame = last_frame;
  Played played;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    played.sheets.push_back(*frame.sheet);
    played.frames.push_back(frame);
    return true;
  });
  return played;
}

Method hybrid_of(const Shot& shot, unsigned seed = 0) { return hybrid(shot.pattern, shot.paper, 120, {}, seed, 0); }

TEST(Hybrid, ArchOfAHundredTrianglesIsNearlyTheElastica) {
  const Shot shot = test::s1_push();
  const Played played = play(shot, hybrid_of(shot), 24);
  const Sheet& sheet = played.sheets.back();
  EXPECT_LT(sheet.triangles.rows(), 150);
  EXPECT_NEAR(sheet.x.col(2).maxCoeff() / 0.019492, 1, 0.015);
  EXPECT_LT(length_distortion(sheet).mean, 1e-4);
  EXPECT_TRUE(sheet.singular.empty());
}

TEST(Hybrid, NothingChangesWhileNothingMoves) {
  Shot shot = test::s1_push();
  for (Handle& handle : shot.handles)  // at rest from frame 12 on
    for (int f = 12; f < handle.keyed.rows(); ++f) handle.keyed.row(f) = handle.keyed.row(11);
  shot.handles.back().grab_frame = 1000;
  const Played played = play(shot, hybrid_of(shot), 30);
  for (std::size_t f = 18; f < played.sheets.size(); ++f) {
    EXPECT_TRUE(played.sheets[f].triangles == played.sheets[17].triangles) << f;
    EXPECT_LT((played.sheets[f].x - played.sheets[17].x).rowwise().norm().maxCoeff(), 2e-5) << f;  // twice the stop
    EXPECT_EQ(played.frames[f].newton_iterations, 0) << f;  // and it costs nothing
  }
}

TEST(Hybrid, PaperWoundTooTightKeepsACurlAndPaperThatIsNotKeepsNone) {
  // a 60 x 20 mm strip led round a cylinder by handles along both borders, let go at frame 25; yield at 100 1/m, hardening 0.3
  const auto curl = [](double curvature) {
    constexpr int frames = 40, rows = 31;
    Shot shot = test::blank_shot(test::rectangle(0.06, 0.02));
    for (int i = 0; i < rows; ++i)
      for (double y : {0.0, 0.02}) {
        const double u = 0.06 * i / (rows - 1) - 0.03;
        Handle handle = test::bare_handle("h", {u + 0.03, y}, frames);
        for (int f = 0; f < frames; ++f) {
          const double k = std::max(1e-6, curvature * std::min(f, 24) / 24);
          handle.keyed.row(f) << std::sin(k * u) / k, y, (std::cos(k * u) - 1) / k;
        }
        if (i != rows / 2) handle.release_frame = 26;
        shot.handles.push_back(handle);
      }
    AnimateOptions options;
    options.last_frame = frames;
    options.memory = Memory::plastic;
    options.elastic.contact = SelfContact::off;  // it is wound twice round the same cylinder
    double plastic = 0, residual = 0;
    animate(shot, hybrid(shot.pattern, shot.paper, 240, {}, 0, 0), options, [&](const AnimatedFrame& frame) {
      EXPECT_GE(frame.plastic, plastic - 1e-9);  // paper does not heal
      plastic = frame.plastic;
      // mean curvature from the chord between the ends: c = 2/k sin(k L/2)
      const double chord = (frame.handles.front().at - frame.handles[2 * (rows - 1)].at).norm();
      for (residual = 1e-6; residual < 300 && 2 / residual * std::sin(residual * 0.03) > chord;) residual += 0.1;
      return true;
    });
    return std::make_pair(residual, plastic);
  };
  const auto tight = curl(200), loose = curl(70);
  EXPECT_NEAR(tight.first, 0.7 * 100, 0.05 * 70);  // (1 - eta)(k - k_y)
  EXPECT_LT(loose.first, 1);
  EXPECT_LT(loose.second, 0.02 * tight.second);
}

/// Eight handles drawn to the middle: the sheet must break.
Shot crush() {
  constexpr int frames = 40;
  Shot shot = test::blank_shot(test::rectangle(0.21, 0.21));
  for (double x : {0.0, 0.105, 0.21})
    for (double y : {0.0, 0.105, 0.21}) {
      if (x == 0.105 && y == 0.105) continue;
      Handle handle = test::bare_handle("h", {x, y}, frames);
      handle.radius.reset();
      const bool corner = x != 0.105 && y != 0.105;
      for (int f = 0; f < frames; ++f) {
        const double way = 0.5 * f / frames;
        handle.keyed.row(f) << x + way * (0.105 - x), y + way * (0.105 - y), way * (corner ? 0.06 : -0.04);
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

TEST(Hybrid, ACrushedSheetGetsSingularPointsThatStayAndAreItsOwnBySeed) {
  const Shot shot = crush();
  const Played a = play(shot, hybrid_of(shot, 1), 40), again = play(shot, hybrid_of(shot, 1), 40), b = play(shot, hybrid_of(shot, 2), 40);
  const auto& points = a.sheets.back().singular;
  ASSERT_GE(points.size(), 3u);
  for (std::size_t f = 1; f < a.sheets.size(); ++f) {
    ASSERT_GE(a.sheets[f].singular.size(), a.sheets[f - 1].singular.size());
    for (std::size_t k = 0; k < a.sheets[f - 1].singular.size(); ++k) EXPECT_TRUE(a.sheets[f].singular[k].pattern == a.sheets[f - 1].singular[k].pattern);
    expect_sound(a.sheets[f], 0.21 * 0.21);
    EXPECT_EQ(a.frames[f].new_singular, int(a.sheets[f].singular.size() - a.sheets[f - 1].singular.size()));
  }
  EXPECT_TRUE(a.sheets.back().x == again.sheets.back().x);
  EXPECT_FALSE(points[0].pattern == b.sheets.back().singular.at(0).pattern);
  EXPECT_EQ(crossings(a.sheets.back()), 0);
  for (const HandleFrame& handle : a.frames.back().handles) {
    const double lag = (handle.at - handle.keyed).norm();
    EXPECT_EQ(handle.state, lag > 1e-4 ? HandleFrame::jammed : HandleFrame::held);
    EXPECT_LT(lag, 0.02);
  }
}

TEST(Hybrid, OptionsBoundHowManyPointsAreBorn) {
  const Shot shot = crush();
  const auto born = [&](const CrumpleOptions& options) {
    return play(shot, hybrid(shot.pattern, shot.paper, 120, options, 1, 0), 30).sheets.back().singular.size();
  };
  CrumpleOptions one, full;
  one.most_points = 1;
  full.most_triangles = 60;  // fewer than the first mesh has
  EXPECT_EQ(born(one), 1u);
  EXPECT_EQ(born(full), 0u);
}

TEST(Conflict, BesideASingularPointMoreIsAbsorbed) {
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    saddle.x(v, 2) = 12 * (a * a - b * b);
  }
  int inner = 0;
  for (int v = 0; v < saddle.pattern.rows(); ++v)
    if ((saddle.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm() < (saddle.pattern.row(inner) - Eigen::RowVector2d(0.05, 0.05)).norm()) inner = v;
  saddle.singular.push_back({saddle.pattern.row(inner).transpose(), 1, "test"});
  const auto beyond = [&](double absorbed_turn) {
    CrumpleOptions options;
    options.absorbed_turn = absorbed_turn;
    const Conflicts c = find_conflicts(saddle, vertex_curvature(saddle), {}, options);
    return std::count(c.beyond.begin(), c.beyond.end(), 1);
  };
  EXPECT_EQ(beyond(0.14) - beyond(1.0), 6);  // the neighbours of the point in a lattice of six
}

}  // namespace
}  // namespace paperbake
