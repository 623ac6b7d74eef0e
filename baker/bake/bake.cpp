#include "baker/bake/bake.h"

#include "baker/bake/attempts.h"
#include "baker/bake/bake_pipeline.h"
#include "baker/bake/completed_bake.h"
#include "baker/bake/frame_queue.h"
#include "baker/job/output_formats.h"
#include "baker/job/plan_warnings.h"
#include "baker/output/checkpoints.h"
#include "baker/output/frequent_message.h"
#include "baker/output/output_folder.h"
#include "core/model/error.h"

#include <fmt/format.h>
#include <optional>

namespace paperbake {
namespace {

// stands for a file in messages when frames were lost on their way to the files
const char* const rest_of_frames = "the rest of the frames";

/// Whether the simulation can go on from a checkpoint: not that of polished frames, which depend on
/// later ones.
bool can_resume(const BakePlan& plan) { return plan.polish.triangles == 0; }

/// Frames of several sheets that are polished come sheet by sheet, and are not kept.
bool can_keep(const BakePlan& plan) { return plan.polish.triangles == 0 || plan.shots.size() == 1; }

Error stopped(const BakeSettings& settings, const BakePlan& plan, int frame) {
  const bool complete = frame == plan.animation.last_frame;
  return Error(ErrorCode::stopped, fmt::format("frame {} of {}", frame, plan.animation.last_frame),
               complete ? "The bake was stopped while it rendered." : "The bake was stopped.",
               !can_keep(plan) || (!complete && !can_resume(plan))
                   ? "A bake with --polish starts from its first frame."
               : settings.resume == Resume::never
                   ? "Leave --resume never out, and the same command continues from there."
                   : "The same command continues from there.");
}

/// The sub-folders of the formats, and that of the debug pictures.
void make_folders(const BakeSettings& settings, const OutputFolder& folder) {
  if (settings.debug_pictures) make_folder(*settings.debug_pictures, "--debug-pictures");
  for (const OutputFormat& format : output_formats())
    if (settings.formats.count(format.name) && !format.folder().empty())
      folder.sub(format.folder().c_str());
}

/// Records the frames that earlier bakes have simulated, and sets the options to resume after them.
/// returns  the first frame that is to be simulated
int load_frames(Checkpoints& checkpoints, const BakePlan& plan, BakePipeline& pipeline,
                Progress& progress, Attempts& attempts, std::vector<AnimateOptions>& options) {
  const int recorded_until = pipeline.recorded_until();
  Checkpoints::ResumePoint resume = checkpoints.load([&](const AnimatedFrame& frame) {
    if (frame.frame <= recorded_until) return true;
    if (!attempts.has_chosen())  // else this bake has simulated it
      progress.taken(plan.shots[frame.sheet_index].sheet_name, frame.frame);
    attempts.watch(frame);
    return pipeline.files().failures.try_write(rest_of_frames, [&] { pipeline.record(frame); });
  });
  const int first = plan.animation.first_frame;
  if (!resume.damaged.empty()) progress.warning(resume.damaged);
  if (resume.last_frame >= first && !attempts.has_chosen())
    progress.message(fmt::format("Frames {}-{} are as an earlier bake simulated them.", first,
                                 resume.last_frame));
  for (std::size_t s = 0; s < resume.states.size(); ++s)
    options[s].resume_state = std::move(resume.states[s]);
  return resume.last_frame + 1;
}

std::string describe_rehearsal(long seconds) {
  return fmt::format(
      "The opening of the shot is rehearsed, to find a mesh on which it bends: {} s so far.",
      seconds);
}

/// First stage: loads or simulates all frames of an attempt and records those that are not recorded
/// yet, or those until it fails.
/// returns  what ended the simulation before its last frame
std::optional<Error> record_frames(const BakeSettings& settings, const OutputFolder& folder,
                                   BakePipeline& pipeline, Progress& progress, StopRequest& stop,
                                   Attempts& attempts) {
  const BakePlan& plan = attempts.plan();
  const bool resumable = can_resume(plan), kept = can_keep(plan);
  std::optional<FrequentMessage> frequent;  // from when it simulates on
  std::vector<AnimateOptions> options = options_of_sheets(plan);
  for (AnimateOptions& of_sheet : options) {
    // a later bake that resumes may want maps
    of_sheet.report_plastic_curvature = kept || pipeline.needs_plastic_curvature();
    of_sheet.asks_to_stop = [&] {
      if (frequent && frequent->is_due())
        progress.message(describe_rehearsal(frequent->seconds_so_far()));
      return stop.is_made();
    };
  }
  Checkpoints checkpoints(folder.sub(".state"), plan, settings.checkpoint_every,
                          resumable ? Reuse::any_of_them : Reuse::all_or_none);
  int first = plan.animation.first_frame;
  if ((settings.resume == Resume::automatic || attempts.has_chosen()) && kept)
    first = load_frames(checkpoints, plan, pipeline, progress, attempts, options);

  const StageClock::Part part(&pipeline.clock(), Stage::simulate);
  const int recorded_until = pipeline.recorded_until();
  FrameQueue queue(settings.threads, [&](const AnimatedFrame& frame) { pipeline.record(frame); });
  std::optional<Error> failure;
  try {
    frequent.emplace();
    if (first <= plan.animation.last_frame && !attempts.is_failing())
      simulate(
          plan, options, settings.threads,
          [&](const AnimatedFrame& frame) {
            if (kept) checkpoints.add(frame);
            if (plan.polish.triangles == 0) attempts.watch(frame);
            if (frame.frame > recorded_until && !queue.push(frame)) return false;
            // polished frames come sheet by sheet
            const bool is_last_sheet =
                plan.polish.triangles > 0 || frame.sheet_index + 1 == plan.shots.size();
            if (!is_last_sheet) return true;
            const bool ends = attempts.is_failing() || stop.is_made();
            if (frame.frame == plan.animation.last_frame || !ends) return true;
            if (resumable) checkpoints.keep(frame.frame);
            if (!stop.is_made()) return false;
            throw stopped(settings, plan, frame.frame);
          },
          [&](const AnimatedFrame& frame) {
            attempts.watch(frame);
            return frame.sheet_index + 1 < plan.shots.size() || !attempts.is_doubtful();
          });
  } catch (const Error& error) {
    failure = error;  // what was recorded so far is kept
  }
  pipeline.files().failures.try_write(rest_of_frames, [&] { queue.finish(); });
  if (!checkpoints.failure().empty()) {
    pipeline.note_kept_until(checkpoints.kept_until());
    progress.warning("what a later bake would go on from could not be kept: " +
                     checkpoints.failure());
  }
  return failure;
}

/// Tries other attempts than the first one, and chooses among them all.
/// returns  why it has not chosen: the first one, as far as it is recorded, is written all the same
std::optional<Error> choose_attempt(Attempts& attempts, Progress& progress, StopRequest& stop,
                                    StageClock& clock) try {
  if (attempts.choose(progress, stop, clock)) return std::nullopt;
  return Error(ErrorCode::stopped,
               fmt::format("frame {} of {}", attempts.last_seen_frame(),
                           attempts.plan().animation.last_frame),
               "The bake was stopped while it tried another attempt.",
               "The same command continues from there.");
} catch (const Error& error) {
  return error;
}

/// Simulates the twin of a bake and enters its distance into the certificate.
void compare_with_twin(const BakeSettings& settings, const BakePlan& plan, BakePipeline& pipeline,
                       Progress& progress, StopRequest& stop) {
  const StageClock::Part part(&pipeline.clock(), Stage::simulate);
  const BakePlan twin = twin_of(plan);
  std::vector<AnimateOptions> options = options_of_sheets(twin);
  for (AnimateOptions& of_sheet : options)
    of_sheet.asks_to_stop = [&stop] { return stop.is_made(); };
  try {
    simulate(twin, options, settings.threads, [&](const AnimatedFrame& frame) {
      pipeline.record_twin(frame);
      return !stop.is_made();
    });
  } catch (const Error& error) {
    if (error.code != ErrorCode::stopped)
      progress.warning(fmt::format("twin: {}: {}", error.place, error.cause));
  }
  if (const auto verdict = pipeline.twin(); verdict && !stop.is_made())
    progress.message(describe(*verdict));
}

}  // namespace

Passes passes_of(const BakeSettings& settings) {
  return has_frames(settings.formats) && settings.mesh == CacheMesh::render
             ? Passes::simulate_and_render
             : Passes::simulate;
}

BakeOutcome bake(const BakeSettings& settings, const BakePlan& plan, Progress& progress,
                 const std::function<bool()>& asks_to_stop) {
  const OutputFolder folder(settings.output);
  const std::string key = bake_key(settings, plan);
  if (settings.resume == Resume::automatic)
    if (auto before = find_completed_bake(folder.path(), key)) return *before;
  make_folders(settings, folder);
  invalidate_completed_bake(folder.path());

  Attempts attempts(settings, plan, folder.sub(".state"));
  StopRequest stop(asks_to_stop);
  StageClock clock;
  std::optional<BakePipeline> recorded;
  std::optional<Error> failure;
  const auto record = [&] {
    if (!recorded) recorded.emplace(settings, attempts.plan(), folder.path(), progress, clock);
    failure = record_frames(settings, folder, *recorded, progress, stop, attempts);
  };
  record();
  if (const std::string caution = attempts.caution(); !caution.empty() && !failure)
    progress.message(caution);
  if (attempts.is_doubtful() && !failure) {
    failure = choose_attempt(attempts, progress, stop, clock);
    if (!failure && attempts.recorded() != Attempts::Recorded::everything) {
      if (attempts.recorded() == Attempts::Recorded::nothing) {
        recorded->discard();  // its files are written anew
        recorded.reset();
        progress.begin_again();
      }
      record();
    }
  }
  BakePipeline& pipeline = *recorded;
  if (pipeline.is_empty()) throw failure ? *failure : pipeline.files().failures.all().front().error;
  if (settings.twin && !failure)
    compare_with_twin(settings, attempts.plan(), pipeline, progress, stop);
  if (!pipeline.render(stop) && !failure)
    failure = stopped(settings, plan, plan.animation.last_frame);
  const BakeOutcome outcome = pipeline.write(failure, key);
  record_completed_bake(folder.path(), key, outcome);
  return outcome;
}

void print_warnings(const BakePlan& plan, Progress& progress) {
  for (const std::string& warning : plan.warnings) progress.warning(warning);
  for (const UnreachablePairOfSheet& pair : plan.impossible) progress.warning(describe(pair));
}

BakeOutcome bake_with_progress(const BakeSettings& settings, const BakePlan& plan,
                               const std::function<bool()>& stop) {
  const FrameSpan& f = plan.frames;
  Progress progress(settings.progress,
                    static_cast<int>(plan.shots.size()) * ((f.last - f.first) / f.step + 1),
                    passes_of(settings));
  if (settings.log) progress.log_to(*settings.log);
  ProgressStart start{plan.name, plan.job_hash, f, {}, settings.output};
  for (const Shot& shot : plan.shots) start.sheets.push_back(shot.sheet_name);
  progress.start(start);
  print_warnings(plan, progress);
  try {
    const BakeOutcome outcome = bake(settings, plan, progress, stop);
    for (const std::string& sentence : outcome.missed) progress.gate_missed(sentence);
    progress.end({outcome.exit_code, outcome.missed, outcome.files, ""});
    return outcome;
  } catch (const Error& error) {
    progress.end({static_cast<int>(error.code), {}, {}, error.what()});
    throw;
  }
}

}  // namespace paperbake
