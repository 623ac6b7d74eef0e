#pragma once

#include "core/render/render_surface.h"
#include "core/render/untangle.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The render meshes of sheets that come near each other, kept out of each other as the layers of
/// one sheet are (untangle.h).
class SheetUntangler {
 public:
  /// sheets  stay where they are as long as this is asked
  explicit SheetUntangler(const std::vector<RenderSurface>& sheets);

  /// A sheet of a frame, as it was simulated.
  struct Simulated {
    Sheet sheet;
    const std::vector<MeshPoint>* places;
  };

  /// Where one of the frames passes through another, all that is near goes back towards the facets.
  /// frames, simulated  of every sheet. Several threads may ask at the same time.
  void keep_apart(std::vector<RenderFrame>& frames, const std::vector<Simulated>&) const;

  /// The facets of sheets, joined by the triangles of their render meshes, pass through each other
  /// though the sheets do not.
  bool linear_surfaces_intersect(const std::vector<Simulated>&) const;

  /// Of each sheet: pairs of its triangles and of those of sheets before it that pass through each
  /// other.
  /// x  of every sheet |V|x3 [m]
  std::vector<int> crossings(const std::vector<Points3>& x) const;

 private:
  Points3 in_a_row(const std::vector<Points3>&) const;
  std::vector<Points3> linear_positions(const std::vector<Simulated>&) const;

  const std::vector<RenderSurface>& sheets_;
  std::optional<Untangler> apart_;
};

}  // namespace paperbake
