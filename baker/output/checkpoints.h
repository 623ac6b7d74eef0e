#pragma once

#include "baker/job/plan.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// The program that is running, to its last byte: its version alone would let a state pass to code
/// that another compiler has made.
const std::string& program_key();

/// What of the frames of an earlier bake can be used.
enum class Reuse {
  any_of_them,  // up to some frame, from which the simulation goes on
  all_or_none,  // the simulation cannot go on from a checkpoint, but need not be repeated
};

/// What a bake keeps for a later one, in `.state/`. checkpoint.N holds the frames of all sheets
/// since the checkpoint before it and what the frame after the N-th comes from; it appears whole or
/// not at all. checkpoint.current is one that will soon be replaced: it is written every 20
/// milliseconds, or as often as takes a twentieth of the time, without waiting for the disk, so
/// that a bake that is killed loses hardly anything. The
/// program, what the simulation depends on and the input of all frames so far, and of later ones
/// that they have looked ahead to, stand at its head: one that does not go on from the one before
/// it is none.
class Checkpoints {
 public:
  /// every  frames there is one, and after the last
  Checkpoints(std::filesystem::path folder, const BakePlan&, int every, Reuse = Reuse::any_of_them);

  struct ResumePoint {
    int last_frame;                   // taken; one less than the first of the shot: none was
    std::vector<std::string> states;  // of each sheet: AnimateOptions::resume_state
    std::string damaged;  // a sentence about a checkpoint that is not used; empty: there is none
  };
  /// Hands on the frames of earlier bakes that would be simulated alike, until on_frame returns
  /// false. To be called first, if at all.
  ResumePoint load(const std::function<bool(const AnimatedFrame&)>& on_frame);

  /// The next sheet of a frame as it was simulated; after the last one, where it is due, a
  /// checkpoint is kept.
  void add(const AnimatedFrame&);
  /// Keeps one after this frame, of which all sheets were added last.
  void keep(int frame);

  /// Why the last one could not be written; empty: it was. Its frames are part of the next one.
  const std::string& failure() const { return failure_; }
  /// The last frame in a checkpoint; one less than the first of the shot: there is none.
  int kept_until() const { return kept_until_; }

 private:
  ResumePoint load_chain(const std::function<bool(const AnimatedFrame&)>& on_frame);
  void load_one(const std::filesystem::path&, ResumePoint&, bool& goes_on,
                const std::function<bool(const AnimatedFrame&)>& on_frame);
  std::string bytes_until(int frame, std::vector<std::string> frames);
  void keep_current(int frame);
  std::filesystem::path current() const { return folder_ / "checkpoint.current"; }
  std::filesystem::path file(int frames) const;
  const std::string& input_until(int frame);

  std::filesystem::path folder_;
  const BakePlan& plan_;
  std::size_t sheets_;
  int every_;
  Reuse reuse_;
  std::string start_;             // what the simulation depends on, but for the input of each frame
  int first_frame_, kept_until_;  // kept_until_: last frame in a checkpoint
  std::vector<std::string> inputs_;   // hash of all frames until the first, the second, ...
  int keys_until_;                    // AnimatedFrame::keys_until of all frames so far
  std::vector<std::string> waiting_;  // frames since, as bytes, and of each frame the sheets
  std::vector<Sheet> meshes_;         // of the last of them
  std::vector<std::function<std::string()>> states_;  // after it
  bool removed_outdated_ = false;                     // older ones are gone
  std::string failure_;
  std::chrono::steady_clock::time_point kept_at_;         // when something was written
  std::chrono::steady_clock::duration keeping_takes_{0};  // checkpoint.current
};

/// Moves the checkpoints of one folder to another, where they replace those that are there.
void move_checkpoints(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace paperbake
