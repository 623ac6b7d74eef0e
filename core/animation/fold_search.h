#pragma once

#include "core/animation/found_fold.h"
#include "core/animation/mesh_swap.h"
#include "core/animation/simulated_sheet.h"
#include "core/model/serializer.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Looks for lines that nobody announced along which a sheet is being folded, after every step.
class FoldSearch {
 public:
  /// first_frame  of the scene
  FoldSearch(SimulatedSheet&, const Method&, int first_frame);

  /// Whether lines are looked for. Not on the mesh of a sheet that begins tightly bent: it is fine
  /// enough to show its folds.
  bool is_on() const;

  /// Keeps a step that is about to be taken, so that it can be taken again, folded; or joins it to
  /// the one before it, if both are short.
  void remember(const LoadStep&);
  void forget() { past_.clear(); }

  /// What the last step did to the paper.
  struct Signs {
    bool yielded, on_colliders;
  };
  /// The sheet folded along a line, if it is being folded; otherwise nothing has changed.
  /// now  the step that holds the sheet where it is
  std::optional<FoundFold> find(const LoadStep& now, const Signs&,
                                const AdmissibilityCheck& is_admissible);

  /// Whether keys of frames to come have had a say in where the sheet was folded, or was not.
  bool has_looked_ahead() const { return stored_unfolded_ > 0; }

  /// To be called after the plastic grid of the sheet has been read.
  void archive(Serializer&);

 private:
  std::vector<FoldLine> lines(const ColliderShapes&, const Signs&) const;
  bool joins(LoadStep& last, const LoadStep& next) const;

  SimulatedSheet& simulated_;
  const Method& method_;
  int first_frame_;
  double stored_unfolded_ = 0;  // [J] when a fold was last tried; 0: never
  // the last steps, as far back as a fold that colliders press is begun; empty where no collider
  // is, and of sheets that are animated together
  std::vector<PastStep> past_;
};

}  // namespace paperbake
