#pragma once

#include "core/geometry/random.h"
#include "core/geometry/vertex_rings.h"
#include "core/model/local_energies.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple_options.h"
#include "core/step2_crumple/facet_sizes.h"
#include "core/step2_crumple/lasting_places.h"

#include <vector>

namespace paperbake {

/// The mesh of a sheet that is crumpled: it has three singular points or more, and its folds run
/// along edges. Nothing here counts frames or seconds. What changes, changes with the travel of
/// what deforms the sheet (Crumple::Deformation), so that a shot gives the same crumple at any
/// speed.
///
/// - The inner vertices at which folds end slide on the pattern down their configurational forces,
///   to where the sheet stores least. So folds lie where the load puts them, not where the first
///   mesh had its edges.
/// - A vertex at which three folds or more have met for long enough becomes a singular point. From
///   then on it does not move on the pattern.
/// - Edges are as long as FacetSizes says. Where the sheet stores more in its membrane than folds
///   would cost, the mesh is too coarse to fold, and the sizes shrink.
///
/// source  this project
class CrumpledMesh {
 public:
  /// seed, sheet  the random draws depend on these and on the number of the event alone
  CrumpledMesh(const Pattern&, const Paper&, const CrumpleOptions&, std::uint32_t seed,
               std::uint32_t sheet);

  void allow_triangles(int most) { options_.max_triangles = most; }

  struct Input {
    const std::vector<char>& fixed;  // 1: the vertex keeps its place on the pattern
    const LocalEnergies& stored;     // of the sheet
    double travel;                   // [1] of Crumple::Deformation
    int frame;
    bool at_minimum = true;  // the last step reached a minimum
  };
  /// Changes the mesh of the sheet as the last elastic step left it. Away from a minimum no vertex
  /// slides: the forces on the vertices do not say there where they would rather be.
  CrumpleReport step(Sheet&, const Input&);

  /// Refines the mesh of a sheet that is jammed, where it is locked.
  /// returns  the number of edges that were divided or removed
  int refine_where_jammed(Sheet&, const std::vector<char>& fixed, const LocalEnergies& stored);

  void archive(Serializer&);

  /// How a vertex slides.
  struct Slider {
    double rate = 1;           // [1] smaller for a vertex whose force turns back and forth
    Vector2d direction{0, 0};  // of the last step
  };

 private:
  struct Mesh;  // of the sheet before the step, with all that is measured on it
  int promote(Sheet&, Mesh&, const Input&);
  bool promote_vertex(Sheet&, const Mesh&, int vertex, int frame);
  int slide(Sheet&, const Mesh&, const Input&);
  void refine_where_locked(const Sheet&, const Mesh&, const Input&);
  void refine_locked_rings(const Sheet&, const Mesh&, double factor);
  int fit_sizes(Sheet&, const Mesh&);

  Pattern pattern_;
  Paper paper_;
  CrumpleOptions options_;
  std::uint32_t seed_, sheet_;
  FacetSizes sizes_;
  LastingPlaces junctions_;
  std::vector<Slider> sliders_;  // |V|; empty: the vertices have new numbers
};

}  // namespace paperbake
