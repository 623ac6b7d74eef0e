#include "baker/check/verify.h"

#include "baker/output/cache_judge.h"
#include "baker/output/file_hash.h"
#include "baker/output/sheet_intersections.h"
#include "core/model/error.h"
#include "formats/cache/alembic_reader.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/certificate.h"
#include "formats/files/collider_record.h"
#include "formats/files/frame_statistics_table.h"
#include "formats/files/json.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

constexpr double tolerance_mm = 1e-3;  // of a handle, beside what 32-bit positions round off

/// One look at one folder.
class Verifier {
 public:
  explicit Verifier(fs::path folder) : folder_(std::move(folder)) {}

  Verification run() {
    const std::string text = read("cert/summary.json");
    if (text.empty()) return std::move(result_);
    if (!seal_holds(text))
      differs({}, "cert/summary.json", "The summary is not as it was written.");
    const std::optional<Json> parsed = try_parse_json(text);
    if (!parsed) {
      differs({}, "cert/summary.json", "The summary is no JSON.");
      return std::move(result_);
    }
    const Json& summary = *parsed;
    try {
      compare_hashes(summary.at("files"));
      if (const std::string cache = cache_of(summary); !cache.empty())
        compare_frames(cache, summary);
      else if (!has_other_cache(summary))
        differs({}, "cert/summary.json",
                "The bake has no cache: nothing is handed on that could be verified. Bake with abc "
                "among its --formats.");
    } catch (const Json::exception& error) {
      differs(
          {}, "cert",
          fmt::format("The certificate is not one that this version writes ({}).", error.what()));
    }
    std::stable_sort(result_.differences.begin(), result_.differences.end(),
                     [](const Difference& a, const Difference& b) {
                       return a.frame && (!b.frame || *a.frame < *b.frame);
                     });
    return std::move(result_);
  }

 private:
  using HandlesOfFrames = std::map<std::pair<int, std::string>, std::vector<HandleRecord>>;

  void differs(std::optional<int> frame, const std::string& file, std::string what) {
    result_.differences.push_back({frame, file, std::move(what)});
  }

  /// Empty, and a difference, when there is no such file.
  std::string read(const std::string& file) {
    try {
      return read_output(folder_ / file);
    } catch (const Error& error) {
      differs({}, file, error.cause);
      return {};
    }
  }

  void compare_hashes(const Json& files) {
    for (const auto& [file, hash] : files.items()) {
      ++result_.files;
      std::error_code none;
      if (!fs::is_regular_file(folder_ / file, none)) {
        differs({}, file, "The file is missing.");
        continue;
      }
      try {
        if (file_hash(folder_ / file) != hash.get<std::string>())
          differs({}, file, "Its bytes are not those that were written.");
      } catch (const Error& error) {
        differs({}, file, error.cause);
      }
    }
    ++result_.files;  // the summary
  }

  static std::string cache_of(const Json& summary) {
    for (const auto& [file, hash] : summary.at("files").items())
      if (fs::path(file).extension() == ".abc") return file;
    return {};
  }

  /// A cache that only the bake itself has measured; its bytes are those that were written.
  static bool has_other_cache(const Json& summary) {
    const Json& files = summary.at("files");
    return summary.at("failure").is_null() &&
           std::any_of(files.items().begin(), files.items().end(), [](const auto& file) {
             const std::string extension = fs::path(file.key()).extension().string();
             return extension == ".usda" || extension == ".usdc" || extension == ".pc2";
           });
  }

  void compare_frames(const std::string& file, const Json& summary) {
    std::optional<AlembicReader> cache;
    try {
      cache.emplace(folder_ / file);
    } catch (const Error& error) {
      differs({}, file, error.cause);
      return;
    }
    const HandlesOfFrames handles = read_handles();
    if (summary.at("files").contains("cert/colliders.json")) read_colliders();
    std::map<std::string, std::size_t> sheet_number;
    std::vector<double> longer_side;
    for (const Json& sheet : summary.at("sheets")) {
      sheet_number[sheet.at("name")] = longer_side.size();
      longer_side.push_back(
          std::max(sheet.at("width_m").get<double>(), sheet.at("height_m").get<double>()));
    }
    // fewer: the first ones, of a bake that failed
    if (cache->sheets().size() > longer_side.size())
      return differs({}, file, "It does not hold the sheets of the certificate.");
    std::vector<std::size_t> seen(longer_side.size(), 0);
    for (const auto& record : parse_frame_lines(read("cert/frames.jsonl"))) {
      if (!record || !sheet_number.count(record->sheet)) {
        differs({}, "cert/frames.jsonl", "A line of it is not one that was written.");
        continue;
      }
      ++result_.frames;
      if (record->content_hash.empty()) continue;  // the line says that the cache lacks the frame
      const std::size_t sheet = sheet_number[record->sheet], i = seen[sheet]++;
      if (sheet >= cache->sheets().size() || i >= cache->sheets()[sheet].frames) {
        differs(record->frame, file, "The frame is missing.");
        continue;
      }
      try {
        const CacheFrame stored = cache->frame(sheet, i);
        if (cache->content_hash(sheet, i) != record->content_hash)
          differs(record->frame, file,
                  "content_hash: the positions are not those that were written.");
        compare_frame(file, stored, longer_side[sheet], *record, handles);
      } catch (const Error& error) {
        differs(record->frame, file, error.cause);
      }
    }
    for (std::size_t s = 0; s < cache->sheets().size(); ++s)
      if (seen[s] < cache->sheets()[s].frames)
        differs({}, "cert/frames.jsonl",
                fmt::format("It has {} frames of sheet \"{}\", the cache {}.", seen[s],
                            cache->sheets()[s].name, cache->sheets()[s].frames));
  }

  void compare_frame(const std::string& file, const CacheFrame& stored, double longer_side,
                     const FrameRecord& record, const HandlesOfFrames& handles) {
    if (stored.x.rows() == 0 || stored.uv.rows() == 0)
      return differs(record.frame, file, "It has no points or no uv: nothing can be measured.");
    const CacheJudge& judge = judge_of(record.sheet, stored, longer_side);
    const Judgement judgement = judge(stored.x, record.frame - colliders_.first_frame);
    FrameStatistics found;
    found.render = statistics_of(judgement, judge);
    if (frame_ != record.frame) beside_ = {};
    frame_ = record.frame;
    found.render->crossings_with_others =
        beside_.add(record.frame, Sheet{{}, stored.x, {}, stored.triangles, {}});
    found.inside = judgement.inside;
    if (const auto rows = handles.find({record.frame, record.sheet}); rows != handles.end())
      found.handle_error_max = compare_handles(file, stored, judge, rows->second);
    compare_statistics(file, record, found);
  }

  /// returns  how far the worst handle is from its keyed position [m]
  double compare_handles(const std::string& file, const CacheFrame& stored, const CacheJudge& judge,
                         const std::vector<HandleRecord>& handles) {
    double worst = 0;
    for (const HandleRecord& handle : handles) {
      // where a handle that holds nothing is, only the simulation knows exactly
      if (handle.state == HandleFrame::free) continue;
      const Vector3d at = stored.x.row(judge.vertex_at(handle.pattern));
      const double rounding = std::numeric_limits<float>::epsilon() * at.norm();
      if (const double off = 1e3 * (at - handle.held).norm(); off > tolerance_mm + 1e3 * rounding)
        differs(handle.frame, file,
                fmt::format("Handle \"{}\" is {:.4g} mm from where handles.csv has it.",
                            handle.handle, off));
      if (handle.state != HandleFrame::soft) worst = std::max(worst, (at - handle.keyed).norm());
    }
    return worst;
  }

  /// The numbers that were measured anew, in the units of the certificate.
  void compare_statistics(const std::string& file, const FrameRecord& record,
                          const FrameStatistics& found) {
    visit_frame_statistics([&](const auto& field) {
      if (!field.tolerance) return;
      const double now = statistic_value(found, field).value_or(0),
                   certified = statistic_value(record.statistics, field).value_or(NAN);
      if (!(std::abs(now - certified) <= *field.tolerance))
        differs(record.frame, file,
                fmt::format("{}: the certificate says {:.6g} {}, the cache {:.6g}.", field.name,
                            certified, field.unit.symbol, now));
    });
  }

  const CacheJudge& judge_of(const std::string& sheet, const CacheFrame& stored,
                             double longer_side) {
    std::unique_ptr<CacheJudge>& judge = judges_[sheet];
    if (!judge || !judge->is_of(stored)) {
      std::shared_ptr<const JudgedColliders>& colliders = judged_colliders_[sheet];
      if (const auto own = colliders_.of_sheet.find(sheet);
          !colliders && own != colliders_.of_sheet.end())
        colliders = std::make_shared<const JudgedColliders>(own->second);
      judge = std::make_unique<CacheJudge>(stored.uv, stored.triangles, longer_side, colliders);
    }
    return *judge;
  }

  void read_colliders() {
    try {
      colliders_ = parse_collider_json(read("cert/colliders.json"));
    } catch (const Error& error) {
      differs({}, "cert/colliders.json", error.cause);
    }
  }

  HandlesOfFrames read_handles() {
    HandlesOfFrames all;
    try {
      for (HandleRecord& record : parse_handles_csv(read("cert/handles.csv")))
        all[{record.frame, record.sheet}].push_back(std::move(record));
    } catch (const Error& error) {
      differs({}, "cert/handles.csv", error.cause);
    }
    return all;
  }

  fs::path folder_;
  Verification result_;
  ColliderRecord colliders_;
  // by the names of the sheets
  std::map<std::string, std::shared_ptr<const JudgedColliders>> judged_colliders_;
  std::map<std::string, std::unique_ptr<CacheJudge>> judges_;
  SheetIntersections beside_;  // of the frame that was looked at last
  int frame_ = 0;
};

}  // namespace

Verification verify(const fs::path& folder) {
  std::error_code none;
  if (!fs::is_directory(folder, none))
    throw Error(ErrorCode::command, folder.string(), "There is no such folder.",
                "Name the output folder of a bake.");
  // a bake that lost its certificate is one that differs from it
  if (!fs::exists(folder / "cert", none) && !fs::exists(folder / "job.lock.toml", none))
    throw Error(ErrorCode::command, folder.string(), "There is no bake in this folder.",
                "Name the output folder of a bake with cert among its --formats.");
  return Verifier(folder).run();
}

std::string verification_text(const fs::path& folder, const Verification& v) {
  if (v.differences.empty())
    return fmt::format("{}: {} frames and {} files agree with the certificate.\n", folder.string(),
                       v.frames, v.files);
  std::string text = fmt::format("{}: not as the certificate says.\n", folder.string());
  constexpr std::size_t max_listed = 20;
  for (std::size_t k = 0; k < std::min(max_listed, v.differences.size()); ++k) {
    const Difference& d = v.differences[k];
    text += d.frame ? fmt::format("  frame {}, {}: {}\n", *d.frame, d.file, d.what)
                    : fmt::format("  {}: {}\n", d.file, d.what);
  }
  if (v.differences.size() > max_listed)
    text += fmt::format("  and {} more\n", v.differences.size() - max_listed);
  return text;
}

std::string verification_json(const Verification& v,
                              const std::optional<ErrorEstimates>& estimates) {
  Json differences = Json::array();
  Json first;
  for (const Difference& d : v.differences) {
    const Json frame = d.frame ? Json(*d.frame) : Json();
    if (first.is_null()) first = frame;
    differences.push_back({{"frame", frame}, {"file", d.file}, {"what", d.what}});
  }
  Json all{{"agrees", v.differences.empty()},
           {"frames", v.frames},
           {"files", v.files},
           {"first_frame_off", first},
           {"differences", differences}};
  if (estimates) {
    all["estimates"] = Json::array();
    for (const ErrorEstimate& e : estimates->frames)
      all["estimates"].push_back({{"frame", e.frame},
                                  {"sheet", e.sheet},
                                  {"rms_pct", e.rms_pct},
                                  {"energy_loss_pct", e.energy_loss_pct},
                                  {"lower_branch_pct", e.lower_branch_pct},
                                  {"uncertain", e.uncertain}});
    all["estimate_ms_per_frame"] = estimates->ms_per_frame;
  }
  return json_lines(all) + "\n";
}

}  // namespace paperbake
