#pragma once

#include "core/render/render_surface.h"
#include "core/render/untangle.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Separates the render meshes of sheets that come near each other, in the same way as the layers
/// of one sheet (untangle.h).
class SheetUntangler {
 public:
  /// sheets  must stay where they are as long as this object is used
  explicit SheetUntangler(const std::vector<RenderSurface>& sheets);

  /// A sheet of a frame, as it was simulated.
  struct Simulated {
    Sheet sheet;
    const std::vector<MeshPoint>* places;
  };

  /// Where one of the frames passes through another, everything near goes back towards the flat
  /// triangles.
  /// frames, simulated  one for each sheet
  /// May be called by several threads at the same time.
  void keep_apart(std::vector<RenderFrame>& frames, const std::vector<Simulated>&) const;

  /// True if the flat triangles of the sheets, joined by the triangles of their render meshes, pass
  /// through each other although the simulated sheets do not.
  bool linear_surfaces_intersect(const std::vector<Simulated>&) const;

  /// For each sheet, the number of pairs of one of its triangles and one of a sheet before it that
  /// pass through each other.
  /// x  for each sheet |V|x3 [m]
  std::vector<int> crossings(const std::vector<Points3>& x) const;

 private:
  Points3 in_a_row(const std::vector<Points3>&) const;
  std::vector<Points3> linear_positions(const std::vector<Simulated>&) const;

  const std::vector<RenderSurface>& sheets_;
  std::optional<Untangler> apart_;
};

}  // namespace paperbake
