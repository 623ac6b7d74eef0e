#pragma once

#include "core/handles.h"
#include "core/methods/method.h"
#include "core/paper.h"
#include "core/pattern.h"
#include "core/pins.h"
#include "core/step1_elastic/elastic.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// One sheet and what is done to it.
struct Shot {
  std::string sheet_name;
  Pattern pattern;
  Sheet start;                  // a mesh of the sheet at the first frame: pattern, x, triangles
  std::vector<Handle> handles;  // row 0 of keyed = first_frame
  Paper paper;
  Pins pins = {};
  std::shared_ptr<const Colliders> colliders = nullptr;  // turned towards this sheet; null: there are none
};

/// Does paper keep what it was bent to?
enum class Memory { none, plastic };

struct AnimateOptions {
  ElasticOptions elastic;
  double fps = 24;              // [1/s]
  int first_frame = 1, last_frame = 1;
  unsigned seed = 0;            // of the ripple that lets a flat sheet buckle
  Memory memory = Memory::none; // plastic: beyond the yield strain of the grade, on the pattern, for ever
  bool show_memory = false;     // hand on AnimatedFrame::plastic_curvature
  int probe_every = 0;          // [frames] from one search for another branch (branches.h) to the next; 0: none
  std::string go_on_from;       // AnimatedFrame::state of this shot, method and options: the frames after that one, as they would have been; empty: all
};

/// A handle at one frame.
struct HandleFrame {
  enum State { free, held, jammed } state = free;  // jammed: the paper does not follow; a soft handle never is
  Vector3d keyed{0, 0, 0};      // [m] where it is asked to be; a relative handle: grab position + motion since
  Vector3d at{0, 0, 0};         // [m] where its sheet point is
};

/// One frame as it was simulated.
struct AnimatedFrame {
  int frame = 0;
  std::size_t of = 0;                    // number of the sheet among those that are animated together
  const Sheet* sheet = nullptr;          // belongs to animate; copy what is kept
  std::vector<HandleFrame> handles;      // as in Shot::handles
  double elastic_ms = 0, geometry_ms = 0;  // CPU time of this frame: step 1; everything else that touches the sheet
  int substeps = 1, newton_iterations = 0;
  bool converged = true;
  double energy = 0, membrane_energy = 0;  // [J] stored in the sheet; its stretching part
  double plastic = 0;                      // [m rad] integral of the plastic curvature over the pattern so far
  const PlasticGrid* memory = nullptr;     // what the paper keeps; belongs to animate
  Points3 plastic_curvature;               // |V|x3 [1/m] Sxx, Sxy, Syy kept at the vertices of the sheet; empty when not asked for
  bool contact = false;                    // the sheet came near itself: it was kept from passing through
  int touching = 0;                        // pairs of its features that push each other
  int touching_others = 0;                 // pairs of one of its features and one of another sheet that do
  int on_colliders = 0;                    // vertices, edges and triangles that colliders push
  double inside_colliders = 0;             // [m] how deep the deepest of them is
  int new_singular = 0;
  enum Remesh { none, accepted, rejected } remesh = none;  // what became of the mesh that the method proposed
  double remesh_rise = 0;                  // [1] by how much of the stored energy the potential rose with it
  BentParts parts;                         // rulings and curved regions, if the method knows of any
  std::string note;
  std::function<std::string()> state;      // all that the next frame comes from, as bytes; to be asked before on_frame returns, for the last sheet of the frame
};

/// The loop over frames: handles -> step 1 -> method -> frame. Handle points and the rims of their discs are vertices of the
/// first mesh. A step that fails is taken in halves, down to 1/256 of a frame; one in which a flat sheet is pushed together in halves
/// to 1/8: where it bends to is to be its way's affair, not the step's or the mesh's. With inertia no step is longer than 1/96 s: backward
/// Euler damps, and at 1/24 s a pendulum of 20 cm would lose half its swing on the way to the other side.
///
/// on_frame  called for every frame in order; returns false to stop
/// throws    Error(Fault::simulation) when the sheet cannot follow its handles into the first frame (in a later one it stays as it was, and
///           the note says so) or has no finite energy; frames handed out before stay good; Error(Fault::scene) when go_on_from is no
///           state of this shot
/// source    the loop of [Schreck 2015], section 2
void animate(const Shot&, const Method&, const AnimateOptions&, const std::function<bool(const AnimatedFrame&)>& on_frame);

/// One of several sheets that are animated together. With methods and options of its own; frames, rate and elastic options are those of all.
struct AnimatedSheet {
  const Shot& shot;
  const Method& method;
  const AnimateOptions& options;
};

/// The same of several sheets, frame by frame. In a frame in which they stay out of each other's reach, each goes its way as if it were alone, to
/// the last bit; those that come within reach of each other take the frame together (Elastic::step_together).
/// Two sheets have one reach d^ between them: the smaller of theirs; where they begin nearer to each other, 0.9 x that distance, and as
/// they part, as much. Sheets that begin on each other, crossed or joined at a border, have a tenth of it, and where they do, none
/// (contact.h); of which half does, none at all until they are apart.
///
/// on_frame  called for every frame in order, and of it for every sheet in order
/// source    this project
void animate_together(const std::vector<AnimatedSheet>&, const std::function<bool(const AnimatedFrame&)>& on_frame);

/// The first mesh with the start shape on it. A flat start gets a ripple of 1e-6 m along its normal that depends on the
/// seed, not on the mesh. Singular points that are kept are born in the first frame.
struct StartedSheet {
  Sheet sheet;
  std::vector<int> handle_vertex;      // of each handle
  std::vector<char> fixed;             // |V| vertices that handles and the rims of their discs need where they are
  std::vector<double> stiffening;      // |T| factor on bending: 10 inside the discs of handles
};
StartedSheet start_sheet(const Shot&, const Method&, unsigned seed, int first_frame = 1);

}  // namespace paperbake
