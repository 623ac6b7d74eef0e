#pragma once

#include "core/methods/method.h"
#include "core/model/frame.h"
#include "core/model/shot.h"
#include "core/step1_elastic/elastic.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// Does paper keep what it was bent to?
enum class Memory { none, plastic };

struct AnimateOptions {
  ElasticOptions elastic;
  double fps = 24;  // [1/s]
  int first_frame = 1, last_frame = 1;
  unsigned seed = 0;  // of the ripple that lets a flat sheet buckle
  // plastic: beyond the yield strain of the grade, on the pattern, for ever
  Memory memory = Memory::none;
  bool report_plastic_curvature = false;  // hand on AnimatedFrame::plastic_curvature
  // [frames] from one search for another branch (branch_search.h) to the next; 0: none
  int probe_every = 0;
  // AnimatedFrame::state of this shot, method and options: the frames after that one, as they would
  // have been; empty: all
  std::string go_on_from;
};

/// The loop over frames: handles -> step 1 -> method -> frame. Handle points and the rims of their
/// discs are vertices of the first mesh. A step that fails is taken in halves, down to 1/256 of a
/// frame; one in which a flat sheet is pushed together in halves to 1/8: where it bends to is to be
/// its way's affair, not the step's or the mesh's. With inertia no step is longer than 1/96 s:
/// backward Euler damps, and at 1/24 s a pendulum of 20 cm would lose half its swing on the way to
/// the other side.
///
/// on_frame  called for every frame in order; returns false to stop
/// throws    Error(Fault::simulation) when the sheet cannot follow its handles into the first frame
///           (in a later one it stays as it was, and the note says so) or has no finite energy;
///           frames handed out before stay good; Error(Fault::scene) when go_on_from is no state of
///           this shot
/// source    the loop of [Schreck 2015], section 2
void animate(const Shot&, const Method&, const AnimateOptions&,
             const std::function<bool(const AnimatedFrame&)>& on_frame);

/// One of several sheets that are animated together. With methods and options of its own; frames,
/// rate and elastic options are those of all.
struct AnimatedSheet {
  const Shot& shot;
  const Method& method;
  const AnimateOptions& options;
};

/// The same of several sheets, frame by frame. In a frame in which they stay out of each other's
/// reach, each goes its way as if it were alone, to the last bit; those that come within reach of
/// each other take the frame together (Elastic::step_together). Two sheets have one reach d^
/// between them: the smaller of theirs; where they begin nearer to each other, 0.9 x that distance,
/// and as they part, as much. Sheets that begin on each other, crossed or joined at a border, have
/// a tenth of it, and where they do, none (self_contact.h); of which half does, none at all until
/// they are apart.
///
/// on_frame  called for every frame in order, and of it for every sheet in order
/// source    this project
void animate_together(const std::vector<AnimatedSheet>&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);

}  // namespace paperbake
