#pragma once

#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// How a method divides the sheet, for drawing it.
struct BentParts {
  std::vector<std::pair<Vector2d, Vector2d>> rulings;  // [m] segments on the pattern
  // |T| index of the curved region of each triangle, -1: flat; empty: there are no regions
  std::vector<int> region;
};

/// A handle at one frame.
struct HandleFrame {
  // jammed: the paper does not follow; a soft handle is never jammed
  enum State { free, held, jammed } state = free;
  // [m] where the handle is keyed to be; for a relative handle: grab position + motion since then
  Vector3d keyed{0, 0, 0};
  Vector3d at{0, 0, 0};  // [m] where its point of the sheet is
};

/// One simulated frame of a sheet.
struct AnimatedFrame {
  int frame = 0;
  // index of the sheet among those that are animated together
  std::size_t of = 0;
  const Sheet* sheet = nullptr;      // belongs to animate; copy what is to be kept
  std::vector<HandleFrame> handles;  // as in Shot::handles
  // [ms] CPU time of this frame: for step 1; for everything else that touches the sheet
  double elastic_ms = 0, geometry_ms = 0;
  int substeps = 1, newton_iterations = 0;
  bool converged = true;
  double energy = 0, membrane_energy = 0;  // [J] stored in the sheet; its membrane part
  // [m rad] integral of the plastic curvature over the pattern so far
  double plastic = 0;
  const PlasticGrid* memory = nullptr;  // plastic state; belongs to animate
  // |V|x3 [1/m] plastic curvature Sxx, Sxy, Syy at the vertices of the sheet; empty if not asked
  // for
  Points3 plastic_curvature;
  // the sheet came near itself: it was kept from passing through itself
  bool contact = false;
  int touching = 0;  // pairs of its features that push each other
  // pairs of one of its features and one of another sheet that push each other
  int touching_others = 0;
  int on_colliders = 0;         // vertices, edges and triangles that colliders push
  double inside_colliders = 0;  // [m] depth of the deepest of them
  int new_singular = 0;
  // what became of the mesh that the method proposed
  enum Remesh { none, accepted, rejected } remesh = none;
  // [1] rise of the potential through the new mesh, relative to the stored energy
  double remesh_rise = 0;
  BentParts parts;  // rulings and curved regions, if the method has any
  std::string note;
  // Everything that the next frame depends on, as bytes. To be called before on_frame returns, for
  // the last sheet of the frame.
  std::function<std::string()> state;
};

}  // namespace paperbake
