#pragma once

#include "core/methods/method.h"
#include "core/model/frame.h"
#include "core/model/shot.h"
#include "core/step1_elastic/elastic.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// Whether the paper yields. off: it springs back completely; on: it keeps a permanent curvature
/// where it was bent beyond its yield strain.
enum class Plasticity { off, on };

/// Whether a sheet without inertia gets it where handles let go of it and it springs, until it has
/// come to rest (swing.h).
enum class ReleaseInertia { off, automatic };

struct AnimateOptions {
  ElasticOptions elastic;
  ReleaseInertia release_inertia = ReleaseInertia::off;
  double fps = 24;  // [1/s]
  int first_frame = 1, last_frame = 1;
  unsigned seed = 0;  // of the geometric imperfection that lets a flat sheet buckle
  // on: curvature beyond the yield strain of the paper stays for good, stored on the pattern
  Plasticity plasticity = Plasticity::off;
  bool report_plastic_curvature = false;  // fill AnimatedFrame::plastic_curvature
  // [frames] from one search for another branch (branch_search.h) to the next; 0: no search
  int probe_every = 0;
  // AnimatedFrame::state of an earlier run of the same shot, method and options. The simulation
  // continues with the frame after that one and gives the same frames as an uninterrupted run.
  // Empty: all frames.
  std::string resume_state;
  // find out how far a coarse mesh puts a smooth sheet off: FrameStatistics::mesh_error
  bool checks_mesh = false;
  // Asked before every frame of a rehearsal (rehearsal.h), which nobody sees; may be empty. What it
  // stops throws Error(ErrorCode::stopped).
  std::function<bool()> asks_to_stop;
};

/// Simulates one sheet through its shot, frame by frame: handles -> step 1 -> method -> frame.
/// Handle points and the rims of their discs are vertices of the first mesh.
///
/// A step that fails is halved, down to 1/256 of a frame, or to 1/1024 while a fast collider
/// squeezes the sheet. A frame in which a flat sheet is
/// compressed is halved down to 1/8, so that the buckling direction does not depend on step size or
/// mesh. With inertia no step is longer than 1/96 s, because backward Euler damps motion: at 1/24 s
/// a pendulum of 20 cm would lose half of its swing before it reaches the other side.
///
/// on_frame  called for every frame in order; returns false to stop
/// throws    Error(ErrorCode::simulation) when the sheet cannot follow its handles into the first
///           frame (in a later frame it stays where it was, and the note of the frame says so), or
///           when its energy is not finite; frames handed out before stay valid.
///           Error(ErrorCode::scene) when resume_state is not a state of this shot.
/// source    the loop of [Schreck 2015], section 2
void animate(const Shot&, const MethodChoice&, const AnimateOptions&,
             const std::function<bool(const AnimatedFrame&)>& on_frame);

/// One of several sheets that are animated together. Each has its own method and options, but the
/// frame range, the frame rate and the elastic options must be the same for all.
struct AnimatedSheet {
  const Shot& shot;
  const MethodChoice& method;
  const AnimateOptions& options;
};

/// Simulates several sheets, frame by frame. Sheets farther apart than the contact distance dhat
/// between them give bit-identical results to being simulated alone. Sheets that come closer within
/// a frame are solved as one system for that frame (Elastic::step_together).
///
/// The dhat of two sheets is the smaller of their own two. If they begin closer to each other than
/// that, it is 0.9 x their distance, and it grows with this distance as they move apart. Sheets
/// that touch, intersect or share a border as they begin use 0.1 dhat, and the features that touch
/// or intersect there are ignored (sheet_contact.h). If more than half of the vertices coincide,
/// the two sheets ignore each other until they have moved apart.
///
/// on_frame  called for every frame in order, and within a frame for every sheet in order
/// source    this project
void animate_together(const std::vector<AnimatedSheet>&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);

/// The same, one frame at a time: it can be left standing while something else is simulated.
class Animation {
 public:
  /// The sheets must live as long as this. throws as animate()
  explicit Animation(const std::vector<AnimatedSheet>&);
  ~Animation();

  bool is_over() const;
  /// Simulates the next frame. To be called while it is not over. throws as animate()
  /// returns  the frame of every sheet; what they point to stays valid until the next call
  std::vector<AnimatedFrame> next_frame();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace paperbake
