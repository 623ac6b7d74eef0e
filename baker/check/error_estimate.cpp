#include "baker/check/error_estimate.h"

#include "core/animation/branch_search.h"
#include "core/animation/cpu_clock.h"
#include "core/animation/polisher.h"
#include "core/model/error.h"
#include "formats/cache/alembic_reader.h"
#include "formats/config/lock_file.h"
#include "formats/files/atomic_file.h"
#include "formats/files/certificate.h"
#include "formats/files/json.h"
#include "formats/scene/flat_sheet.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

constexpr int every = 12;                  // [frames]
constexpr int fine = 2400, probing = 200;  // [triangles]
constexpr int waves = 1;                   // of each height, in the probe for another branch
constexpr double of_another_paper = 1.3;   // [1] so much more energy on the finer mesh
constexpr int about_a_snap = 6;            // [frames]
constexpr double drop_of_a_snap = 0.3;     // [1] of the energy

std::string required_text(const fs::path& path) {
  if (auto text = read_file(path)) return *text;
  throw Error(ErrorCode::command, path.string(), "There is no such file, or it cannot be read.",
              "Name the output folder of a bake with cache and certificate.");
}

/// One baked sheet, as a shot whose handles are where they were held.
struct BakedSheet {
  std::string name;
  double side;  // [m]
  Shot shot;
  std::vector<FrameRecord> frames;
  std::map<int, std::vector<HeldHandle>> held;  // by frame
};

Sheet as_sheet(const CacheFrame& frame, double side) {
  Sheet sheet;
  sheet.pattern = side * frame.uv;
  sheet.x = frame.x;
  sheet.v = Points3::Zero(frame.x.rows(), 3);
  sheet.triangles = frame.triangles;
  return sheet;
}

/// [J] A sheet that stores less is flat, as far as its energy tells: about what it takes to bend it
/// by a thousandth of a radian.
double energy_of_flat(const BakedSheet& sheet) { return 1e-6 * sheet.shot.paper.bending_stiffness; }

/// Why the estimate of a frame is uncertain; empty: it is not. Where the stored energy falls by
/// more than 30 % within a frame, the sheet snaps, and a simulation that snaps one frame later has
/// another shape there.
std::string doubt(const BakedSheet& sheet, std::size_t at) {
  const auto energy = [&](std::size_t k) { return sheet.frames[k].statistics.energy; };
  const FrameRecord& now = sheet.frames[at];
  for (std::size_t k = 1; k < sheet.frames.size(); ++k)
    if (std::abs(sheet.frames[k].frame - now.frame) <= about_a_snap &&
        energy(k - 1) > energy_of_flat(sheet) && energy(k) < (1 - drop_of_a_snap) * energy(k - 1))
      return fmt::format(
          "the energy falls by {:.0f} % at frame {}: the timing of a snap is uncertain",
          100 * (1 - energy(k) / energy(k - 1)), sheet.frames[k].frame);
  if (now.statistics.touching_others > 0)
    return "the sheet touches another, which the estimate does not feel";
  return now.statistics.touching > 0 ? "the sheet touches itself, which the estimate does not feel"
                                     : "";
}

class Estimator {
 public:
  Estimator(const BakedSheet& sheet, const LockedJob& job)
      : sheet_(sheet),
        options_(options_of(job)),
        dt_(1 / job.fps),
        fine_(sheet.shot, options_, fine),
        coarse_(sheet.shot, options_, probing) {}

  ErrorEstimate operator()(std::size_t at, const Sheet& baked) {
    const FrameRecord& now = sheet_.frames[at];
    const double energy = now.statistics.energy;
    ErrorEstimate e;
    e.frame = now.frame;
    e.sheet = sheet_.name;
    if (now.statistics.inertia || now.statistics.on_colliders > 0) {
      e.rms_pct = e.energy_loss_pct = NAN;
      e.uncertain = now.statistics.inertia
                        ? "the sheet moves with inertia, and an estimate is of a sheet at rest"
                        : "the sheet lies on a collider, which is not in the files";
      return e;
    }
    const auto found = sheet_.held.find(now.frame);
    const std::vector<HeldHandle> held =
        found == sheet_.held.end() ? std::vector<HeldHandle>{} : found->second;
    const Polished polished = fine_(baked, held);
    e.rms_pct = 100 * polished.moved / sheet_.side;
    e.energy_loss_pct =
        energy > energy_of_flat(sheet_) ? 100 * (1 - polished.energy / energy) : NAN;
    e.uncertain = doubt(sheet_, at);
    if (e.uncertain.empty() &&
        polished.energy > of_another_paper * std::max(energy, energy_of_flat(sheet_)))
      e.uncertain = "paper that has yielded stores less, and what it keeps is not in the files";
    if (e.uncertain.empty() && !polished.converged)
      e.uncertain = "the finer mesh did not come to rest";
    if (e.uncertain.empty() && polished.near_itself)
      e.uncertain = "the sheet comes near itself, which the estimate does not feel";
    if (e.uncertain.empty()) e.lower_branch_pct = lower_branch(baked, held, now.frame);
    return e;
  }

 private:
  static ElasticOptions options_of(const LockedJob& job) {
    ElasticOptions options;
    options.forces.gravity = job.gravity;
    options.stop = job.stop;
    return options;
  }

  /// On a coarser mesh: a branch that is lower there is lower.
  double lower_branch(const Sheet& baked, const std::vector<HeldHandle>& held, int frame) {
    Polished relaxed = coarse_(baked, held);
    if (!relaxed.converged) return 0;
    Elastic elastic(sheet_.shot.paper, options_);
    elastic.set_mesh(relaxed.sheet, coarse_.mesh().stiffening);
    const BranchSearch found = probe_branches(
        relaxed.sheet, elastic, {coarse_.constraints_of(held)}, {dt_, 0, frame, waves});
    return found.taken ? 100 * (found.before - found.after) / std::abs(found.before) : 0;
  }

  const BakedSheet& sheet_;
  ElasticOptions options_;
  double dt_;  // [s] of a frame
  Polisher fine_, coarse_;
};

/// The sheets of the certificate, with the outline and the handles that the files tell of.
std::vector<BakedSheet> read_sheets(const fs::path& folder, const Json& summary,
                                    const AlembicReader& cache, const LockedJob& job) {
  std::vector<BakedSheet> sheets;
  std::map<std::string, std::size_t> number;
  for (const Json& certified : summary.at("sheets")) {
    BakedSheet sheet;
    sheet.name = certified.at("name");
    sheet.side =
        std::max(certified.at("width_m").get<double>(), certified.at("height_m").get<double>());
    sheet.shot.sheet_name = sheet.name;
    if (const auto paper = job.papers.find(sheet.name); paper != job.papers.end())
      sheet.shot.paper = paper->second;
    const CacheFrame first = cache.frame(sheets.size(), 0);
    if (first.triangles.rows() == 0 || first.uv.rows() == 0)
      throw Error(ErrorCode::command, fmt::format("{}, sheet \"{}\"", folder.string(), sheet.name),
                  "Its first frame in the cache has no faces or no uv.", "Bake again.");
    sheet.shot.start = as_sheet(first, sheet.side);
    sheet.shot.pattern =
        pattern_of(sheet.shot.start.pattern, sheet.shot.start.triangles, folder.string());
    number[sheet.name] = sheets.size();
    sheets.push_back(std::move(sheet));
  }
  std::map<std::pair<std::size_t, std::string>, int> handle_number;
  for (const HandleRecord& record : parse_handles_csv(required_text(folder / "cert/handles.csv"))) {
    const std::size_t s = number.at(record.sheet);
    const auto [at, is_new] = handle_number.try_emplace(
        {s, record.handle}, static_cast<int>(sheets[s].shot.handles.size()));
    if (is_new) {
      Handle handle;
      handle.name = record.handle;
      handle.pattern = record.pattern;
      handle.keyed = record.held.transpose();
      sheets[s].shot.handles.push_back(std::move(handle));
    }
    if (record.state != HandleFrame::free)
      sheets[s].held[record.frame].push_back({at->second, record.held});
  }
  const std::string lines = read_file(folder / "cert/frames.jsonl").value_or("");
  for (std::optional<FrameRecord>& record : parse_frame_lines(lines)) {
    if (!record) throw Damage("a line of cert/frames.jsonl is not one of this version");
    std::vector<FrameRecord>& frames = sheets[number.at(record->sheet)].frames;
    frames.push_back(std::move(*record));
  }
  return sheets;
}

/// The same; a sheet or handle that only one of the files knows is an error with a place.
std::vector<BakedSheet> sheets_of(const fs::path& folder, const Json& summary,
                                  const AlembicReader& cache, const LockedJob& job) try {
  return read_sheets(folder, summary, cache, job);
} catch (const Error&) {
  throw;
} catch (const std::exception& error) {
  throw Error(ErrorCode::command, (folder / "cert").string(),
              fmt::format("The certificate is not that of the cache ({}).", error.what()),
              "Bake again.");
}

}  // namespace

ErrorEstimates estimate_errors(const fs::path& folder) {
  std::string cache_file;
  Json summary;
  try {
    summary = parse_json(required_text(folder / "cert/summary.json"));
    for (const auto& [file, hash] : summary.at("files").items())
      if (fs::path(file).extension() == ".abc") cache_file = file;
  } catch (const Json::exception&) {
    throw Error(ErrorCode::command, (folder / "cert/summary.json").string(),
                "It is not a certificate that this version writes.");
  }
  if (const Json inertia = summary.value(Json::json_pointer("/models/dynamics"), Json::object());
      inertia.value("on", false))
    throw Error(ErrorCode::command, folder.string(),
                "It moves with inertia (" + inertia.value("why", "") +
                    "), and an estimate is of a sheet at rest.",
                "Bake with --dynamics off, or see with paperbake chart how far the methods are "
                "from each other.");
  if (cache_file.empty())
    throw Error(ErrorCode::command, folder.string(), "There is no cache to estimate.",
                "Bake with --formats abc,cert.");
  const LockedJob job = read_lock(folder / "job.lock.toml");
  const AlembicReader cache(folder / cache_file);
  const double start_ms = cpu_ms();
  ErrorEstimates all;
  std::size_t frames = 0;
  const std::vector<BakedSheet> sheets = sheets_of(folder, summary, cache, job);
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    const BakedSheet& sheet = sheets[s];
    Estimator estimate(sheet, job);
    for (std::size_t k = 0; k < sheet.frames.size(); ++k)
      if ((k + 1) % every == 0 || k + 1 == sheet.frames.size())
        all.frames.push_back(estimate(k, as_sheet(cache.frame(s, k), sheet.side)));
    frames += sheet.frames.size();
  }
  all.ms_per_frame = (cpu_ms() - start_ms) / std::max<std::size_t>(1, frames);
  return all;
}

std::string estimates_text(const ErrorEstimates& all) {
  std::string text = "Error within the branch that the sheet is on (rms, % of the longer side):\n";
  for (const ErrorEstimate& e : all.frames) {
    text += fmt::format("  frame {}, \"{}\": ", e.frame, e.sheet);
    if (std::isnan(e.rms_pct)) {
      text += "none: " + e.uncertain + "\n";
      continue;
    }
    text += fmt::format("{:.3f} %", e.rms_pct);
    if (!std::isnan(e.energy_loss_pct))
      text += fmt::format(", energy {:+.1f} %", -e.energy_loss_pct);
    if (e.lower_branch_pct > 0)
      text += fmt::format("; another shape under the same handles has {:.0f} % less energy",
                          e.lower_branch_pct);
    if (!e.uncertain.empty()) text += "; uncertain: " + e.uncertain;
    text += "\n";
  }
  return text + fmt::format("{:.1f} ms a frame of the shot.\n", all.ms_per_frame);
}

}  // namespace paperbake
