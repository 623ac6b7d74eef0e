#include "baker/bake.h"

#include "baker/cache_measure.h"
#include "baker/debug_pictures.h"
#include "baker/frame_queue.h"
#include "baker/output_folder.h"
#include "baker/report.h"
#include "baker/summary.h"
#include "baker/verify.h"
#include "core/curvature.h"
#include "core/error.h"
#include "core/measure.h"
#include "core/transfer.h"
#include "formats/alembic_cache.h"
#include "formats/certificate.h"
#include "formats/crease_map.h"
#include "formats/whole_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

/// A fold on the maps is as wide as 2 % of the sheet, but never narrower than the mesh can show.
double fold_width(const Pattern& pattern, const Sheet& mesh) {
  return std::max(0.02 * shorter_side(pattern), 1.3 * mean_edge(mesh.pattern, mesh.triangles));
}

/// Everything the shot leaves behind; shared by its sheets.
struct Certificate {
  std::vector<FrameRecord> frames;
  std::vector<HandleRecord> handles;
  std::vector<SingularRecord> singular;
};

/// Takes the frames of one sheet as they are simulated and hands them on to cache, maps and certificate. A frame waits for
/// its successor, so that its velocity is the central difference of the true motion.
class SheetOutput {
 public:
  SheetOutput(const BakeSettings& settings, const BakePlan& plan, std::size_t sheet, AlembicWriter* cache, Report* report, std::string suffix,
              std::filesystem::path map_stem, Certificate& certificate, std::vector<std::filesystem::path>& files)
      : settings_(settings), plan_(plan), sheet_(sheet), shot_(plan.shots[sheet]), cache_(cache), report_(report), suffix_(std::move(suffix)), map_stem_(std::move(map_stem)),
        certificate_(certificate), files_(files), input_hash_(plan.start_hash[sheet]) {}

  const FrameRecord* take(const AnimatedFrame& frame) {
    input_hash_ = frame_input_hash(input_hash_, shot_, frame.frame, plan_.animation.first_frame);
    draw_map(frame);
    draw_debug_picture(frame);
    release_waiting(&*frame.sheet);
    before_ = std::move(now_);
    now_ = *frame.sheet;
    for (std::size_t k = known_singular_; k < frame.sheet->singular.size(); ++k)
      certificate_.singular.push_back({shot_.sheet_name, frame.sheet->singular[k]});
    known_singular_ = frame.sheet->singular.size();
    if (!plan_.frames.contains(frame.frame)) return nullptr;
    certificate_.frames.push_back(judge(frame));
    record_handles(frame);
    if (cache_ || report_) wait(*frame.sheet);
    return &certificate_.frames.back();
  }

  void finish() {
    release_waiting(nullptr);
    if (!map_) return;
    files_.push_back(map_stem_.string() + ".final.exr");
    map_->write(files_.back(), map_info(last_map_frame_));
  }


 private:
  FrameRecord judge(const AnimatedFrame& frame) const {
    const Sheet& sheet = *frame.sheet;
    const LengthDistortion length = length_distortion(sheet);
    FrameRecord r;
    r.frame = frame.frame;
    r.sheet = shot_.sheet_name;
    r.triangles = r.render_triangles = static_cast<int>(sheet.triangles.rows());
    r.stretch_mean_pct = r.render_stretch_mean_pct = 100 * length.mean;
    r.stretch_max_pct = r.render_stretch_max_pct = 100 * length.largest;
    r.angle_defect_max_deg = angle_defect_max(sheet) * 180 / M_PI;
    for (std::size_t h = 0; h < frame.handles.size(); ++h) {
      const HandleFrame& handle = frame.handles[h];
      if (handle.state == HandleFrame::free) continue;
      const double off_mm = 1e3 * (handle.at - handle.keyed).norm();
      r.handle_err_max_mm = std::max(r.handle_err_max_mm, off_mm);
      if (handle.state == HandleFrame::jammed) r.jammed.push_back({shot_.handles[h].name, off_mm});
    }
    r.singular = static_cast<int>(sheet.singular.size());
    r.new_singular = frame.new_singular;
    r.elastic_ms = frame.elastic_ms;
    r.geometry_ms = frame.geometry_ms;
    r.substeps = frame.substeps;
    r.newton_iterations = frame.newton_iterations;
    r.converged = frame.converged;
    r.energy_J = frame.energy;
    r.crossings = crossings(sheet);
    r.touching = frame.touching;
    r.note = frame.note;
    r.input_hash = input_hash_;
    return r;
  }

  void record_handles(const AnimatedFrame& frame) {
    for (std::size_t h = 0; h < frame.handles.size(); ++h) {
      const HandleFrame& handle = frame.handles[h];
      HandleRecord r;
      r.frame = frame.frame;
      r.sheet = shot_.sheet_name;
      r.handle = shot_.handles[h].name;
      r.pattern = shot_.handles[h].pattern;
      r.keyed = handle.keyed;
      r.held = handle.at;
      r.state = handle.state == HandleFrame::held ? HandleRecord::held_state
                : handle.state == HandleFrame::free ? HandleRecord::free_state : HandleRecord::jammed_state;
      certificate_.handles.push_back(std::move(r));
    }
  }

  void draw_map(const AnimatedFrame& frame) {
    if (!settings_.formats.count("maps")) return;
    if (!map_) map_.emplace(shot_.pattern, settings_.map_size, fold_width(shot_.pattern, *frame.sheet));
    map_->record(*frame.sheet, vertex_curvature(*frame.sheet));
    last_map_frame_ = frame.frame;
    const bool wanted = std::any_of(plan_.map_frames.begin(), plan_.map_frames.end(), [&](const FrameSpan& s) { return s.contains(frame.frame); });
    if (!wanted || frame.frame < plan_.frames.first) return;
    files_.push_back(fmt::format("{}.{:04}.exr", map_stem_.string(), frame.frame));
    map_->write(files_.back(), map_info(frame.frame));
  }

  void draw_debug_picture(const AnimatedFrame& frame) const {
    if (!settings_.debug_pictures || frame.frame < plan_.frames.first) return;
    const bool listed = std::any_of(plan_.debug_frames.begin(), plan_.debug_frames.end(), [&](const FrameSpan& s) { return s.contains(frame.frame); });
    if (!listed && frame.new_singular == 0 && frame.frame != plan_.frames.last) return;
    const std::string title = fmt::format("{}, {}, {}, frame {}", plan_.name, shot_.sheet_name, plan_.methods[sheet_].name, frame.frame);
    write_png(*settings_.debug_pictures / fmt::format("{}{}.{:04}.png", plan_.name, suffix_, frame.frame), debug_picture(shot_, frame, title));
  }

  MapInfo map_info(int frame) const {
    return {frame, plan_.animation.fps, plan_.seeds[sheet_], plan_.presets[sheet_]};
  }

  void wait(const Sheet& sheet) {
    CacheFrame frame;
    frame.x = sheet.x;
    frame.normal = vertex_normals(sheet.x, sheet.triangles);
    frame.triangles = sheet.triangles;
    frame.uv = sheet.pattern / longer_side(shot_.pattern);
    const LengthDistortion stored = cache_distortion(frame, longer_side(shot_.pattern));
    certificate_.frames.back().render_stretch_mean_pct = 100 * stored.mean;
    certificate_.frames.back().render_stretch_max_pct = 100 * stored.largest;
    frame.velocity = sheet.v;  // backward difference, where neighbours cannot be compared
    waiting_ = std::move(frame);
  }

  /// Central difference of the true motion of the sheet points that are vertices of the waiting frame, `now_`.
  /// next: the sheet one frame later; null at the end of the shot.
  void release_waiting(const Sheet* next) {
    if (!waiting_) return;
    const double fps = plan_.animation.fps;
    const bool has_before = before_.x.rows() > 0;
    if (has_before && next) waiting_->velocity = 0.5 * fps * (carried(*next) - carried(before_));
    else if (next) waiting_->velocity = fps * (carried(*next) - now_.x);
    else if (has_before) waiting_->velocity = fps * (now_.x - carried(before_));
    if (cache_) certificate_.frames.back().content_hash = cache_->add_frame(sheet_, *waiting_);
    if (report_) report_->add_frame(sheet_, *waiting_);
    waiting_.reset();
  }

  /// Where the vertices of now_ are in another frame, whatever its mesh. |V|x3 [m]
  Points3 carried(const Sheet& other) const {
    const bool same = other.pattern.rows() == now_.pattern.rows() && other.pattern == now_.pattern;
    return same ? other.x : Transfer(other.pattern, other.triangles, now_.pattern)(other.x);
  }

  const BakeSettings& settings_;
  const BakePlan& plan_;
  std::size_t sheet_;
  const Shot& shot_;
  AlembicWriter* cache_;
  Report* report_;
  std::string suffix_;                         // of file names, when there are several sheets
  std::filesystem::path map_stem_;
  Certificate& certificate_;
  std::vector<std::filesystem::path>& files_;  // what was written
  std::string input_hash_;
  std::size_t known_singular_ = 0;
  std::optional<CreaseMap> map_;
  int last_map_frame_ = 0;
  Sheet before_, now_;                   // one frame before the waiting one, and that
  std::optional<CacheFrame> waiting_;
};

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

void write_certificate(const OutputFolder& folder, const BakeSettings& settings, const BakePlan& plan, Certificate& certificate,
                       const Report* report, BakeOutcome& outcome) {
  std::stable_sort(certificate.frames.begin(), certificate.frames.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  std::stable_sort(certificate.handles.begin(), certificate.handles.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  Gates gates;
  gates.max_stretch_pct = settings.max_stretch_pct;
  outcome.missed = missed_gates(gates, certificate.frames, plan);
  outcome.exit_code = outcome.missed.empty() ? 0 : 4;
  if (report) {
    outcome.files.push_back(folder.path() / "report.html");
    write_whole_file(outcome.files.back(), report->html(certificate.frames, outcome.missed));
  }
  write_whole_file(folder.path() / "singular.csv", singular_csv(certificate.singular));
  write_whole_file(folder.path() / "job.lock.toml", lock_text(plan));
  if (!settings.formats.count("cert")) return;
  const auto cert = folder.sub("cert");
  std::string lines;
  for (const FrameRecord& record : certificate.frames) lines += frame_line(record) + "\n";
  for (const auto& [file, text] : {std::pair<const char*, std::string>{"frames.jsonl", std::move(lines)}, {"handles.csv", handles_csv(certificate.handles)}}) {
    outcome.files.push_back(cert / file);
    write_whole_file(outcome.files.back(), text);
  }
  std::map<std::string, std::string> hashes;
  for (const auto& file : outcome.files) hashes[std::filesystem::relative(file, folder.path()).generic_string()] = file_hash(file);
  for (const char* file : {"singular.csv", "job.lock.toml"}) hashes[file] = file_hash(folder.path() / file);
  outcome.files.push_back(cert / "summary.json");
  write_whole_file(outcome.files.back(), summary_json(plan, certificate.frames, outcome.missed, hashes));
}

}  // namespace

BakeOutcome bake(const BakeSettings& settings, const BakePlan& plan, Progress& progress) {
  const OutputFolder folder(settings.output);
  if (settings.debug_pictures) make_folder(*settings.debug_pictures, "--debug-pictures");
  BakeOutcome outcome;
  Certificate certificate;
  std::unique_ptr<AlembicWriter> cache;
  const auto cache_file = folder.path() / (plan.name + ".abc");
  if (settings.formats.count("abc")) {
    std::vector<std::string> names;
    for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
    cache = std::make_unique<AlembicWriter>(
        cache_file, CacheInfo{plan.animation.fps, plan.frames.first, plan.frames.step, {{"paperbake_version", PAPERBAKE_VERSION}, {"paperbake_job", plan.job_hash}}}, names);
    outcome.files.push_back(cache_file);
  }

  std::optional<Report> report;
  if (settings.formats.count("report")) report.emplace(plan, (plan.frames.last - plan.frames.first) / plan.frames.step + 1);

  std::optional<Error> failure;
  for (std::size_t s = 0; s < plan.shots.size() && !failure; ++s) {
    const Shot& shot = plan.shots[s];
    const std::string suffix = plan.shots.size() > 1 ? "." + sheet_file_name(shot.sheet_name) : "";
    const auto map_stem = settings.formats.count("maps") ? folder.sub("maps") / (plan.name + suffix) : std::filesystem::path();
    SheetOutput output(settings, plan, s, cache.get(), report ? &*report : nullptr, suffix, map_stem, certificate, outcome.files);
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
  if (cache) cache->finish();
  write_certificate(folder, settings, plan, certificate, report ? &*report : nullptr, outcome);
  remove_stale(folder, plan.name, outcome.files);
  if (failure)
    throw Error(failure->fault, failure->place, failure->cause,
                fmt::format("Frames up to {} are kept. {}", certificate.frames.back().frame, failure->remedy));
  return outcome;
}

}  // namespace paperbake
