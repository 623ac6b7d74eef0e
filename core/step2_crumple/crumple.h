#pragma once

#include "core/geometry/collider.h"
#include "core/model/fold_line.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple_options.h"
#include "core/step2_crumple/crumpled_mesh.h"
#include "core/step2_crumple/find_fold_lines.h"
#include "core/step2_crumple/lasting_places.h"
#include "core/step2_crumple/remesh_schedule.h"
#include "core/step2_crumple/ruled_mesh.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace paperbake {

inline constexpr int most_load_parts = 16;  // into which a frame is divided; assumed

struct Conflicts;
struct PlasticMemory;

/// Step 2 of [Schreck 2015] for one sheet. A sheet is smooth as long as it has fewer than three
/// singular points. Its mesh is then changed where it is: edge flips make it follow the bending,
/// and where two bending directions conflict for long enough, a singular point is born at a place
/// drawn from the law of the paper. In addition new meshes are proposed whose edges are the rulings
/// of the curved regions. A sheet with more singular points is crumpled (crumpled_mesh.h).
class Crumple {
 public:
  /// seed, sheet  the random draws depend on these and on the number of the event alone
  Crumple(const Pattern&, const Paper&, const CrumpleOptions&, std::uint32_t seed,
          std::uint32_t sheet);

  /// How the sheet is deformed in the step that is about to be taken.
  struct Deformation {
    // [1] of the longer side: the largest distance that a handle goes relative to the others, or of
    // a sheet that lies on something or swings, the distance that its points went
    double travel;
    bool moving;      // false: the sheet is at rest
    bool at_minimum;  // the last step reached a minimum
    // colliders squeeze it, and no handle gives way: it may have to fold once more before it can
    // reach a minimum
    bool pressed = false;
  };
  /// Examines the sheet as step 1 left it and changes its mesh for the next step. Fixed vertices
  /// (handles and the rims of their discs) keep their number and their place on the pattern.
  /// stored  the energies of the sheet
  CrumpleReport step(Sheet&, const std::vector<char>& fixed, const FrameTime&, const Deformation&,
                     const std::function<LocalEnergies()>& stored);

  /// Refines the mesh of a sheet that is jammed where it stores more in its membrane than folds
  /// would cost.
  /// returns  the number of edges that were divided or removed
  int refine_where_jammed(Sheet&, const std::vector<char>& fixed, const LocalEnergies& stored);

  /// Into how many parts a frame is to be divided. The folds of a crumpled sheet follow the load in
  /// small steps only.
  int load_parts(const Sheet&, double travel) const;

  /// Sets the mesh from which every ruled mesh is derived. To be called before `propose`.
  /// required  number of vertices, from number 0 on, that a ruled mesh must keep as they are
  void set_base_mesh(const Points2& pattern, const Triangles&, int required);

  /// Lets the mesh have so many triangles, if the options allow less.
  void allow_triangles(int most);

  /// To be called before `step`, with a sheet in equilibrium. Looks for curved regions and, when
  /// the mesh does not follow their rulings, proposes one that does, with positions and velocities
  /// interpolated. The required vertices keep their numbers.
  /// isolated_moving_handles  vertices that are moved by a handle with no other one near
  /// rests_on_contact         something supports the sheet: behind a corner that is pulled it
  ///                          cannot sag and bends into a hook instead
  std::optional<Sheet> propose(const Sheet&, const std::vector<int>& isolated_moving_handles,
                               bool rests_on_contact, const FrameTime&);
  /// Reports what became of the last proposal.
  void on_proposal_result(bool accepted, const FrameTime&);

  /// Lines along which the sheet is being folded (find_fold_lines.h); none of a crumpled sheet.
  std::vector<FoldLine> fold_lines(const Sheet&, const PlasticMemory&) const;
  std::vector<FoldLine> pressed_lines(const Sheet&, const std::function<PlasticMemory()>&,
                                      const ColliderShapes&) const;

  const Regions& regions() const { return regions_; }
  // of the last proposal that was accepted
  const std::vector<Ruling>& rulings() const { return rulings_; }

  void archive(Serializer&);  // everything that changes after set_base_mesh

 private:
  Pattern pattern_;
  Paper paper_;
  CrumpleOptions options_;
  std::uint32_t seed_, sheet_;
  CrumpleReport step_smooth(Sheet&, const std::vector<char>& fixed, const FrameTime&,
                            double travel);
  /// Updates the pending conflicts. A conflict counts once it has persisted.
  /// returns  vertices at which it has, the worst first
  std::vector<int> due_for_birth(const Sheet&, const VertexRings&, const Conflicts&, double travel);
  /// Makes a singular point at the apex of the sheet, or else where the conflict around a vertex
  /// is, if there is room for one.
  bool give_birth(Sheet&, int worst, const Conflicts&, const std::optional<Vector2d>& apex,
                  const std::vector<char>& fixed, int frame);

  LastingPlaces pending_;  // conflicts
  CrumpledMesh crumpled_;
  BaseMesh base_;
  int required_ = 0;
  Regions regions_;
  std::vector<Ruling> proposed_, rulings_;
  RemeshSchedule when_;
};

}  // namespace paperbake
