#pragma once

#include "core/animation/animate.h"
#include "core/model/pattern.h"

namespace paperbake {

/// Whether the triangles of a sheet are too large for its bends, watched through a shot. Sheets
/// that are modelled bent, creased or have a singular point may be as sharp as they like; one that
/// is found to fold is judged by what it was before: a mesh that is too coarse makes folds, too.
class BendWatch {
 public:
  /// Looks at the sheet at the end of a frame; the first one that it sees is the first of the shot.
  void look(const AnimatedFrame&, const Pattern&);

  /// Whether in more than a tenth of the frames
  /// - the mesh puts the sheet off by more than 0.5 % of its longer side from where it would be on
  ///   a finer one (FrameStatistics::mesh_error, not known of every frame),
  /// - or its triangles are farther from smooth paper than 0.5 % of the root of its area
  ///   (rms_sagitta; a ribbon would hide in its length how angular it is across),
  /// - or, if it has no inertia and touches nothing else, an edge is bent so sharply that it begins
  ///   to be drawn as a crease (crease_share).
  bool is_coarse() const;

  /// Whether in more than a tenth of the frames an edge of it is drawn as a whole crease, while it
  /// has no inertia and touches nothing else.
  bool is_creased() const;

 private:
  int frames_ = 0, coarse_frames_ = 0, creased_frames_ = 0;
  bool may_be_sharp_ = false;
};

}  // namespace paperbake
