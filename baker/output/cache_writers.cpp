#include "baker/output/cache_writers.h"

#include "core/model/error.h"

#include <fmt/format.h>

namespace paperbake {

CacheWriters::CacheWriters(const BakeSettings& settings, const BakePlan& plan,
                           const std::filesystem::path& folder,
                           const std::vector<std::string>& suffixes, WriteFailures& failures)
    : plan_(plan), folder_(folder), suffixes_(suffixes), failures_(failures) {
  const CacheInfo info{
      plan.animation.fps,
      plan.frames.first,
      plan.frames.step,
      {{"paperbake_version", PAPERBAKE_VERSION}, {"paperbake_job", plan.job_hash}}};
  std::vector<std::string> names;
  for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
  if (settings.formats.count("abc"))
    alembic_ = std::make_unique<AlembicWriter>(folder / name(".abc"), info, names);
  if (settings.formats.count("usd"))
    usd_ = std::make_unique<UsdWriter>(folder / name(".usda"), info, names);
  if (settings.formats.count("pc2"))
    for (const std::string& suffix : suffixes)
      pc2_.push_back(std::make_unique<Pc2Writer>(folder / name(suffix + ".pc2"),
                                                 folder / name(suffix + ".rest.obj"), info));
  if (settings.formats.count("preview"))
    preview_.emplace(
        fmt::format("{}, {}, {}, seed {}, frames {}-{}", plan.name, plan.method,
                    plan.presets.front(), plan.seeds.front(), plan.frames.first, plan.frames.last),
        plan.frames, plan.shots.front().colliders, plan.animation.first_frame);
  if (settings.formats.count("report"))
    report_.emplace(plan, (plan.frames.last - plan.frames.first) / plan.frames.step + 1);
}

FrameSpan CacheWriters::shown_frames() const {
  return alembic_ || usd_ || !pc2_.empty() || report_ ? plan_.frames : preview_frames(plan_.frames);
}

std::string CacheWriters::add_frame(std::size_t sheet, int number, const CacheFrame& frame) {
  std::string key;
  if (alembic_) failures_.try_write(name(".abc"), [&] { key = alembic_->add_frame(sheet, frame); });
  if (usd_) failures_.try_write(name(".usda"), [&] { usd_->add_frame(sheet, frame); });
  if (!pc2_.empty())
    failures_.try_write(name(suffixes_[sheet] + ".pc2"), [&] {
      pc2_[sheet]->add_frame(frame, longer_side(plan_.shots[sheet].pattern));
    });
  if (report_) failures_.try_write("report.html", [&] { report_->add_frame(sheet, frame); });
  if (preview_) preview_->add_frame(number, frame);
  return key;
}

CacheWriters::Finished CacheWriters::finish(const std::vector<std::size_t>& frames,
                                            const std::vector<HandleRecord>& handles) {
  Finished finished;
  finished.in_alembic.assign(frames.size(), 0);
  if (alembic_)
    keep(
        name(".abc"), frames, [&] { return finished.in_alembic = alembic_->finish(); }, finished);
  if (usd_ && failures_.try_write(name(".usda"), [&] { usd_->finish(); }))
    finished.files.push_back(folder_ / name(".usda"));
  for (std::size_t s = 0; s < pc2_.size(); ++s) {
    const std::size_t before = finished.files.size();
    keep(
        name(suffixes_[s] + ".pc2"), {frames[s]},
        [&] { return std::vector<std::size_t>{pc2_[s]->finish()}; }, finished);
    if (finished.files.size() > before)
      finished.files.push_back(folder_ / name(suffixes_[s] + ".rest.obj"));
  }
  const auto picture = folder_ / name(".preview.png");
  if (preview_ && failures_.try_write(name(".preview.png"),
                                      [&] { write_png(picture, preview_->picture(handles)); }))
    finished.files.push_back(picture);
  return finished;
}

/// Finishes a cache that can keep the frames before it failed, and says how far it goes.
void CacheWriters::keep(const std::string& file, const std::vector<std::size_t>& wanted,
                        const std::function<std::vector<std::size_t>()>& finish,
                        Finished& finished) {
  try {
    const std::vector<std::size_t> kept = finish();
    std::size_t most = 0;
    for (const std::size_t frames : kept) most = std::max(most, frames);
    if (kept != wanted) {
      const Error short_of_room(Fault::folder, (folder_ / file).string(),
                                "There was no room for all of it.", "Make room, and bake again.");
      failures_.record_partial(
          file,
          most ? fmt::format("ends at frame {}",
                             plan_.frames.first + plan_.frames.step * (static_cast<int>(most) - 1))
               : "has no frame",
          short_of_room);
    }
    if (most > 0) finished.files.push_back(folder_ / file);
  } catch (const Error& error) {
    failures_.try_write(file, [&] { throw error; });
  }
}

}  // namespace paperbake
