// Velocities in the cache of meshes that change: of points of the sheet, whatever mesh they lie on.

#include "baker/bake/sheet_recorder.h"

#include "baker/job/input_hash.h"
#include "formats/cache/alembic_reader.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace paperbake {
namespace {

/// A point of a sheet that turns, stretches and flies: linear in the pattern, so that any mesh of
/// it shows it exactly.
Vector3d place(const Vector2d& p, double t) {
  return {std::cos(3 * t) * p.x() - std::sin(3 * t) * p.y(),
          std::sin(3 * t) * p.x() + (1 + t) * p.y(), 0.3 * t * t + p.x() * t};
}

Sheet sheet_at(int columns, unsigned seed, double t) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, columns, 0.2, seed);
  for (int v = 0; v < sheet.pattern.rows(); ++v) sheet.x.row(v) = place(sheet.pattern.row(v), t);
  return sheet;
}

TEST(SheetRecorderTest, VelocitiesOfMeshesThatChangeAreCentralDifferencesOfTheSheetsOwnPoints) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                       ("paperbake_sheet_recorder_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  BakeSettings settings;
  settings.mesh = CacheMesh::simulation;
  settings.formats = {"abc"};
  BakePlan plan;
  plan.name = "changing";
  plan.shots = {test::blank_shot(test::rectangle(0.1, 0.1))};
  plan.sheets.resize(1);
  plan.sheets[0].preset = "copy70";
  plan.frames = {1, 6, 1};
  hash_frames(plan);
  const double dt = 1 / plan.animation.fps;
  BakeFiles files(folder);
  BakeCertificate certificate(plan);
  CacheWriters caches(settings.formats, {plan, folder}, files);
  Progress progress(ProgressMode::none, 6, Passes::simulate);
  TaskQueue tasks(1);
  const BakeContext context{settings, plan, files, certificate, caches, progress, tasks};
  SheetRecorder recorder(context, 0);
  for (int f = 1; f <= 6; ++f) {
    // the same mesh twice, then always another
    const Sheet sheet = sheet_at(f < 3 ? 7 : 5 + 2 * (f % 3), f < 3 ? 1 : f, f * dt);
    AnimatedFrame frame;
    frame.frame = f;
    frame.sheet = &sheet;
    recorder.consume(frame);
  }
  recorder.finish_simulation();
  recorder.finish();
  EXPECT_TRUE(recorder.record().frames().empty()) << "there is nothing to render";
  EXPECT_EQ(caches.finish({{6}, certificate.handles}), std::vector<std::size_t>{6});

  const AlembicReader cache(folder / "changing.abc");
  ASSERT_EQ(cache.sheets()[0].frames, 6u);
  EXPECT_FALSE(cache.sheets()[0].constant_topology);
  double fastest = 0;
  for (int f = 1; f <= 6; ++f) {
    const CacheFrame stored = cache.frame(0, f - 1);
    const int from = std::max(1, f - 1), to = std::min(6, f + 1);  // one-sided at the ends
    for (int v = 0; v < stored.x.rows(); ++v) {
      const Vector2d p = 0.1 * stored.uv.row(v);
      const Vector3d expected = (place(p, to * dt) - place(p, from * dt)) / ((to - from) * dt);
      ASSERT_LT((stored.velocity.row(v).transpose() - expected).norm(), 1e-6)
          << "frame " << f << ", vertex " << v;
      fastest = std::max(fastest, expected.norm());
    }
    EXPECT_EQ(certificate.frames()[f - 1].content_hash, cache.content_hash(0, f - 1));
    ASSERT_TRUE(certificate.frames()[f - 1].statistics.render.has_value());
    EXPECT_EQ(certificate.frames()[f - 1].statistics.render->triangles, stored.triangles.rows());
  }
  EXPECT_GT(fastest, 0.3);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace paperbake
