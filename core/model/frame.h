#pragma once

#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// How a method divides the sheet, for those who draw it.
struct BentParts {
  std::vector<std::pair<Vector2d, Vector2d>> rulings;  // [m] segments on the pattern
  // |T| number of its curved region, -1: flat; empty: there are no regions
  std::vector<int> region;
};

/// A handle at one frame.
struct HandleFrame {
  // jammed: the paper does not follow; a soft handle never is
  enum State { free, held, jammed } state = free;
  // [m] where it is asked to be; a relative handle: grab position + motion since
  Vector3d keyed{0, 0, 0};
  Vector3d at{0, 0, 0};  // [m] where its sheet point is
};

/// One frame as it was simulated.
struct AnimatedFrame {
  int frame = 0;
  // number of the sheet among those that are animated together
  std::size_t of = 0;
  const Sheet* sheet = nullptr;      // belongs to animate; copy what is kept
  std::vector<HandleFrame> handles;  // as in Shot::handles
  // CPU time of this frame: step 1; everything else that touches the sheet
  double elastic_ms = 0, geometry_ms = 0;
  int substeps = 1, newton_iterations = 0;
  bool converged = true;
  double energy = 0, membrane_energy = 0;  // [J] stored in the sheet; its stretching part
  // [m rad] integral of the plastic curvature over the pattern so far
  double plastic = 0;
  const PlasticGrid* memory = nullptr;  // what the paper keeps; belongs to animate
  // |V|x3 [1/m] Sxx, Sxy, Syy kept at the vertices of the sheet; empty when not asked for
  Points3 plastic_curvature;
  // the sheet came near itself: it was kept from passing through
  bool contact = false;
  int touching = 0;  // pairs of its features that push each other
  // pairs of one of its features and one of another sheet that do
  int touching_others = 0;
  int on_colliders = 0;         // vertices, edges and triangles that colliders push
  double inside_colliders = 0;  // [m] how deep the deepest of them is
  int new_singular = 0;
  // what became of the mesh that the method proposed
  enum Remesh { none, accepted, rejected } remesh = none;
  // [1] by how much of the stored energy the potential rose with it
  double remesh_rise = 0;
  BentParts parts;  // rulings and curved regions, if the method knows of any
  std::string note;
  // all that the next frame comes from, as bytes; to be asked before on_frame returns, for the last
  // sheet of the frame
  std::function<std::string()> state;
};

}  // namespace paperbake
