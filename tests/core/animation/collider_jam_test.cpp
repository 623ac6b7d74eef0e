#include "core/animation/collider_jam.h"

#include "core/methods/hybrid.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

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
    mesh.frames.own().push_back(mesh.x);
    mesh.frames.own().back().col(2).array() -= 0.01 * f;
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
  jam.archive(written, &colliders);
  Serializer read(written.bytes());
  restored.archive(read, &colliders);
  read.end();
  ColliderMotion next = motion_to(colliders, 2);
  restored.begin_frame(next);
  ASSERT_TRUE(restored.is_on());
  EXPECT_NEAR(height(next.from), -0.0025, 1e-15);
  Serializer without_colliders(written.bytes());
  EXPECT_THROW(restored.archive(without_colliders, nullptr), Error);
}

/// Sheets on a table, one on the other, through which a finger is pressed into the table, by so
/// many metres a frame.
std::vector<Shot> pressed_by_finger(int sheets, int frames, double speed = 0.001) {
  const double gap = 0.0006;  // [m]
  ColliderMesh table{"table", Points3(4, 3), Triangles(2, 3), {}};
  table.x << -1, -1, -gap * sheets, 1, -1, -gap * sheets, 1, 1, -gap * sheets, -1, 1, -gap * sheets;
  table.triangles << 0, 1, 2, 0, 2, 3;
  ColliderMesh finger{"finger", Points3(4, 3), Triangles(4, 3), {}};
  finger.x << 0, 0, 0.001, 0.01, 0, 0.04, -0.005, 0.008, 0.04, -0.005, -0.008, 0.04;
  finger.triangles << 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2;
  for (int f = 0; f < frames; ++f) {
    finger.frames.own().push_back(finger.x);
    finger.frames.own().back().col(2).array() -= speed * f;
  }
  const auto colliders =
      std::make_shared<const Colliders>(Colliders{Collider(table), Collider(finger)});
  std::vector<Shot> shots;
  for (int k = 0; k < sheets; ++k) {
    shots.push_back(
        test::placed(0.1, 0.1, {-0.05, -0.05, -gap * k}, Vector3d(1, 0, 0), Vector3d(0, 1, 0)));
    shots.back().colliders = colliders;
  }
  return shots;
}

TEST(ColliderJam, SheetsWithInertiaThatArePressedThroughATableStayWhole) {
  // A finger that is followed through the table stretches them by tens of percent.
  AnimateOptions options;
  options.last_frame = 6;
  options.elastic.inertia = Inertia::dynamic;
  options.elastic.forces.gravity = 9.81;
  for (const auto& [sheets, held] : {std::pair(1, false), {2, false}, {1, true}, {2, true}}) {
    std::vector<Shot> shots = pressed_by_finger(sheets, options.last_frame);
    if (held) {  // by a hand, which gives way where colliders do not
      Handle hand{"hand", {0.01, 0.05}, Points3(1, 3)};
      hand.keyed << -0.04, 0, 0;
      shots[0].handles = {hand};
    }
    const MethodChoice method = hybrid(shots[0].pattern, shots[0].paper, 120, {}, 0, 0);
    std::vector<AnimatedSheet> all;
    for (const Shot& shot : shots) all.push_back({shot, method, options});
    double worst = 0;
    std::vector<std::string> last_notes(shots.size());
    animate_together(all, [&](const AnimatedFrame& frame) {
      worst = std::max(worst, length_distortion(*frame.sheet).largest);
      last_notes[frame.sheet_index] = frame.note;
      return true;
    });
    EXPECT_LT(worst, 0.021) << sheets << " " << held;
    for (const std::string& note : last_notes)
      EXPECT_NE(note.find("it is jammed"), std::string::npos) << sheets << held << note;
  }
}

TEST(ColliderJam, ASheetThatCollidersLeaveFarBehindStaysWhereTheyJammedIt) {
  // 3 mm a frame; from 38 mm on, more than eight halvings of a frame are needed to follow slowly
  AnimateOptions options;
  options.last_frame = 24;
  const Shot shot = pressed_by_finger(1, options.last_frame, 0.003).front();
  const std::string begins = "it is jammed: colliders have gone on by ";
  double behind = 0;  // [mm]
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            if (behind == 0 && frame.note.empty()) return true;
            EXPECT_EQ(frame.note.rfind(begins, 0), 0u) << frame.frame << " " << frame.note;
            const double now = std::atof(frame.note.c_str() + begins.size());
            if (behind > 0) {
              EXPECT_NEAR(now - behind, 3, 0.11) << frame.frame;
            }
            behind = now;
            return true;
          });
  EXPECT_GT(behind, 45);
}

}  // namespace
}  // namespace paperbake
