#include "baker/bake/bake_pipeline.h"

#include "baker/bake/cached_frames.h"
#include "baker/bake/rendered_frames.h"
#include "baker/job/method_choice.h"
#include "baker/job/used_values.h"
#include "baker/output/checkpoints.h"
#include "baker/output/file_hash.h"
#include "baker/output/gates.h"
#include "baker/output/leaps.h"
#include "baker/output/summary.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/bytes_of.h"
#include "formats/files/collider_record.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <map>
#include <string>

namespace paperbake {
namespace {

ColliderRecord collider_record(const BakePlan& plan) {
  ColliderRecord record;
  record.first_frame = plan.animation.first_frame;
  for (const Shot& shot : plan.shots)
    for (const Collider& collider : *shot.colliders)
      record.of_sheet[shot.sheet_name].push_back(collider.mesh());
  return record;
}

/// A sentence about files of the bake before that are gone; empty: none is.
std::string describe_removed(const std::vector<std::string>& files) {
  constexpr std::size_t named = 4;
  if (files.empty()) return "";
  std::string text =
      "Removed, because this bake does not write it: " +
      fmt::to_string(fmt::join(files.begin(), files.begin() + std::min(named, files.size()), ", "));
  if (files.size() > named) text += fmt::format(" and {} more", files.size() - named);
  return text + ".";
}

}  // namespace

BakePipeline::BakePipeline(const BakeSettings& settings, const BakePlan& plan,
                           const std::filesystem::path& folder, Progress& progress,
                           StageClock& clock)
    : files_(folder),
      certificate_(plan),
      caches_(settings.formats, {plan, folder}, files_),
      tasks_(settings.threads),
      context_{settings, plan, files_, certificate_, caches_, progress, tasks_, &clock} {
  const FrameSpan shown = caches_.frames_shown();
  progress.expect_rendered(static_cast<int>(plan.shots.size()) *
                           ((shown.last - shown.first) / shown.step + 1));
  if (settings.twin) shapes_.emplace(plan);
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    recorders_.push_back(std::make_unique<SheetRecorder>(context_, s));
}

BakePipeline::~BakePipeline() { tasks_.abandon(); }

bool BakePipeline::needs_plastic_curvature() const {
  return context_.settings.formats.count("maps") > 0 || context_.plan.guides ||
         caches_.store_crease_attributes();
}

void BakePipeline::record(const AnimatedFrame& frame) {
  recorders_[frame.sheet_index]->consume(frame);
  if (frame.sheet_index + 1 == recorders_.size()) recorded_until_ = frame.frame;
  if (shapes_ && context_.plan.frames.contains(frame.frame)) shapes_->add(frame);
}

void BakePipeline::discard() {
  tasks_.abandon();
  for (const auto& recorder : recorders_) recorder->discard();
  std::error_code none;
  for (const auto& picture : files_.pictures()) std::filesystem::remove(picture, none);
}

void BakePipeline::record_twin(const AnimatedFrame& frame) {
  if (const std::optional<double> distance = shapes_->distance(frame))
    certificate_.line(frame.sheet_index, frame.frame).twin = distance;
}

bool BakePipeline::render(StopRequest& stop) {
  const StageClock::Part part(context_.clock, Stage::render_frames);
  std::vector<std::size_t> sheets;
  std::vector<const ShotRecord*> records;
  for (std::size_t s = 0; s < recorders_.size(); ++s) {
    recorders_[s]->finish_simulation();
    if (!stop.is_time_up()) recorders_[s]->draw_final_map();
    if (recorders_[s]->record().frames().empty()) continue;
    sheets.push_back(s);
    records.push_back(&recorders_[s]->record());
  }
  for (std::vector<std::size_t> group : groups_near_each_other(records)) {
    for (std::size_t& member : group) member = sheets[member];
    std::vector<std::string> names;
    for (const std::size_t s : group)
      names.push_back('"' + context_.plan.shots[s].sheet_name + '"');
    files_.failures.try_write(fmt::format("render mesh of sheet {}", fmt::join(names, ", ")),
                              [&] { render_group(group, stop); });
  }
  return !stop.is_time_up();
}

/// sheets  that come near each other
void BakePipeline::render_group(const std::vector<std::size_t>& sheets, StopRequest& stop) {
  int rendered = 0;
  try {
    render_frames(sheets, MeshFeatures::all, rendered, stop);
  } catch (const Error& error) {
    if (rendered > 0) throw;  // the frames before are kept
    context_.progress.warning(fmt::format("{}: {} It is made without singular points and creases.",
                                          error.place, error.cause));
    render_frames(sheets, MeshFeatures::handles, rendered, stop);
  }
}

/// rendered  is raised with every frame that is handed on
void BakePipeline::render_frames(const std::vector<std::size_t>& sheets, MeshFeatures features,
                                 int& rendered, StopRequest& stop) {
  const BakeSettings& settings = context_.settings;
  const BakePlan& plan = context_.plan;
  RenderedFrames kept(files_.folder() / ".state" / rendered_frames_file(sheets.front(), features),
                      render_key(sheets), settings.resume);
  FrameSpan left = caches_.frames_shown();
  // of the frames that are taken: one object, which the writers store once
  std::vector<std::shared_ptr<const MeshSurface>> surfaces;
  int taken = 0;
  while (auto frame = kept.take()) {
    surfaces.clear();
    for (const RenderedSheet& sheet : *frame) surfaces.push_back(sheet.mesh.surface);
    left.first = frame->front().frame + left.step;
    hand_on(sheets, *frame);
    ++taken;
  }
  rendered += taken;
  if (taken > 0)
    context_.progress.message(
        fmt::format("{} frames are as an earlier bake rendered them.", taken));
  const int last = recorders_[sheets.front()]->record().frames().back().frame;
  if (left.first > std::min(left.last, last) || stop.is_time_up()) return;
  std::vector<RenderInput> inputs;
  for (const std::size_t s : sheets) inputs.push_back({&recorders_[s]->record(), &plan.shots[s]});
  RenderPass pass(std::move(inputs), {settings.quality, left, plan.animation.fps, settings.threads,
                                      features, context_.clock, is_hybrid(settings)});
  for (; !stop.is_time_up() && pass.next(); ++rendered) {
    for (std::size_t i = 0; i < pass.sheets().size(); ++i) {
      const StageClock::Part of_caches(context_.clock, Stage::caches);
      RenderedSheet& sheet = pass.sheets()[i];
      sheet.mesh.layers =
          recorders_[sheets[i]]->crease_attributes(sheet.record_index, pass.pattern(i));
      round_to_32_bits(sheet.mesh);
      if (i < surfaces.size()) sheet.mesh.surface = surfaces[i];
    }
    {
      const StageClock::Part keeping(context_.clock, Stage::keep);
      kept.add(pass.sheets());
    }
    hand_on(sheets, pass.sheets());
  }
}

/// Gives a rendered frame to the caches, and its quality to the certificate.
/// sheets  the numbers of those in the frame, and maybe more
void BakePipeline::hand_on(const std::vector<std::size_t>& sheets,
                           std::vector<RenderedSheet>& frame) {
  const StageClock::Part part(context_.clock, Stage::caches);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    FrameRecord& line = certificate_.line(sheets.at(i), frame[i].frame);
    line.statistics.render = frame[i].statistics;
    line.statistics.handle_error_max = frame[i].handle_error;
    enter(frame[i].judgement, line);
    frame[i].mesh.guides = recorders_[sheets[i]]->guides(frame[i].frame, frame[i].mesh);
    if (context_.plan.usd_layers)
      frame[i].mesh.proxy = recorders_[sheets[i]]->simulated(frame[i].record_index);
    line.content_hash = caches_.add_frame(sheets[i], frame[i].frame, frame[i].mesh);
    context_.progress.rendered(line);
  }
}

/// What the rendered frames of sheets depend on: everything that was simulated, to the last bit,
/// and all that says how it is rendered.
std::string BakePipeline::render_key(const std::vector<std::size_t>& sheets) const {
  const FrameSpan shown = caches_.frames_shown();
  std::string key =
      fmt::format("{} {} {}-{}x{} {}", program_key(), context_.plan.job_hash, shown.first,
                  shown.last, shown.step, caches_.store_crease_attributes() ? "attributes" : "");
  for (const std::size_t s : sheets) {
    key += fmt::format(" {}", s);
    for (const RecordedFrame& frame : recorders_[s]->record().frames())
      key += hex(content_hash(bytes_of_values(frame.x)));
  }
  return hex(content_hash(key));
}

BakeOutcome BakePipeline::write(const std::optional<Error>& failure, const std::string& key) {
  const StageClock::Part part(context_.clock, Stage::certificate);
  const BakePlan& plan = context_.plan;
  const std::string cache_key = key + plan.simulation_hash;  // which another attempt has not
  if (failure && are_longer_caches_there(files_.folder(), cache_key, caches_.frames_added()))
    leave_longer_caches(*failure);
  for (const auto& recorder : recorders_) recorder->finish();
  const std::size_t maps = files_.written().size();
  const std::vector<std::size_t> in_cache =
      caches_.finish({certificate_.lines_of_sheets(), certificate_.handles});
  certificate_.finalize(in_cache);
  files_.move_to_front_after(maps);
  if (const std::string where = describe(find_leaps(certificate_.frames(), plan)); !where.empty())
    context_.progress.warning(where);

  Gates gates;
  gates.max_stretch_pct = context_.settings.max_stretch_pct;
  BakeOutcome outcome;
  const std::vector<MissedGate> missed = missed_gates(gates, certificate_.frames(), plan);
  outcome.missed = with_advice(missed);
  const bool is_told = std::any_of(missed.begin(), missed.end(), [](const MissedGate& gate) {
    return gate.gate == Gate::handles;
  });
  if (const std::string where = describe_unsolved(certificate_.frames());
      !is_told && !where.empty())
    context_.progress.warning(where);
  if (const std::string where = describe_unsettled(certificate_.frames()); !where.empty())
    context_.progress.warning(where);
  outcome.exit_code = missed.empty() ? 0 : gate_missed;
  const auto error = final_error(failure);
  caches_.write_ending(
      {certificate_.frames(), missed, error ? error->cause + " " + error->remedy : ""});
  write_certificate(outcome, failure);
  outcome.files = files_.written();

  list_outputs(files_.failures.all().empty() ? StaleFiles::remove : StaleFiles::keep);
  files_.failures.try_write(".state/cached", [&] {
    const bool is_counted = context_.settings.formats.count("abc") > 0;
    record_cached_frames(files_.folder(), cache_key,
                         is_counted ? in_cache : caches_.frames_added());
  });
  if (const auto failed = final_error(failure)) throw *failed;
  remove_rendered_frames(files_.folder() / ".state");
  return outcome;
}

/// Notes which files this bake has written, and removes those of the bake before that it replaces.
void BakePipeline::list_outputs(StaleFiles stale) {
  std::vector<std::filesystem::path> all = files_.written();
  all.insert(all.end(), files_.pictures().begin(), files_.pictures().end());
  files_.failures.try_write(".state/written", [&] {
    const auto removed = replace_outputs(files_.folder(), context_.plan.name, all, stale, keys_);
    if (const std::string told = describe_removed(removed); !told.empty())
      context_.progress.message(told);
  });
}

/// The certificate that is there belongs to those caches, and so does the final map.
void BakePipeline::leave_longer_caches(const Error& failure) {
  for (const auto& recorder : recorders_) {
    recorder->drop_final_map();
    recorder->finish();
  }
  list_outputs(StaleFiles::keep);
  const Error error = *final_error(failure);
  throw Error(
      error.code, error.place, error.cause,
      "The files of the bake before stay, because its caches have more frames. " + error.remedy);
}

/// Certificate and lock file; the summary last, which holds the hashes of all other files.
void BakePipeline::write_certificate(const BakeOutcome& outcome,
                                     const std::optional<Error>& failure) {
  const auto write = [&](const std::string& file, const std::function<std::string()>& text) {
    files_.write(file, [&](const auto& path) { write_atomically(path, text()); });
  };
  write("singular.csv", [&] { return singular_csv(certificate_.singular); });
  write("job.lock.toml", [&] { return lock_text(context_.plan); });
  if (!context_.settings.formats.count("cert")) return;
  write("cert/frames.jsonl", [&] {
    std::string lines;
    for (const FrameRecord& record : certificate_.frames()) lines += frame_line(record) + "\n";
    return lines;
  });
  if (context_.plan.shots.front().colliders)
    write("cert/colliders.json", [&] { return collider_json(collider_record(context_.plan)); });
  write("cert/handles.csv", [&] { return handles_csv(certificate_.handles); });
  write("cert/summary.json", [&] {
    std::map<std::string, std::string> hashes;
    for (const auto& file : files_.written())
      hashes[std::filesystem::relative(file, files_.folder()).generic_string()] = keys_[file] =
          file_hash(file);
    const auto error = final_error(failure);
    return summary_json(
        context_.plan, certificate_.frames(),
        {certificate_.crease_length, certificate_.found_creases, certificate_.frames_of_folding},
        {outcome.missed, error ? static_cast<int>(error->code) : outcome.exit_code,
         error ? error->what() : "", clock().seconds()},
        hashes);
  });
}

/// What ends a bake that did not go well, with what is kept all the same.
std::optional<Error> BakePipeline::final_error(const std::optional<Error>& failure) const {
  const WriteFailures& failures = files_.failures;
  if (!failure && failures.all().empty()) return {};
  const Error& error = failure ? *failure : failures.all().front().error;
  const int last = std::min(certificate_.frames().back().frame, kept_until_);
  const std::string kept = last < context_.plan.animation.first_frame
                               ? "What was simulated could not be kept."
                               : fmt::format("Frames up to {} are kept.", last);
  const std::string lost =
      failures.all().empty() ? "" : fmt::format(" Of what was asked for {}.", failures.summary());
  return Error(error.code, error.place, error.cause,
               fmt::format("{}{} {}", kept, lost, error.remedy));
}

}  // namespace paperbake
