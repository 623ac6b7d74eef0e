#include "baker/bake/bake.h"

#include "baker/bake/completed_bake.h"
#include "baker/bake/frame_queue.h"
#include "baker/bake/sheet_recorder.h"
#include "baker/output/cache_writers.h"
#include "baker/output/checkpoints.h"
#include "baker/output/file_hash.h"
#include "baker/output/output_folder.h"
#include "baker/output/stale_files.h"
#include "baker/output/summary.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

std::string sheet_file_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '/' || c == '.' || c == ':' || c == ' '; },
      '_');
  return name;
}

/// What ends a bake that did not go well, with what is kept all the same.
std::optional<Error> final_error(const std::optional<Error>& failure, const WriteFailures& failures,
                                 const Certificate& certificate) {
  if (!failure && failures.all().empty()) return {};
  const Error& error = failure ? *failure : failures.all().front().error;
  const int last = certificate.frames.back().frame;
  const std::string lost =
      failures.all().empty() ? "" : fmt::format(" Of what was asked for {}.", failures.summary());
  return Error(error.fault, error.place, error.cause,
               fmt::format("Frames up to {} are kept.{} {}", last, lost, error.remedy));
}

/// Certificate, page and what tells of the job; the summary last, which holds the keys of all other
/// files.
void write_certificate(const BakeSettings& settings, const BakePlan& plan,
                       const Certificate& certificate, const Report* report,
                       const std::optional<Error>& failure, BakeFiles& files,
                       BakeOutcome& outcome) {
  Gates gates;
  gates.max_stretch_pct = settings.max_stretch_pct;
  outcome.missed = missed_gates(gates, certificate.frames, plan);
  const auto write = [&](const std::string& file, const std::function<std::string()>& text) {
    if (files.failures.try_write(file, [&] { write_atomically(files.folder / file, text()); }))
      files.written.push_back(files.folder / file);
  };
  if (report)
    write("report.html", [&] {
      std::vector<std::string> sentences = outcome.missed;
      if (const auto error = final_error(failure, files.failures, certificate))
        sentences.push_back(error->cause + " " + error->remedy);
      return report->html(certificate.frames, sentences);
    });
  write("singular.csv", [&] { return singular_csv(certificate.singular); });
  write("job.lock.toml", [&] { return lock_text(plan); });
  if (settings.formats.count("cert")) {
    write("cert/frames.jsonl", [&] {
      std::string lines;
      for (const FrameRecord& record : certificate.frames) lines += frame_line(record) + "\n";
      return lines;
    });
    write("cert/handles.csv", [&] { return handles_csv(certificate.handles); });
    write("cert/summary.json", [&] {
      std::map<std::string, std::string> hashes;
      for (const auto& file : files.written)
        hashes[std::filesystem::relative(file, files.folder).generic_string()] = file_hash(file);
      const auto error = final_error(failure, files.failures, certificate);
      const int exit_code = error ? static_cast<int>(error->fault) : outcome.missed.empty() ? 0 : 4;
      return summary_json(plan, certificate.frames, certificate.crease_length,
                          {outcome.missed, exit_code, error ? error->what() : ""}, hashes);
    });
  }
  outcome.exit_code = outcome.missed.empty() ? 0 : 4;
}

/// Lines of frames that the .abc has in the end keep their key; of the others it is empty. Sorts
/// the lines by frame, singular points by sheet.
void finalize_certificate(Certificate& certificate, const BakePlan& plan,
                          const std::vector<std::size_t>& in_alembic) {
  std::map<std::string, std::size_t> left, number;
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    left[plan.shots[s].sheet_name] = in_alembic[s], number[plan.shots[s].sheet_name] = s;
  for (FrameRecord& record : certificate.frames) {
    std::size_t& more = left[record.sheet];
    if (more == 0)
      record.content_hash.clear();
    else
      --more;
  }
  std::stable_sort(certificate.frames.begin(), certificate.frames.end(),
                   [](const auto& a, const auto& b) { return a.frame < b.frame; });
  std::stable_sort(certificate.handles.begin(), certificate.handles.end(),
                   [](const auto& a, const auto& b) { return a.frame < b.frame; });
  std::stable_sort(certificate.singular.begin(), certificate.singular.end(),
                   [&](const auto& a, const auto& b) { return number[a.sheet] < number[b.sheet]; });
}

std::vector<std::size_t> frames_of_sheets(const Certificate& certificate, const BakePlan& plan) {
  std::vector<std::size_t> frames;
  for (const Shot& shot : plan.shots)
    frames.push_back(
        std::count_if(certificate.frames.begin(), certificate.frames.end(),
                      [&](const FrameRecord& r) { return r.sheet == shot.sheet_name; }));
  return frames;
}

/// The second pass: what was recorded, on meshes for the whole shot; sheets that come near each
/// other together.
void render_outputs(const BakeSettings& settings, const BakePlan& plan,
                    const std::vector<std::unique_ptr<SheetRecorder>>& outputs,
                    const FrameSpan& frames, WriteFailures& failures) {
  std::vector<RenderInput> shown;
  std::vector<const ShotRecord*> records;
  for (const auto& output : outputs)
    if (auto sheet = output->render_input())
      shown.push_back(std::move(*sheet)), records.push_back(shown.back().record);
  for (const std::vector<std::size_t>& list : near_each_other(records)) {
    std::vector<RenderInput> sheets;
    std::vector<std::string> names;
    for (const std::size_t s : list)
      sheets.push_back(shown[s]), names.push_back('"' + shown[s].shot->sheet_name + '"');
    failures.try_write(fmt::format("render mesh of sheet {}", fmt::join(names, ", ")), [&] {
      render_shot(sheets, settings.quality, frames, plan.animation.fps, settings.threads);
    });
  }
}

/// Polished frames depend on those behind them; what paper touches of colliders is not in the
/// state.
bool can_resume(const BakePlan& plan) {
  return plan.polish.triangles == 0 &&
         std::none_of(plan.shots.begin(), plan.shots.end(),
                      [](const Shot& shot) { return shot.colliders != nullptr; });
}

Error stopped(const BakeSettings& settings, const BakePlan& plan, int frame) {
  return Error(Fault::stopped, fmt::format("frame {} of {}", frame, plan.animation.last_frame),
               "The bake was stopped.",
               !can_resume(plan) ? "A bake with polish or colliders begins anew."
               : settings.resume == Resume::never
                   ? "Without --resume never the same command goes on from there."
                   : "The same command goes on from there.");
}

/// Hands on what earlier bakes have simulated, and leaves in the options where to go on. returns
/// the first frame that is not there
int load_frames(Checkpoints& checkpoints, const BakePlan& plan,
                std::vector<AnimateOptions>& options, Progress& progress,
                const std::function<bool(const AnimatedFrame&)>& consumer) {
  Checkpoints::ResumePoint resume = checkpoints.load([&](const AnimatedFrame& frame) {
    progress.taken(plan.shots[frame.of].sheet_name, frame.frame);
    return consumer(frame);
  });
  const int first = plan.animation.first_frame;
  if (!resume.damaged.empty()) progress.message("warning: " + resume.damaged);
  if (resume.last_frame >= first)
    progress.message(fmt::format("Frames {}-{} are as an earlier bake simulated them.", first,
                                 resume.last_frame));
  for (std::size_t s = 0; s < resume.states.size(); ++s)
    options[s].go_on_from = std::move(resume.states[s]);
  return resume.last_frame + 1;
}

}  // namespace

Passes passes_of(const BakeSettings& settings) {
  const bool cached = std::any_of(settings.formats.begin(), settings.formats.end(),
                                  [](const std::string& f) { return f != "maps" && f != "cert"; });
  return cached && settings.mesh == CacheMesh::render ? Passes::simulate_and_render
                                                      : Passes::simulate;
}

BakeOutcome bake(const BakeSettings& settings, const BakePlan& plan, Progress& progress,
                 const std::function<bool()>& stop) {
  const OutputFolder folder(settings.output);
  const std::string key = bake_key(settings, plan);
  if (settings.resume == Resume::automatic)
    if (auto before = find_completed_bake(folder.path(), key)) return *before;
  if (settings.debug_pictures) make_folder(*settings.debug_pictures, "--debug-pictures");
  for (const char* sub : {"maps", "cert"})
    if (settings.formats.count(sub)) folder.sub(sub);
  invalidate_completed_bake(folder.path());
  BakeOutcome outcome;
  BakeFiles files{folder.path(), {}, {}, {}};
  Certificate certificate;
  std::vector<std::string> suffixes;
  for (const Shot& shot : plan.shots)
    suffixes.push_back(plan.shots.size() > 1 ? "." + sheet_file_name(shot.sheet_name) : "");
  CacheWriters caches(settings, plan, folder.path(), suffixes, files.failures);

  std::vector<std::unique_ptr<SheetRecorder>> outputs;
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    outputs.push_back(std::make_unique<SheetRecorder>(settings, plan, s, caches, suffixes[s],
                                                      certificate, files, progress));
  const auto consume = [&](const AnimatedFrame& frame) { outputs[frame.of]->consume(frame); };
  // a later bake may want maps of these frames
  const bool wants_memory =
      can_resume(plan) || settings.formats.count("maps") || caches.wants_layers();
  std::vector<AnimateOptions> options = options_of_sheets(plan);
  for (AnimateOptions& of_sheet : options) of_sheet.report_plastic_curvature = wants_memory;
  const std::string rest = "the rest of the frames";
  Checkpoints checkpoints(folder.sub(".state"), plan, settings.checkpoint_every);
  int simulated_from = plan.animation.first_frame;
  if (settings.resume == Resume::automatic && can_resume(plan))
    simulated_from =
        load_frames(checkpoints, plan, options, progress, [&](const AnimatedFrame& frame) {
          return files.failures.try_write(rest, [&] { consume(frame); });
        });
  FrameQueue queue(settings.threads, consume);
  std::optional<Error> failure;
  try {
    if (simulated_from <= plan.animation.last_frame)
      simulate(plan, options, settings.threads, [&](const AnimatedFrame& frame) {
        if (can_resume(plan)) checkpoints.add(frame);
        if (!queue.push(frame)) return false;
        // polished, a sheet comes after the other
        const bool of_all = plan.polish.triangles > 0 || frame.of + 1 == plan.shots.size();
        if (!of_all || !stop || frame.frame == plan.animation.last_frame || !stop()) return true;
        if (can_resume(plan)) checkpoints.keep(frame.frame);
        throw stopped(settings, plan, frame.frame);
      });
  } catch (const Error& error) {
    failure = error;  // what was baked so far is kept
  }
  files.failures.try_write(rest, [&] { queue.finish(); });
  if (!checkpoints.failure().empty())
    progress.message("warning: what a later bake would go on from could not be kept: " +
                     checkpoints.failure());
  if (certificate.frames.empty() && failure) throw *failure;
  if (certificate.frames.empty()) throw files.failures.all().front().error;
  render_outputs(settings, plan, outputs, caches.shown_frames(), files.failures);
  for (const auto& output : outputs) output->finish();
  const CacheWriters::Finished whole =
      caches.finish(frames_of_sheets(certificate, plan), certificate.handles);
  files.written.insert(files.written.begin(), whole.files.begin(), whole.files.end());
  finalize_certificate(certificate, plan, whole.in_alembic);
  if (const std::string words = describe_sheet_intersections(certificate.frames); !words.empty())
    progress.message("warning: " + words + ".");
  write_certificate(settings, plan, certificate, caches.report(), failure, files, outcome);
  outcome.files = files.written;
  std::vector<std::filesystem::path> all = files.written;
  all.insert(all.end(), files.pictures.begin(), files.pictures.end());
  const StaleFiles stale = files.failures.all().empty() ? StaleFiles::remove : StaleFiles::keep;
  files.failures.try_write(".state/written", [&] { replace_outputs(folder.path(), all, stale); });
  if (const auto error = final_error(failure, files.failures, certificate)) throw *error;
  record_completed_bake(folder.path(), key, outcome);
  return outcome;
}

void print_warnings(const BakePlan& plan, Progress& progress) {
  for (const std::string& warning : plan.warnings) progress.message("warning: " + warning);
  for (const SheetImpossible& pair : plan.impossible)
    progress.message("warning: " + describe(pair));
}

BakeOutcome bake_with_progress(const BakeSettings& settings, const BakePlan& plan,
                               const std::function<bool()>& stop) {
  const FrameSpan& f = plan.frames;
  Progress progress(settings.progress,
                    static_cast<int>(plan.shots.size()) * ((f.last - f.first) / f.step + 1),
                    passes_of(settings));
  print_warnings(plan, progress);
  const BakeOutcome outcome = bake(settings, plan, progress, stop);
  for (const std::string& sentence : outcome.missed) progress.message("gate missed: " + sentence);
  return outcome;
}

}  // namespace paperbake
