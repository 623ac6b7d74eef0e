#include "core/animation/simulated_sheet.h"

#include "core/methods/hybrid.h"
#include "core/model/error.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A page that was lifted by a millimetre a frame.
class SimulatedSheetTest : public testing::Test {
 protected:
  SimulatedSheetTest() {
    simulated_.positions_before = simulated_.sheet.x;
    simulated_.sheet.x.col(2).array() += 0.001;
    simulated_.sheet.v.col(2).setConstant(0.024);
  }

  /// A mesh that no solver takes: one of its triangles is there twice.
  PatternMesh faulty_mesh() {
    PatternMesh mesh = *method_->finer_mesh();
    mesh.triangles.row(1) = mesh.triangles.row(0);
    return mesh;
  }

  Shot shot_ = test::placed(0.21, 0.15, {0, 0, 0}, Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  std::unique_ptr<Method> method_ = hybrid(shot_.pattern, shot_.paper, 60, {}, 0, 0).make();
  SimulatedSheet simulated_{shot_, make_initial_sheet(shot_, *method_, 0), {}, 0};
};

TEST_F(SimulatedSheetTest, IsPutOnAFinerMeshWhereItIs) {
  const long vertices = simulated_.sheet.x.rows();
  simulated_.put_on(*method_->finer_mesh());
  const long now = simulated_.sheet.x.rows();
  EXPECT_GT(now, vertices);
  EXPECT_EQ(simulated_.positions_before.rows(), now);
  EXPECT_EQ(simulated_.fixed.size(), static_cast<std::size_t>(now));
  // it rose by as much everywhere, the wave of its start of a micrometre aside
  EXPECT_LT((simulated_.sheet.x - simulated_.positions_before).col(2).array().abs().maxCoeff(),
            0.001 + 1e-12);
}

TEST_F(SimulatedSheetTest, StaysAsItWasWhereItCannotBePutOnAMesh) {
  const SimulatedSheet::MeshSnapshot before = simulated_.snapshot();
  ASSERT_GT(before.sheet.x.rows(), 0);
  EXPECT_THROW(simulated_.put_on(faulty_mesh()), Error);
  EXPECT_TRUE(same_entries(simulated_.sheet.x, before.sheet.x));
  EXPECT_TRUE(same_entries(simulated_.sheet.v, before.sheet.v));
  EXPECT_TRUE(same_entries(simulated_.sheet.pattern, before.sheet.pattern));
  EXPECT_TRUE(same_entries(simulated_.sheet.triangles, before.sheet.triangles));
  EXPECT_EQ(simulated_.fixed, before.fixed);
  EXPECT_TRUE(same_entries(simulated_.positions_before, before.positions_before));
  // the solver, too, is on the mesh of the sheet: it can go on to another
  simulated_.put_on(*method_->finer_mesh());
  EXPECT_EQ(simulated_.positions_before.rows(), simulated_.sheet.x.rows());
}

}  // namespace
}  // namespace paperbake
