#include "baker/bake.h"

#include "baker/caches.h"
#include "baker/frame_queue.h"
#include "baker/output_folder.h"
#include "baker/sheet_output.h"
#include "baker/summary.h"
#include "baker/verify.h"
#include "core/error.h"
#include "formats/whole_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace paperbake {
namespace {

std::string sheet_file_name(std::string name) {
  std::replace_if(name.begin(), name.end(), [](char c) { return c == '/' || c == '.' || c == ':' || c == ' '; }, '_');
  return name;
}

/// Maps and certificate of an earlier bake of the same name would be taken for this one's.
void remove_stale(const OutputFolder& folder, const std::string& name, const std::vector<std::filesystem::path>& written) {
  std::error_code ignored;
  for (const char* sub : {"maps", "cert"})
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / sub, ignored)) {
      const std::string file = entry.path().filename().string();
      const bool ours = sub == std::string("maps") ? file.rfind(name + ".", 0) == 0 && entry.path().extension() == ".exr"
                                                   : file == "frames.jsonl" || file == "handles.csv" || file == "summary.json";
      if (ours && std::find(written.begin(), written.end(), entry.path()) == written.end()) std::filesystem::remove(entry.path(), ignored);
    }
}

/// Certificate, page and what tells of the job; the summary last, which holds the keys of all other files.
void write_certificate(const OutputFolder& folder, const BakeSettings& settings, const BakePlan& plan, Certificate& certificate, const Report* report,
                       BakeOutcome& outcome) {
  std::stable_sort(certificate.frames.begin(), certificate.frames.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  std::stable_sort(certificate.handles.begin(), certificate.handles.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  Gates gates;
  gates.max_stretch_pct = settings.max_stretch_pct;
  outcome.missed = missed_gates(gates, certificate.frames, plan);
  outcome.exit_code = outcome.missed.empty() ? 0 : 4;
  const auto write = [&](const std::filesystem::path& file, const std::string& text) {
    write_whole_file(file, text);
    outcome.files.push_back(file);
  };
  if (report) write(folder.path() / "report.html", report->html(certificate.frames, outcome.missed));
  write(folder.path() / "singular.csv", singular_csv(certificate.singular));
  write(folder.path() / "job.lock.toml", lock_text(plan));
  if (!settings.formats.count("cert")) return;
  const auto cert = folder.sub("cert");
  std::string lines;
  for (const FrameRecord& record : certificate.frames) lines += frame_line(record) + "\n";
  write(cert / "frames.jsonl", lines);
  write(cert / "handles.csv", handles_csv(certificate.handles));
  std::map<std::string, std::string> hashes;
  for (const auto& file : outcome.files) hashes[std::filesystem::relative(file, folder.path()).generic_string()] = file_hash(file);
  write(cert / "summary.json", summary_json(plan, certificate.frames, outcome.missed, hashes));
}

}  // namespace

BakeOutcome bake(const BakeSettings& settings, const BakePlan& plan, Progress& progress) {
  const OutputFolder folder(settings.output);
  if (settings.debug_pictures) make_folder(*settings.debug_pictures, "--debug-pictures");
  BakeOutcome outcome;
  Certificate certificate;
  std::vector<std::string> suffixes;
  for (const Shot& shot : plan.shots) suffixes.push_back(plan.shots.size() > 1 ? "." + sheet_file_name(shot.sheet_name) : "");
  Caches caches(settings, plan, folder.path(), suffixes);

  std::optional<Error> failure;
  for (std::size_t s = 0; s < plan.shots.size() && !failure; ++s) {
    const Shot& shot = plan.shots[s];
    const auto map_stem = settings.formats.count("maps") ? folder.sub("maps") / (plan.name + suffixes[s]) : std::filesystem::path();
    SheetOutput output(settings, plan, s, caches, suffixes[s], map_stem, certificate, outcome.files);
    AnimateOptions animation = plan.animation;
    animation.seed = plan.seeds[s] + 0x9e3779b9u * static_cast<unsigned>(s);  // sheets of one seed differ
    FrameQueue queue(settings.threads, [&](const AnimatedFrame& frame) {
      if (const FrameRecord* record = output.take(frame))
        progress.frame(shot.sheet_name, record->frame, record->stretch_mean_pct, record->triangles, record->singular);
    });
    try {
      animate(shot, plan.methods[s], animation, [&](const AnimatedFrame& frame) { return queue.push(frame); });
    } catch (const Error& error) {
      if (error.fault != Fault::simulation) throw;
      failure = error;  // what was baked so far is kept
    }
    queue.finish();
    if (failure && certificate.frames.empty()) throw *failure;
    output.finish();
  }
  const auto whole = caches.finish();
  outcome.files.insert(outcome.files.begin(), whole.begin(), whole.end());
  write_certificate(folder, settings, plan, certificate, caches.report(), outcome);
  remove_stale(folder, plan.name, outcome.files);
  if (failure)
    throw Error(failure->fault, failure->place, failure->cause,
                fmt::format("Frames up to {} are kept. {}", certificate.frames.back().frame, failure->remedy));
  return outcome;
}

}  // namespace paperbake
