#include "core/animation/collider_jam.h"

#include <gtest/gtest.h>

#include <string>

namespace paperbake {
namespace {

/// A triangle that falls by 10 mm from frame to frame.
Colliders falling() {
  ColliderMesh mesh;
  mesh.x = Points3::Zero(3, 3);
  mesh.x.row(1).x() = mesh.x.row(2).y() = 0.1;
  mesh.triangles.resize(1, 3);
  mesh.triangles << 0, 1, 2;
  for (int f = 0; f < 3; ++f) {
    mesh.frames.push_back(mesh.x);
    mesh.frames.back().col(2).array() -= 0.01 * f;
  }
  return {Collider(mesh)};
}

double height(const ColliderShapes& shapes) { return shapes.front()->mesh().x(0, 2); }

TEST(ColliderJam, TheNextFrameBeginsWhereTheCollidersJammedTheSheet) {
  const Colliders colliders = falling();
  ColliderJam jam;
  jam.hold(motion_to(colliders, 1), 0.25);
  ASSERT_TRUE(jam.is_on());
  EXPECT_EQ(jam.note(shapes_at(colliders, 1)),
            "it is jammed: colliders have gone on by 7.5 mm without it");
  ColliderMotion next = motion_to(colliders, 2);
  jam.begin_frame(next);
  EXPECT_NEAR(height(next.from), -0.0025, 1e-15);
  EXPECT_EQ(height(next.to), -0.02);
  jam.release();
  next = motion_to(colliders, 2);
  jam.begin_frame(next);
  EXPECT_EQ(height(next.from), -0.01) << "a sheet that follows again is taken along from frame 1";
}

TEST(ColliderJam, ComesBackFromACheckpoint) {
  const Colliders colliders = falling();
  ColliderJam jam, restored;
  jam.hold(motion_to(colliders, 1), 0.25);
  Serializer written;
  jam.archive(written, &colliders, 1);
  Serializer read(written.bytes());
  restored.archive(read, &colliders, 1);
  read.end();
  ColliderMotion next = motion_to(colliders, 2);
  restored.begin_frame(next);
  ASSERT_TRUE(restored.is_on());
  EXPECT_NEAR(height(next.from), -0.0025, 1e-15);
  Serializer without_colliders(written.bytes());
  EXPECT_THROW(restored.archive(without_colliders, nullptr, 1), Error);
}

}  // namespace
}  // namespace paperbake
