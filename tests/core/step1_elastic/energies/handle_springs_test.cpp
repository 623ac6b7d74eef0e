#include "core/step1_elastic/energies/handle_springs.h"

#include "core/geometry/measure.h"
#include "core/step1_elastic/elastic.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(HandleSpringsTest, DerivativesMatchTheEnergyBelowAndBeyondTheYieldForce) {
  BlockCholesky matrix(1, {});
  const double step = 1e-9;
  // [m] the paper follows; the spring gives way; also on thin paper
  for (const auto& [way, grip] : {std::pair(4e-6, 1.0), {2e-3, 1.0}, {2e-3, 0.05}}) {
    const PositionConstraints springs{{0, {0.1, 0.2, 0.3}, 0, grip}};
    const Points3 x = (Vector3d(0.1, 0.2, 0.3) + way * Vector3d(2, -1, 2) / 3).transpose();
    EXPECT_EQ(gives_way(springs[0], x), way > 1e-3);
    const auto differentiate_at = [&](const Points3& y, Points3& gradient) {
      matrix.set_zero();
      gradient = Points3::Zero(1, 3);
      return differentiate_springs(springs, y, {0}, gradient, matrix);
    };
    Points3 gradient, before, after;
    EXPECT_EQ(differentiate_at(x, gradient), spring_energy(springs, x));
    ASSERT_GT(gradient.norm(), 0.1 * grip);
    const Eigen::MatrixXd second = matrix.dense();
    for (int k = 0; k < 3; ++k) {
      Points3 ahead = x, behind = x;
      ahead(0, k) += step;
      behind(0, k) -= step;
      EXPECT_NEAR((spring_energy(springs, ahead) - spring_energy(springs, behind)) / (2 * step),
                  gradient(0, k), 1e-4);
      differentiate_at(behind, before);
      differentiate_at(ahead, after);
      const Eigen::RowVector3d change = (after - before) / (2 * step);
      EXPECT_LT((change.transpose() - second.col(k)).norm(), 1e-4 * second.norm());
    }
  }
}

TEST(HandleSpringsTest, HandlesThatPullPaperLongerThanItIsStretchNoGradeMoreThanCopyPaper) {
  const auto stretch_of = [](const Paper& paper) {
    Sheet sheet = test::hex_sheet(0.1, 0.02, 20);
    Elastic elastic(paper, {});
    elastic.set_mesh(sheet);
    PositionConstraints ends;
    for (int v = 0; v < sheet.x.rows(); ++v)
      for (const double at : {0.0, 0.1})
        if (std::abs(sheet.pattern(v, 0) - at) < 1e-9) {
          const Vector3d further(at > 0 ? 0.01 : 0, 0, 0);
          ends.push_back({v, sheet.x.row(v).transpose() + further, 0, grip_on(paper)});
        }
    elastic.step(sheet, {ends}, 1 / 24.0);
    return length_distortion(sheet).largest;
  };
  Paper tissue;  // tissue17
  tissue.thickness = 40e-6;
  tissue.membrane_stiffness = 1.2e4;
  tissue.bending_stiffness = 1.8e-6;
  const double copy = stretch_of({});
  EXPECT_GT(copy, 1e-4);
  EXPECT_NEAR(stretch_of(tissue), copy, 0.1 * copy);  // held as copy paper is: 30 times as much
}

TEST(HandleSpringsTest, ASheetHungOnSoftHandlesSinksUntilTheyCarryItsWeight) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4);
  ElasticOptions options;
  options.forces.gravity = 9.81;
  const Paper paper;
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  PositionConstraints held;
  const double stiffness[] = {3.0, 3.0, 5.0, 5.0};  // [N/m]
  const Vector2d corners[] = {{0, 0}, {0.1, 0}, {0, 0.1}, {0.1, 0.1}};
  for (int k = 0; k < 4; ++k)
    for (int v = 0; v < sheet.x.rows(); ++v)
      if ((sheet.pattern.row(v).transpose() - corners[k]).norm() < 1e-9)
        held.push_back({v, sheet.x.row(v), stiffness[k]});
  ASSERT_EQ(held.size(), 4u);
  for (int k = 0; k < 60; ++k) elastic.step(sheet, {held}, 1 / 24.0);
  double carried = 0;
  for (const PositionConstraint& c : held)
    carried += c.stiffness * (c.target.z() - sheet.x(c.vertex, 2));
  const double weight = paper.area_density * 0.01 * options.forces.gravity;
  EXPECT_NEAR(carried, weight, 0.01 * weight);  // it still creeps inwards, a little each frame
}

}  // namespace
}  // namespace paperbake
