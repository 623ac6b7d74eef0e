#include "baker/bake/completed_bake.h"

#include "baker/output/checkpoints.h"
#include "baker/output/stale_files.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path note_in(const fs::path& folder) { return folder / ".state" / "done"; }

std::string in_words(const std::vector<FrameSpan>& spans) {
  std::string text;
  for (const FrameSpan& s : spans) text += fmt::format("{}-{}x{},", s.first, s.last, s.step);
  return text;
}

}  // namespace

std::string request_of(const BakeSettings& settings, const BakePlan& plan) {
  std::string text =
      fmt::format("{}\n{}\n{}\n{}\nmaps {}\n", program_key(), plan.job_hash, plan.name,
                  fmt::join(settings.formats, ","), in_words(plan.map_frames));
  if (settings.debug_pictures)
    text += fmt::format("pictures {} {}\n", fs::absolute(*settings.debug_pictures).string(),
                        in_words(plan.debug_frames));
  return text;
}

std::optional<BakeOutcome> finished_before(const fs::path& folder, const std::string& request) {
  try {
    std::ifstream file(note_in(folder));
    const Json note = Json::parse(file);
    if (note.at("request") != request || !are_as_written(folder)) return {};
    BakeOutcome outcome;
    outcome.exit_code = note.at("exit_code");
    outcome.missed = note.at("missed").get<std::vector<std::string>>();
    for (const std::string& name : note.at("files").get<std::vector<std::string>>())
      outcome.files.push_back(folder / name);
    return outcome;
  } catch (const std::exception&) {
    return {};  // there is none, or it is somebody else's
  }
}

void note_finished(const fs::path& folder, const std::string& request, const BakeOutcome& outcome) {
  std::vector<std::string> names;
  for (const fs::path& path : outcome.files)
    names.push_back(path.lexically_relative(folder).generic_string());
  const Json note{{"request", request},
                  {"exit_code", outcome.exit_code},
                  {"missed", outcome.missed},
                  {"files", names}};
  write_atomically(note_in(folder), note.dump(1, ' ', false, Json::error_handler_t::replace));
}

void forget_finished(const fs::path& folder) {
  std::error_code none;
  fs::remove(note_in(folder), none);
}

}  // namespace paperbake
