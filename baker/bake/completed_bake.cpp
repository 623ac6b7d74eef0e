#include "baker/bake/completed_bake.h"

#include "baker/bake/attempts.h"
#include "baker/output/checkpoints.h"
#include "baker/output/stale_files.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <fmt/format.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

fs::path record_path(const fs::path& folder) { return folder / ".state" / "done"; }

std::string spans_text(const std::vector<FrameSpan>& spans) {
  std::string text;
  for (const FrameSpan& s : spans) text += fmt::format("{}-{}x{},", s.first, s.last, s.step);
  return text;
}

}  // namespace

std::string bake_key(const BakeSettings& settings, const BakePlan& plan) {
  std::string text =
      fmt::format("{}\n{}\n{}\n{}\n{}\nmaps {}\n", program_key(), plan.job_hash, plan.name,
                  plan.root, fmt::join(settings.formats, ","), spans_text(plan.map_frames));
  if (may_be_finer(settings)) text += "the first mesh may be finer\n";
  if (settings.twin) text += "twin\n";
  if (plan.guides) text += "guides\n";
  if (plan.usd_layers) text += "USD layers\n";
  if (settings.debug_pictures)
    text += fmt::format("pictures {} {}\n", fs::absolute(*settings.debug_pictures).string(),
                        spans_text(plan.debug_frames));
  return text;
}

std::optional<BakeOutcome> find_completed_bake(const fs::path& folder, const std::string& key) {
  try {
    const Json record = parse_json(read_file(record_path(folder)).value_or(""));
    if (record.at("key") != key || !outputs_unmodified(folder)) return {};
    BakeOutcome outcome;
    outcome.exit_code = record.at("exit_code");
    outcome.missed = record.at("missed").get<std::vector<std::string>>();
    for (const std::string& name : record.at("files").get<std::vector<std::string>>())
      outcome.files.push_back(folder / name);
    return outcome;
  } catch (const std::exception&) {
    return {};  // there is none, or it is somebody else's
  }
}

void record_completed_bake(const fs::path& folder, const std::string& key,
                           const BakeOutcome& outcome) {
  std::vector<std::string> names;
  for (const fs::path& path : outcome.files)
    names.push_back(path.lexically_relative(folder).generic_string());
  const Json record{
      {"key", key}, {"exit_code", outcome.exit_code}, {"missed", outcome.missed}, {"files", names}};
  write_atomically(record_path(folder), json_lines(record));
}

void invalidate_completed_bake(const fs::path& folder) {
  std::error_code none;
  fs::remove(record_path(folder), none);
}

}  // namespace paperbake
