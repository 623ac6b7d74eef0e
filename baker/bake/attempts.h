#pragma once

#include "baker/bake/bend_watch.h"
#include "baker/bake/candidate.h"
#include "baker/output/progress.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

using Candidates = std::vector<std::unique_ptr<Candidate>>;

/// Attempts at a shot. Flat paper that is compressed may buckle in several ways, its imperfection
/// decides in which, and from some of them it never comes to where the handles want it. What an
/// artist would do then is to bake again with another seed, or on a finer mesh. This does it for
/// them: the first attempt is baked as it is simulated, and only when a handle is off by more than
/// the gate of handles allows, others are simulated beside it. The attempt whose handles have been
/// off least so far always goes on (uniform-cost search), until one of them is at the end of the
/// shot: it is the best of them. When all attempts are off by a tenth of the sheet it is not a
/// matter of luck, and the first one is baked. Nor is it where nothing has moved, neither handles
/// nor colliders, or where handles are keyed out of reach, so that the shot misses its gate
/// whichever is baked. Where only colliders have moved, there are two others at most, on twice and
/// on four times as many triangles: what they push away they push away with most seeds, but paper
/// may crumple under them only because its mesh is too coarse to bend. Depth inside a collider
/// counts as much as a handle that misses its gate as many times (worst_miss).
///
/// A mesh may also be too coarse for the bends of a shot: a sheet gets singular points only because
/// of that, or it stays smooth and is angular, or off (BendWatch). Where all handles hold, no
/// collider is in the paper and the mesh may be too coarse, the shot is simulated once more on a
/// first mesh of four times as many triangles, with the seed of the bake. That attempt ends when a
/// sheet crumples there, or gets as many singular points as the sheet that had most in the first
/// attempt, if there were any. If it ends so, or loses a handle, or gets to the end with singular
/// points or creases that nobody made, a third attempt has eight times as many triangles as the
/// first one. Baked is the first of them with which nothing is wrong; else the finest that has a
/// reason to be doubted, but none to be given up; else the first attempt. A shot whose first mesh a
/// rehearsal has made finer is not doubted in this way. Nor is one that is baked in part: its
/// frames would depend on which part that is, and a message says that the whole shot may come out
/// otherwise.
///
/// The attempts for handles that are off are: the seed of the bake; that seed plus 1000, 2000,
/// 3000, ... The second, the fourth and so on have a first mesh of twice as many triangles, the
/// third, the fifth and so on of four times as many, unless a number of triangles was asked for. If
/// a rehearsal has doubled the mesh of the first one, that is what they are multiples of. Where
/// only colliders move it is not: what these push through a sheet that is held is seldom a matter
/// of its mesh, and the attempts would cost much. If handles move and the best of them holds them,
/// but crumples, that may be what holds them. So where more than two are allowed, there is another
/// one with the seed of the bake and eight times as many triangles. It is simulated as far as one
/// of a mesh that is doubted would be (see above), and is baked if it gets to the end.
///
/// source  this project
class Attempts {
 public:
  /// state  folder that keeps what was chosen and simulated, for a bake that is stopped and goes on
  Attempts(const BakeSettings&, const BakePlan&, std::filesystem::path state);

  /// Of the attempt that is to be baked.
  const BakePlan& plan() const { return plan_; }

  /// Looks at a frame that is recorded.
  void watch(const AnimatedFrame&);
  /// Whether what was recorded shows that handles do not hold: it need not be recorded to its end.
  bool is_failing() const { return failing_; }
  /// Whether others have to be tried: it fails, or all of it is recorded and its mesh may have been
  /// too coarse.
  bool is_doubtful() const;
  /// What to say of the part of a shot that is recorded, if the whole shot would be tried on a
  /// finer mesh because of it; else empty.
  std::string caution() const;
  /// The last frame that was looked at.
  int last_seen_frame() const { return first_.animation.first_frame + seen_.frames - 1; }

  /// Whether this bake has chosen, so that frames which it takes are its own.
  bool has_chosen() const { return has_chosen_; }

  /// How much of the attempt that was chosen is recorded.
  enum class Recorded { nothing, first_frames, everything };
  Recorded recorded() const { return recorded_; }

  /// Tries others, and chooses among them all. What was simulated of the chosen one are the
  /// checkpoints of the bake afterwards.
  /// returns  false when it was stopped
  bool choose(Progress&, StopRequest&, StageClock&);

 private:
  BakePlan plan_of(std::size_t attempt) const;
  BakeSettings settings_of(std::size_t attempt) const;
  Attempt describe_attempt(std::size_t attempt) const;
  bool is_coarse() const;
  bool is_mesh_doubted() const;
  void adopt(AttemptChoice);
  std::string key() const;
  bool load_choice();
  void keep_choice(const AttemptChoice&) const;
  std::filesystem::path folder_of(std::size_t attempt) const;
  /// reason  by which it is judged, which need not be why others are tried (reason_)
  std::unique_ptr<Candidate> make_candidate(std::size_t number, AttemptReason, StopRequest&,
                                            StageClock&) const;
  /// Simulates the best of all so far until it is over or hopeless, and forgets those that were
  /// never the best.
  /// before   how many others were tried before these
  /// returns  false when it was stopped
  bool search(Candidates& all, std::size_t before, Progress&, StopRequest&, StageClock&) const;
  /// Whether the best of all holds its handles, but crumples, and might not on a finer mesh.
  bool is_crumple_doubted(const Attempt& best) const;
  /// Lets the bake go on from what was simulated of the chosen one.
  void take_over(const AttemptChoice&);
  std::size_t most_attempts() const;  // the first one counted
  std::string why_tried(const Candidate& last) const;
  /// How far an attempt may be pulled off its handles where they are not the reason. [m]
  double allowed_pull() const;
  /// Whether a mesh has to be made finer still than that of the last of so many attempts.
  bool may_need_another(const Candidate& last, std::size_t tried) const;
  void remove_attempts() const;

  const BakeSettings& settings_;
  const BakePlan& first_;
  BakePlan plan_;
  std::filesystem::path state_, decision_;
  Attempt seen_;                                      // of the first attempt
  std::vector<BendWatch> bends_;                      // of its sheets
  AttemptReason reason_ = AttemptReason::handle_off;  // why others than the first are tried
  bool watches_, failing_ = false, has_chosen_ = false;
  // how often the number of triangles was doubled before a sheet of the first attempt began: by a
  // rehearsal, which knows finer meshes, too, or as that of a flag
  int doublings_at_start_ = 0;
  int doublings_ = 0;  // with which the meshes of the other attempts begin
  Recorded recorded_ = Recorded::nothing;
  bool handles_moved_ = false, colliders_moved_ = false;  // whether any has (have_moved)
};

/// The number of the attempt that there may be when the best of those for handles crumples: beyond
/// those of all others.
constexpr std::size_t attempt_on_finest_mesh = 16;

/// How many times as many triangles as asked for the first mesh of an attempt has. Sheets that lock
/// on the mesh of the first attempt do so less often on twice as fine a one, and some only on a
/// still finer one not at all. A mesh that is doubted becomes finer until it is not.
/// doublings  of the mesh with which the first attempt began: what locks on it would also lock on
///            coarser ones
int refinement(std::size_t attempt, AttemptReason, int doublings);

/// Whether any handle is keyed farther from where it was in the first frame than the gate of
/// handles allows it to be off.
/// row  frame - first frame of the scene
bool have_moved(const std::vector<Handle>&, int row);
/// The same of colliders.
bool have_moved(const Colliders&, int row);

}  // namespace paperbake
