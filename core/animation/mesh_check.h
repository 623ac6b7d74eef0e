#pragma once

#include "core/animation/simulated_sheet.h"
#include "core/model/serializer.h"

#include <optional>

namespace paperbake {

/// How far a sheet is from where it would be on a finer mesh: it is brought to equilibrium on one
/// of four times as many triangles as the first mesh, and what it moves by that is the error of its
/// own mesh, within the branch that it is on. (An error that falls as the area of a triangle loses
/// three quarters in that way.) The paper does not yield in between, and the sheet and its solver
/// are left as they were.
///
/// Method   one that gives the points of handles the same numbers in every mesh
/// at       what holds the sheet where it is, with the colliders standing still
/// returns  [1] root mean square over the vertices of the sheet, of its longer side; nothing if the
///          method has no such mesh, or if the sheet does not come to rest on it, comes near
///          itself or touches a collider
/// source   this project
std::optional<double> distance_from_finer_mesh(const SimulatedSheet&, const Method&,
                                               const StepInput& at);

/// The error that the mesh of a sheet makes, watched through the shot: it is found anew when the
/// sheet has been deformed by a twentieth of its longer side since it was found last.
class MeshCheck {
 public:
  /// Looks at a sheet at the end of a frame.
  /// deformation      [1] of the sheet in this frame, root mean square, of the longer side
  /// is_at_rest       it is at the one minimum that handles and weight lead to: not with inertia,
  ///                  nor with friction
  void look(const SimulatedSheet&, const Method&, const StepInput& at, double deformation,
            bool is_at_rest);
  /// [1] of the longer side; 0: not known
  double error() const { return error_; }
  void archive(Serializer& a) { a(error_, deformed_); }

 private:
  double error_ = 0;
  double deformed_ = 0;  // [1] of the longer side, since the error was found
};

}  // namespace paperbake
