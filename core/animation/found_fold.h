#pragma once

#include "core/animation/substepping.h"
#include "core/methods/method.h"
#include "core/model/fold_line.h"
#include "core/model/shot.h"
#include "core/step1_elastic/elastic.h"

#include <optional>
#include <vector>

namespace paperbake {

/// What a sheet follows in a step.
struct LoadStep {
  StepInput input;
  double dt;               // [s]
  double relative_motion;  // as in DrivenSheet
  int row;                 // of the hands: frame - first frame of the scene
  int halvings;            // of the step, at least
};

/// A step that a sheet has taken, and that it can take again on another mesh.
struct PastStep {
  Sheet sheet;       // where the step began
  PlasticGrid grid;  // the same
  LoadStep load;
  bool is_now = false;  // nothing moves: it holds the sheet where it is
};

/// A sheet whose paper is being folded along a line that is not among the edges of its mesh.
struct UnfoldedSheet {
  const Shot& shot;
  const Sheet& sheet;
  Elastic& elastic;
  PlasticGrid& grid;
  int first_frame;  // of the scene
  LoadStep now;     // the step that holds the sheet where it is
  // the steps that led here, each on the mesh that the sheet had then; empty: they are not known
  const std::vector<PastStep>& past;
};

/// The same sheet on a mesh that has the line among its edges, folded there.
struct FoundFold {
  Sheet sheet;  // the line is the last of its prescribed creases
  Elastic elastic;
  std::vector<char> fixed;  // |V| as in InitialSheet
  PlasticGrid grid;
  FrameStepResult step = {};  // the last one
  double moved = 0;           // [m] largest distance of a vertex from the sheet that was not folded
  double spent = 0;           // [J] stored, and by handles that are held off
};

/// Folds a sheet along one of several lines, provided that this is what paper does.
///
/// A line becomes a crease that springs back to the angle by which the paper beside it has yielded,
/// and in exchange that plastic curvature leaves the grid. Where colliders press the sheet and
/// handles hold both its sides, they say where the line lies, and the sheet takes the steps that
/// led there again, folded; elsewhere, and where they are not known, it takes the step that holds
/// it where it is (fold_place.h). The fold is possible if a tenth less is spent in the end than
/// without it (stored energy and the work of handles that are held off), with edges that are off by
/// less than 0.5 % or than before, and with nothing crossing or in a collider that was not before;
/// in contact no vertex may move farther than a tenth of the longer side. Of the lines that are
/// possible, the one with which least is spent is taken: there paper folds.
///
/// A mesh of few triangles may bend where paper does not, along its own edges. So where colliders
/// do not say where the line lies, the sheet takes the step once more without folding, on a mesh of
/// twice as many triangles: the method must find that it is being folded there, too.
///
/// returns  nothing if no fold is possible, if it is one of its mesh, or if the method has no mesh
///          with the line; the sheet and the grid are then as they were
std::optional<FoundFold> fold_along(const std::vector<FoldLine>&, const UnfoldedSheet&,
                                    const Method&);

}  // namespace paperbake
