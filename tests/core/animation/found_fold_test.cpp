#include "core/animation/animate.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/step2_crumple/find_fold_lines.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// A page of 150 x 210 mm. Two rows of three fingers across it, 40 mm apart, come to 2 mm from each
/// other: the paper between them is pinched to a ridge, and no clamp says where.
Shot pinched_page() {
  constexpr int frames = 60, closed = 48;
  Shot shot = test::blank_shot(test::rectangle(0.15, 0.21));
  for (const double side : {-1.0, 1.0})
    for (const double x : {0.0, 0.075, 0.15}) {
      Handle finger = test::bare_handle("handle." + std::to_string(shot.handles.size()),
                                        {x, 0.105 + 0.02 * side}, frames);
      finger.radius = 0.005;
      for (int f = 0; f < frames; ++f) {
        const double t = std::min(1.0, f / (closed - 1.0));
        finger.keyed(f, 1) -= side * 0.019 * t * t * (3 - 2 * t);
      }
      shot.handles.push_back(finger);
    }
  return shot;
}

struct Baked {
  Sheet last;
  int frame_of_birth = 0, crossed = 0;
  double worst_handle = 0, worst_edge = 0;  // [m]; [1]
};

Baked bake(const Shot& shot, int triangles, unsigned seed, double gravity = 0,
           Inertia inertia = Inertia::quasi_static) {
  AnimateOptions options;
  options.last_frame = static_cast<int>(shot.handles.front().keyed.rows());
  options.plasticity = Plasticity::on;
  options.seed = seed;
  options.elastic.forces.gravity = gravity;
  options.elastic.inertia = inertia;
  Baked baked;
  animate(shot, hybrid(shot.pattern, shot.paper, triangles, {}, seed, 0), options,
          [&](const AnimatedFrame& frame) {
            baked.last = *frame.sheet;
            if (baked.frame_of_birth == 0 && !folded_creases(*frame.sheet).empty())
              baked.frame_of_birth = frame.frame;
            baked.crossed += crossings(*frame.sheet) > 0;
            baked.worst_edge = std::max(baked.worst_edge, length_distortion(*frame.sheet).largest);
            for (const HandleFrame& handle : frame.handles)
              baked.worst_handle = std::max(baked.worst_handle, (handle.at - handle.keyed).norm());
            return true;
          });
  return baked;
}

/// [rad] Mean turn of the sheet on its last crease.
double turn_on_crease(const Sheet& sheet) {
  double sum = 0, length = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]);
    if (!crease_under({sheet.prescribed_creases.back()}, a, b)) continue;
    sum += std::abs(dihedral_angle(sheet.x, hinge)) * (b - a).norm();
    length += (b - a).norm();
  }
  return sum / length;
}

TEST(FoundFoldTest, APinchedPageFoldsOnALineBetweenTheFingers) {
  for (const unsigned seed : {0u, 1u}) {
    const Baked baked = bake(pinched_page(), 120, seed);
    ASSERT_EQ(baked.last.prescribed_creases.size(), 1u);
    const std::vector<Vector2d>& line = baked.last.prescribed_creases.front().line;
    // the rows of fingers come to 2 mm from each other, so the page folds half way between them
    EXPECT_NEAR(line.front().y(), 0.105, 0.0005);
    EXPECT_NEAR(line.back().y(), 0.105, 0.0005);
    EXPECT_NEAR(std::abs(line.front().x() - line.back().x()), 0.15, 1e-4);
    EXPECT_GT(turn_on_crease(baked.last), 2.5);
    EXPECT_LT(baked.worst_handle, 1e-3);  // with the place of least energy 5 mm, unfolded 7 mm
    EXPECT_LT(baked.worst_edge, 0.01);
    EXPECT_EQ(baked.crossed, 0);
    EXPECT_LT(baked.last.singular.size(), 6u);  // without the line 14
  }
}

/// A page of `size` times 210 x 297 mm, whose two far corners are carried over the near ones. A box
/// presses it to 2.5 mm above a table.
/// speed  1 is a shot of 76 frames
/// held   [1] of its width, where handles hold both edges
Shot pressed_page(double size, double speed = 1, std::vector<double> held = {0, 1}) {
  const int frames = static_cast<int>(std::lround(76 / speed));
  const double width = 0.21 * size, height = 0.297 * size, above = 0.17 * size;
  const auto eased = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  Shot shot = test::blank_shot(test::rectangle(width, height));
  for (const double y : {0.0, height})
    for (const double share : held) {
      Handle corner = test::bare_handle("corner." + std::to_string(shot.handles.size()),
                                        {share * width, y}, frames);
      corner.radius = 0.004;
      for (int f = 0; f < frames && y > 0; ++f) {
        const double t = eased(f * speed / 43), around = M_PI * t;
        corner.keyed(f, 1) -= (height - 0.008) / 2 * (1 - std::cos(around));
        corner.keyed(f, 2) += 0.11 * size * std::sin(around) + 0.002 * t;
      }
      shot.handles.push_back(corner);
    }
  const auto box = [](const char* name, const Vector3d& low, const Vector3d& high) {
    ColliderMesh mesh{name, Points3(8, 3), Triangles(12, 3), {}};
    for (int v = 0; v < 8; ++v)
      mesh.x.row(v) << (v & 1 ? high : low).x(), (v & 2 ? high : low).y(), (v & 4 ? high : low).z();
    mesh.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4,
        6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
    return mesh;
  };
  const ColliderMesh table =
      box("table", {-0.03, -0.03, -0.011}, {width + 0.03, height + 0.03, -0.001});
  ColliderMesh press =
      box("press", {-0.01, 0.06 * size, above}, {width + 0.01, 0.17 * size, above + 0.015});
  for (int f = 0; f < frames; ++f) {
    press.frames.own().push_back(press.x);
    press.frames.own().back().col(2).array() -= (above - 0.0025) * eased((f * speed - 39) / 32);
  }
  shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(table), Collider(press)});
  return shot;
}

/// How a pressed page ends: folded along one line, half way between its near edge and where the
/// far one comes to lie, round the fold. handles: [m] how far they are behind, at most
void expect_folded_in_half(const Baked& baked, double height, double handles = 1e-3) {
  ASSERT_EQ(baked.last.prescribed_creases.size(), 1u);
  const std::vector<Vector2d>& line = baked.last.prescribed_creases.front().line;
  EXPECT_NEAR(line.front().y(), (height + 0.008) / 2, 0.002);
  EXPECT_NEAR(line.back().y(), (height + 0.008) / 2, 0.002);
  EXPECT_GT(turn_on_crease(baked.last), 2.5);
  EXPECT_LT(baked.worst_handle, handles);
  EXPECT_LT(baked.worst_edge, 0.01);
  EXPECT_EQ(baked.crossed, 0);
  EXPECT_EQ(baked.last.singular.size(), 0u);
}

TEST(FoundFoldTest, APageThatABoxPressesFoldsEvenIfNoTriangleIsSmallEnoughToYield) {
  // in rows of 70 mm; with places by the energy of the pressed sheet alone 3 mm off
  expect_folded_in_half(bake(pressed_page(2), 120, 0, 9.81), 0.594);
}

TEST(FoundFoldTest, APageWithInertiaIsTakenBackToWhereItWasLooser) {
  // Folded where it is, the page would be jammed, and no line would be taken. Handles are 1.2 mm
  // behind; the aim is 1 mm.
  const Baked baked = bake(pressed_page(2, 2, {0, 0.5, 1}), 120, 0, 9.81, Inertia::dynamic);
  expect_folded_in_half(baked, 0.594, 1.5e-3);
}

TEST(FoundFoldTest, ALetterIsFoldedInHalfOnAnyMesh) {
  for (const int triangles : {90, 160})
    for (const unsigned seed : {0u, 1u}) {
      SCOPED_TRACE(std::to_string(triangles) + " triangles, seed " + std::to_string(seed));
      expect_folded_in_half(bake(pressed_page(1), triangles, seed, 9.81), 0.297);
    }
}

TEST(FoundFoldTest, AnArchThatIsPushedInFoldsNowhere) {
  EXPECT_TRUE(bake(test::s1_push(), 120, 0).last.prescribed_creases.empty());
}

/// Says in every frame in which paper yields that the sheet is being folded, but has no mesh for
/// it. Counts how often it says so, and how often it is asked for a mesh.
class Unwilling : public Method {
 public:
  struct Counts {
    int said = 0, asked = 0;
  };
  explicit Unwilling(Counts& counts) : counts_(counts), mesh_(fem(120).make()) {}
  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    return mesh_->first_mesh(pattern, points);
  }
  bool finds_folds(const Sheet&) const override { return true; }
  std::vector<FoldLine> fold_lines(const Sheet&, const PlasticMemory&) const override {
    ++counts_.said;
    return {{{0, 0.105}, {0.15, 0.105}, 0, {}}};
  }
  std::optional<PatternMesh> mesh_with_creases(const Pattern&, const std::vector<Vector2d>&,
                                               int) const override {
    ++counts_.asked;
    return std::nullopt;
  }

 private:
  Counts& counts_;
  std::unique_ptr<Method> mesh_;
};

TEST(FoundFoldTest, AFoldThatIsRefusedIsTriedAgainOnlyWhenTheEnergyHasChanged) {
  Unwilling::Counts counts;
  AnimateOptions options;
  options.last_frame = 60;
  options.plasticity = Plasticity::on;
  animate(pinched_page(), {"unwilling", [&] { return std::make_unique<Unwilling>(counts); }},
          options, [](const AnimatedFrame&) { return true; });
  EXPECT_GT(counts.asked, 1);
  EXPECT_GT(counts.said, counts.asked + 5);
}

/// Hybrid, which says on some meshes that the sheet is being folded.
enum class FoldedOn { all_meshes, first_mesh, coarse_meshes };
class Mistaken : public Method {
 public:
  Mistaken(const Shot& shot, FoldedOn on)
      : on_(on), hybrid_(hybrid(shot.pattern, shot.paper, 120, {}, 0, 0).make()) {}
  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    PatternMesh mesh = hybrid_->first_mesh(pattern, points);
    first_ = mesh.triangles;
    return mesh;
  }
  bool finds_folds(const Sheet&) const override { return true; }
  std::vector<FoldLine> fold_lines(const Sheet& sheet, const PlasticMemory&) const override {
    const auto count = sheet.triangles.rows();
    const bool is_first = count == first_.rows() && sheet.triangles == first_;
    if (!sheet.prescribed_creases.empty() || (on_ == FoldedOn::first_mesh && !is_first) ||
        (on_ == FoldedOn::coarse_meshes && 2 * count > 3 * first_.rows()))
      return {};
    return {{{0, 0.105}, {0.15, 0.105}, 0, {}}};
  }
  std::optional<PatternMesh> mesh_with_creases(const Pattern& pattern,
                                               const std::vector<Vector2d>& points,
                                               int refinement) const override {
    return hybrid_->mesh_with_creases(pattern, points, refinement);
  }

 private:
  FoldedOn on_;
  std::unique_ptr<Method> hybrid_;
  Triangles first_;
};

TEST(FoundFoldTest, ABendThatAFinerMeshDoesNotHaveIsNoFold) {
  const Shot page = pinched_page();
  for (const FoldedOn on : {FoldedOn::all_meshes, FoldedOn::first_mesh, FoldedOn::coarse_meshes}) {
    AnimateOptions options;
    options.last_frame = 24;
    options.plasticity = Plasticity::on;
    bool folded = false;
    animate(page, {"mistaken", [&] { return std::make_unique<Mistaken>(page, on); }}, options,
            [&](const AnimatedFrame& frame) {
              folded = !frame.sheet->prescribed_creases.empty();
              return true;
            });
    EXPECT_EQ(folded, on == FoldedOn::all_meshes);
  }
}

/// A strip of 100 x 60 mm, bent about its middle line with this curvature within `width`, on a
/// mesh of equal squares cut in two; all triangles there have yielded.
struct Bent {
  Sheet sheet;
  PlasticMemory memory;
};
Bent bent(double square, double curvature, double width) {
  const int columns = static_cast<int>(std::lround(0.1 / square)),
            rows = static_cast<int>(std::lround(0.06 / square));
  Bent bent;
  Sheet& sheet = bent.sheet;
  sheet.pattern.resize((columns + 1) * (rows + 1), 2);
  sheet.x.resize(sheet.pattern.rows(), 3);
  for (int i = 0; i < sheet.pattern.rows(); ++i) {
    const double x = square * (i % (columns + 1)), s = x - 0.05, half = width / 2;
    const double in = std::clamp(s, -half, half), turn = curvature * in, past = s - in;
    sheet.pattern.row(i) << x, square * (i / (columns + 1));
    sheet.x.row(i) << std::sin(turn) / curvature + past * std::cos(turn), sheet.pattern(i, 1),
        (std::cos(turn) - 1) / curvature - past * std::sin(turn);
  }
  sheet.triangles.resize(2 * columns * rows, 3);
  for (int k = 0; k < columns * rows; ++k) {
    const int a = k % columns + k / columns * (columns + 1), b = a + columns + 1;
    sheet.triangles.row(2 * k) << a, a + 1, b + 1;
    sheet.triangles.row(2 * k + 1) << a, b + 1, b;
  }
  bent.memory = PlasticMemory(static_cast<int>(sheet.triangles.rows()));
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    double x = 0;
    for (int i = 0; i < 3; ++i) x += sheet.pattern(sheet.triangles(t, i), 0) / 3;
    if (std::abs(x - 0.05) < width / 2) bent.memory.curvature(t, 0) = 0.3 * curvature;
  }
  return bent;
}

TEST(FindFoldLinesTest, ABendThatTheMeshCannotShowIsAFoldAndOneThatItShowsIsNot) {
  const Pattern pattern = test::rectangle(0.1, 0.06);
  // 138 degrees in 20 mm, by two rows of squares and by eight
  const Bent coarse = bent(0.01, 120, 0.02), fine = bent(0.0025, 120, 0.02);
  const std::vector<FoldLine> found = find_fold_lines(coarse.sheet, coarse.memory, pattern, 100);
  ASSERT_FALSE(found.empty());
  for (const FoldLine& line : found) {
    EXPECT_NEAR(line.a.x(), 0.05, 0.002);
    EXPECT_NEAR(line.b.x(), 0.05, 0.002);
    EXPECT_NEAR(std::abs(line.a.y() - line.b.y()), 0.06, 1e-9);
    EXPECT_GT(line.plastic_turn, 0);
  }
  EXPECT_TRUE(find_fold_lines(fine.sheet, fine.memory, pattern, 100).empty());
}

TEST(FindFoldLinesTest, PaperThatIsBentLessThanHalfItsYieldCurvatureIsNotFolded) {
  const Pattern pattern = test::rectangle(0.1, 0.06);
  const Bent sharp = bent(0.01, 300, 0.01);  // 172 degrees, in one row
  EXPECT_FALSE(find_fold_lines(sharp.sheet, sharp.memory, pattern, 300).empty());
  EXPECT_TRUE(find_fold_lines(sharp.sheet, sharp.memory, pattern, 600).empty());
}

TEST(FindFoldLinesTest, PaperThatHasNotYieldedAllAlongIsNotFolded) {
  Bent part = bent(0.01, 120, 0.02);
  for (int t = 0; t < part.sheet.triangles.rows(); ++t)
    if (part.sheet.pattern(part.sheet.triangles(t, 0), 1) > 0.025)
      part.memory.curvature.row(t).setZero();
  EXPECT_TRUE(find_fold_lines(part.sheet, part.memory, test::rectangle(0.1, 0.06), 100).empty());
}

/// Two plates that a strip which turns by phi lies between: at right angles to the bisector of its
/// two sides, `apart` [m] from each other.
ColliderShapes plates(double apart) {
  ColliderShapes shapes;
  for (const double x : {-apart / 2, apart / 2}) {
    ColliderMesh mesh{"plate", Points3(4, 3), Triangles(2, 3), {}};
    mesh.x << x, -1, -1, x, 1, -1, x, 1, 1, x, -1, 1;
    mesh.triangles << 0, 1, 2, 0, 2, 3;
    if (x > 0) mesh.triangles.col(1).swap(mesh.triangles.col(2));
    shapes.push_back(std::make_shared<const Collider>(mesh));
  }
  return shapes;
}

/// The same strip, before any of its triangles has yielded.
Bent sprung(double square, double curvature, double width) {
  Bent strip = bent(square, curvature, width);
  strip.memory.curvature.setZero();
  return strip;
}

std::vector<FoldLine> pressed(const Bent& strip, const ColliderShapes& colliders,
                              const Pattern& pattern, double yield_curvature) {
  return find_pressed_lines(
      strip.sheet, [&] { return strip.memory; }, colliders, pattern, yield_curvature);
}

TEST(FindFoldLinesTest, ARollThatTurnsByMoreThanOneRadianARowIsNoFold) {
  const Pattern pattern = test::rectangle(0.1, 0.06);
  // the same bend as that of the fold above, but in six rows of squares instead of two
  const Bent roll = bent(0.01, 120, 0.06), fold = bent(0.01, 120, 0.02);
  EXPECT_TRUE(find_fold_lines(roll.sheet, roll.memory, pattern, 100).empty());
  EXPECT_FALSE(find_fold_lines(fold.sheet, fold.memory, pattern, 100).empty());
  EXPECT_TRUE(pressed(roll, plates(0.015), pattern, 100).empty());
  EXPECT_FALSE(pressed(fold, plates(0.015), pattern, 100).empty());
}

TEST(FindFoldLinesTest, PaperIsFoldedBetweenPlatesThatLeaveNoRoomForABendThatDoesNotYield) {
  const Pattern pattern = test::rectangle(0.1, 0.06);
  const Bent strip = sprung(0.01, 250, 0.01);  // 2.5 rad in one row of squares
  const double needed = 2 * std::sin(1.25) / 0.012;
  const auto lines = [&](double apart, double yield_curvature) {
    return pressed(strip, plates(apart), pattern, yield_curvature);
  };
  ASSERT_FALSE(lines(0.012, 0.98 * needed).empty());
  for (const FoldLine& line : lines(0.012, 0.98 * needed)) {
    EXPECT_NEAR(line.a.x(), 0.05, 0.002);
    EXPECT_NEAR(line.b.x(), 0.05, 0.002);
    EXPECT_EQ(line.plastic_turn, 0);
  }
  EXPECT_TRUE(lines(0.012, 1.02 * needed).empty());
  EXPECT_TRUE(pressed(strip, {}, pattern, 0.98 * needed).empty());
  EXPECT_TRUE(find_fold_lines(strip.sheet, strip.memory, pattern, 0.98 * needed).empty());
}

TEST(FindFoldLinesTest, ABendThatFitsBetweenPlatesWithoutYieldingIsNoFold) {
  const Pattern pattern = test::rectangle(0.1, 0.06);
  for (const double width : {0.01, 0.02})
    for (double turn = 1.6; turn < 3.1; turn += 0.1) {
      const Bent strip = sprung(0.01, turn / width, width);
      const double yield = 1.02 * turn / width, apart = 2 * std::sin(turn / 2) * width / turn;
      EXPECT_TRUE(pressed(strip, plates(apart), pattern, yield).empty())
          << turn << " rad in " << width << " m";
    }
}

TEST(FindFoldLinesTest, AKnownCreaseIsNotFoundAgain) {
  Bent known = bent(0.01, 120, 0.02);
  known.sheet.prescribed_creases = {{{{0.05, 0}, {0.05, 0.06}}, 0, false}};
  EXPECT_TRUE(find_fold_lines(known.sheet, known.memory, test::rectangle(0.1, 0.06), 100).empty());
}

}  // namespace
}  // namespace paperbake
