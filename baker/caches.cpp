#include "baker/caches.h"

namespace paperbake {

Caches::Caches(const BakeSettings& settings, const BakePlan& plan, const std::filesystem::path& folder, const std::vector<std::string>& suffixes) : plan_(plan) {
  const CacheInfo info{plan.animation.fps, plan.frames.first, plan.frames.step, {{"paperbake_version", PAPERBAKE_VERSION}, {"paperbake_job", plan.job_hash}}};
  std::vector<std::string> names;
  for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
  const auto file = [&](const std::string& ending) { return files_.emplace_back(folder / (plan.name + ending)); };
  if (settings.formats.count("abc")) alembic_ = std::make_unique<AlembicWriter>(file(".abc"), info, names);
  if (settings.formats.count("usd")) usd_ = std::make_unique<UsdWriter>(file(".usda"), info, names);
  if (settings.formats.count("pc2"))
    for (const std::string& suffix : suffixes) {
      const auto cache = file(suffix + ".pc2");
      pc2_.push_back(std::make_unique<Pc2Writer>(cache, file(suffix + ".rest.obj"), info));
    }
  if (settings.formats.count("report")) report_.emplace(plan, (plan.frames.last - plan.frames.first) / plan.frames.step + 1);
}

std::string Caches::add_frame(std::size_t sheet, const CacheFrame& frame) {
  if (usd_) usd_->add_frame(sheet, frame);
  if (!pc2_.empty()) pc2_[sheet]->add_frame(frame, longer_side(plan_.shots[sheet].pattern));
  if (report_) report_->add_frame(sheet, frame);
  return alembic_ ? alembic_->add_frame(sheet, frame) : "";
}

std::vector<std::filesystem::path> Caches::finish() {
  if (alembic_) alembic_->finish();
  if (usd_) usd_->finish();
  for (const auto& pc2 : pc2_) pc2->finish();
  return files_;
}

}  // namespace paperbake
