#include "baker/output/checkpoints.h"

#include "baker/job/input_hash.h"
#include "baker/job/version.h"
#include "baker/output/file_hash.h"
#include "core/model/serializer.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/frame_statistics_table.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

namespace fs = std::filesystem;

static void archive(Serializer& a, HandleFrame& h) {
  a(h.state, h.keyed, h.at);
  a.require(h.state >= HandleFrame::free && h.state <= HandleFrame::jammed);
}

static void archive(Serializer& a, FrameStatistics& s) {
  visit_frame_statistics([&](const auto& field) {
    if (auto* value = find_statistic(s, field)) a(*value);  // nothing is rendered yet
  });
}

namespace {

struct Checkpoint {
  // program_key, BakePlan::simulation_hash, hash of the input of all frames until keys_until
  std::string program, start, input;
  int first = 0, last = 0, keys_until = 0;
  std::vector<std::string> frames;  // as Checkpoints::waiting_
  std::vector<std::string> states;

  void archive(Serializer& a) {
    std::string kind = "paperbake checkpoint";
    a(kind, program, start, input, first, last, keys_until, frames, states);
  }
};

constexpr int most_frames = 1 << 20;  // of a shot, and of those that it looks ahead to

std::string seal_of(std::string_view bytes) { return hex(content_hash(bytes)); }

/// throws Error(ErrorCode::scene): cut short, or not what was written
Checkpoint read_checkpoint(const fs::path& path) {
  const std::string bytes = read_file(path).value_or("");
  const std::size_t seal = seal_of("").size(), size = bytes.size() - std::min(bytes.size(), seal);
  Serializer a(std::string_view(bytes).substr(0, size));
  a.require(seal_of(std::string_view(bytes).substr(0, size)) ==
            std::string_view(bytes).substr(size));
  Checkpoint checkpoint;
  a(checkpoint);
  a.end();
  return checkpoint;
}

/// Do two sheets of one mesh move, and have they moved, alike?
bool same_bytes(const Sheet& now, const Sheet& before) {
  const auto bytes = [](Sheet sheet) {
    Serializer a;
    archive_moving(a, sheet);
    return a.bytes();
  };
  return same_entries(now.x, before.x) && bytes(now) == bytes(before);
}

/// All that is handed on of a sheet in a frame. mesh: of the frame before in the same checkpoint;
/// its own afterwards
void archive_frame(Serializer& a, AnimatedFrame& f, Sheet& now, Sheet& mesh) {
  a(f.frame, f.sheet_index, f.handles, f.statistics, f.plastic_curvature, f.parts.rulings,
    f.parts.region, f.note);
  bool as_before = !a.reads() && same_entries(now.pattern, mesh.pattern) &&
                   same_entries(now.triangles, mesh.triangles);
  a(as_before);
  if (!as_before)
    archive_mesh(a, now);
  else if (a.reads())
    now = mesh;
  bool rests = !a.reads() && as_before && same_bytes(now, mesh);
  a(rests);
  if (!rests)
    archive_moving(a, now);
  else if (a.reads())
    now = mesh;
  mesh = now;
  a(f.carried);
}

/// The checkpoints in a folder, in order; those that were being written when a bake ended, too.
std::vector<fs::path> checkpoints_in(const fs::path& folder) {
  std::vector<fs::path> found;
  const std::string begin = "checkpoint.";
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename();
        name.rfind(begin, 0) == 0 && name.find('.', begin.size()) >= begin.size() + 6)
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

void move_checkpoints(const fs::path& from, const fs::path& to) {
  std::error_code none;
  for (const fs::path& old : checkpoints_in(to)) fs::remove(old, none);
  for (const fs::path& own : checkpoints_in(from)) fs::rename(own, to / own.filename(), none);
}

const std::string& program_key() {
  static const std::string key = std::string(program_version) + " " + file_hash("/proc/self/exe");
  return key;
}

Checkpoints::Checkpoints(fs::path folder, const BakePlan& plan, int every, Reuse reuse)
    : folder_(std::move(folder)),
      plan_(plan),
      sheets_(plan.shots.size()),
      every_(every),
      reuse_(reuse),
      start_(plan.simulation_hash),
      first_frame_(plan.animation.first_frame),
      kept_until_(first_frame_ - 1),
      keys_until_(first_frame_),
      states_(sheets_),
      kept_at_(std::chrono::steady_clock::now()) {
  // polished frames depend on those after them
  if (plan.polish.triangles > 0)
    start_ += fmt::format(" polished {} {}", plan.polish.triangles, plan.animation.last_frame);
}

fs::path Checkpoints::file(int frames) const {
  return folder_ / fmt::format("checkpoint.{:06}", frames);
}

const std::string& Checkpoints::input_until(int frame) {
  for (int f = first_frame_ + static_cast<int>(inputs_.size()); f <= frame; ++f)
    inputs_.push_back(frame_input_hash(f == first_frame_ ? start_ : inputs_.back(), plan_, f));
  return inputs_[frame - first_frame_];
}

Checkpoints::ResumePoint Checkpoints::load(
    const std::function<bool(const AnimatedFrame&)>& on_frame) {
  if (reuse_ == Reuse::any_of_them) return load_chain(on_frame);
  ResumePoint all = load_chain([](const AnimatedFrame&) { return true; });
  kept_until_ = keys_until_ = first_frame_ - 1;
  if (all.last_frame == plan_.animation.last_frame) return load_chain(on_frame);
  return {kept_until_, {}, all.damaged};
}

Checkpoints::ResumePoint Checkpoints::load_chain(
    const std::function<bool(const AnimatedFrame&)>& on_frame) {
  ResumePoint resume{kept_until_, {}, ""};
  bool goes_on = true;
  for (const fs::path& path : checkpoints_in(folder_)) {
    if (path.extension() == ".part") continue;
    try {
      load_one(path, resume, goes_on, on_frame);
    } catch (const std::exception&) {  // of a file that is none, too
      resume.damaged = fmt::format("{} is damaged: the frames after {} are simulated again.",
                                   path.string(), kept_until_);
      goes_on = false;
    }
    if (!goes_on || kept_until_ >= plan_.animation.last_frame) break;
  }
  return resume;
}

/// goes_on  becomes false where no more is to be loaded
void Checkpoints::load_one(const fs::path& path, ResumePoint& resume, bool& goes_on,
                           const std::function<bool(const AnimatedFrame&)>& on_frame) {
  Checkpoint checkpoint = read_checkpoint(path);
  goes_on = checkpoint.program == program_key() && checkpoint.start == start_ &&
            checkpoint.first == kept_until_ + 1;
  if (!goes_on) return;
  Serializer().require(checkpoint.last >= checkpoint.first &&
                       checkpoint.keys_until >= checkpoint.last &&
                       long(checkpoint.keys_until) - first_frame_ < most_frames);
  const std::size_t count = checkpoint.frames.size();
  Serializer().require(count > 0 && count == sheets_ * (checkpoint.last - kept_until_) &&
                       checkpoint.states.size() == sheets_);
  goes_on = checkpoint.input == input_until(checkpoint.keys_until);
  if (!goes_on) return;
  std::vector<std::pair<AnimatedFrame, Sheet>> kept(count);
  std::vector<Sheet> meshes(sheets_);
  for (std::size_t k = 0; k < count; ++k) {
    auto& [frame, sheet] = kept[k];
    const std::size_t of = k % sheets_;
    Serializer a(checkpoint.frames[k]);
    archive_frame(a, frame, sheet, meshes[of]);
    a.end();
    a.require(frame.frame == checkpoint.first + static_cast<int>(k / sheets_) &&
              frame.sheet_index == of && frame.handles.size() == plan_.shots[of].handles.size());
    a.require(frame.plastic_curvature.rows() == 0 ||
              frame.plastic_curvature.rows() == sheet.x.rows());
    a.require(frame.carried.rows() == 0 || frame.carried.rows() == sheet.x.rows());
    a.require(frame.parts.region.empty() ||
              static_cast<long>(frame.parts.region.size()) == sheet.triangles.rows());
  }
  kept_until_ = checkpoint.last;
  keys_until_ = checkpoint.keys_until;
  resume.states = std::move(checkpoint.states);
  std::error_code none;
  if (path == current()) fs::rename(path, file(kept_until_ - first_frame_ + 1), none);
  for (auto& [frame, sheet] : kept) {
    if (frame.frame > plan_.animation.last_frame) break;
    frame.sheet = &sheet;
    resume.last_frame = frame.frame;
    goes_on = on_frame(frame);
    if (!goes_on) return;
  }
}

void Checkpoints::add(const AnimatedFrame& frame) {
  if (!removed_outdated_) {  // what comes after this frame is no longer what comes after it
    std::error_code none;
    for (const fs::path& old : checkpoints_in(folder_))
      if (old.filename() > file(kept_until_ - first_frame_ + 1).filename()) fs::remove(old, none);
    removed_outdated_ = true;
  }
  AnimatedFrame copy = frame;
  Sheet sheet = *frame.sheet;
  if (waiting_.empty()) meshes_.assign(sheets_, {});
  Serializer a;
  archive_frame(a, copy, sheet, meshes_[frame.sheet_index]);
  waiting_.push_back(a.bytes());
  states_[frame.sheet_index] = frame.state;
  keys_until_ = std::max({keys_until_, frame.frame, frame.keys_until});
  if (frame.sheet_index + 1 < sheets_) return;
  constexpr std::chrono::milliseconds often(20);
  constexpr int as_long = 20;  // times what it takes to keep them
  if ((frame.frame - first_frame_ + 1) % every_ == 0 || frame.frame == plan_.animation.last_frame)
    keep(frame.frame);
  else if (std::chrono::steady_clock::now() - kept_at_ >
           std::max<std::chrono::steady_clock::duration>(often, as_long * keeping_takes_))
    keep_current(frame.frame);
}

/// A checkpoint after this frame, which was added last.
std::string Checkpoints::bytes_until(int frame, std::vector<std::string> frames) {
  Checkpoint checkpoint{program_key(), start_,      input_until(keys_until_), kept_until_ + 1,
                        frame,         keys_until_, std::move(frames),        {}};
  for (const auto& state : states_) checkpoint.states.push_back(state ? state() : "");
  Serializer a;
  a(checkpoint);
  return a.bytes() + seal_of(a.bytes());
}

void Checkpoints::keep_current(int frame) {
  const auto begin = std::chrono::steady_clock::now();
  try {
    write_quickly(current(), bytes_until(frame, waiting_));
  } catch (const Error&) {
    // the next one that is kept for good says why
  }
  kept_at_ = std::chrono::steady_clock::now();
  keeping_takes_ = kept_at_ - begin;
}

void Checkpoints::keep(int frame) {
  if (waiting_.empty()) return;
  const std::string bytes = bytes_until(frame, waiting_);
  try {
    write_atomically(file(frame - first_frame_ + 1), bytes);
    kept_until_ = frame;
    failure_.clear();
    waiting_.clear();
    std::error_code none;
    fs::remove(current(), none);
  } catch (const Error& error) {
    failure_ = error.cause;
  }
  kept_at_ = std::chrono::steady_clock::now();
}

}  // namespace paperbake
