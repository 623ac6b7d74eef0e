#include "core/animation/carried_sheet.h"

#include "core/methods/hybrid.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A page that is carried to another mesh, with inertia: it stays where it is then.
class CarriedSheetTest : public testing::Test {
 protected:
  CarriedSheetTest() {
    simulated_.elastic.set_inertia(Inertia::dynamic);
    carried_.begin(simulated_.sheet, {});
    simulated_.put_on(*method_->finer_mesh());
    carried_.carry(simulated_, *method_, simulated_.sheet.x, 1.0 / 24);
  }

  Shot shot_ = test::placed(0.21, 0.15, {0, 0, 0}, Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  std::unique_ptr<Method> method_ = hybrid(shot_.pattern, shot_.paper, 60, {}, 0, 0).make();
  SimulatedSheet simulated_{shot_, make_initial_sheet(shot_, *method_, 0), {}, 0};
  CarriedSheet carried_;
};

TEST_F(CarriedSheetTest, IsKnownOnTheMeshItWasCarriedTo) {
  EXPECT_EQ(carried_.positions(simulated_.sheet, *method_).rows(), simulated_.sheet.x.rows());
}

TEST_F(CarriedSheetTest, IsForgottenWhenTheMeshChangesOnceMore) {
  // The third mesh has other numbers of vertices and triangles.
  simulated_.put_on(*method_->finer_mesh());
  EXPECT_EQ(carried_.positions(simulated_.sheet, *method_).rows(), 0);
}

}  // namespace
}  // namespace paperbake
