#pragma once

#include "core/animation/expected_creases.h"
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
  double relative_motion;  // as in SubstepTarget
  int row;                 // of the hands: frame - first frame of the scene
};

/// A step that a sheet has taken, and that it can take again on another mesh.
struct PastStep {
  Sheet sheet;       // where the step began
  PlasticGrid grid;  // the same
  LoadStep load;
};

/// A sheet whose paper is being folded along a line that is not among the edges of its mesh.
struct UnfoldedSheet {
  const Shot& shot;
  const Sheet& sheet;
  Elastic& elastic;
  PlasticGrid& grid;
  // the steps that led here, or the one that holds the sheet where it is; not empty
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
/// and in exchange that plastic curvature leaves the grid. The sheet then takes a step on the new
/// mesh, with the handles and colliders where they are. The fold is possible if the step ends with
/// a tenth less stored energy than before or better, with edges that are off by less than 0.5 %,
/// and with nothing crossing or in a collider that was not before; in contact no vertex may move
/// farther than a tenth of the longer side. Of the lines that are possible, the one with which the
/// sheet stores least is taken: there paper folds.
///
/// returns  nothing if no fold is possible, or the method has no mesh with the line; the sheet and
///          the grid are then as they were
std::optional<FoundFold> fold_along(const std::vector<FoldLine>&, const UnfoldedSheet&,
                                    const Method&);

}  // namespace paperbake
