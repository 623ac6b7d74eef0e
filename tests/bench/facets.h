#pragma once

#include "core/geometry/hinges.h"
#include "core/model/local_energies.h"
#include "core/model/paper.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <Eigen/Core>

#include <vector>

namespace paperbake {

/// The facets of a crumple: what is left in one piece when the pattern is cut along its creases.
struct Facets {
  std::vector<int> of_triangle;  // |T| number of its facet
  std::vector<double> area;      // [m2] of each facet on the pattern
  // [m] length of the creases that part two facets. One that ends inside a facet parts nothing.
  double crease_length = 0;
};

/// turn     |hinges| [rad] by how much the sheet is folded at each inner edge
/// crease   [rad] edges with more than that are cut
Facets find_facets(const Sheet&, const Hinges&, const std::vector<double>& turn, double crease);

/// |hinges| [rad] The turn that stays at each inner edge when the sheet is let go: the plastic
/// curvature of its two triangles across it, spread over their width. Where a single edge of each
/// triangle has yielded, this is the plastic part of its dihedral angle.
std::vector<double> plastic_turns(const Sheet&, const Hinges&, const PlasticMemory&);

/// What a crumple in a tube is like by the law of [Andrejevic 2021], which was fitted to sheets of
/// Mylar that were rolled into a tube and pressed along its axis once. Lengths are in sides of the
/// sheet.
///
///   t = 2/R^2 (1 - D^2) ln(1 + 9.031 R^2/sqrt(2 pi) / (D (1 + D))),   a = sqrt(t/24.04)
///
/// The square root of the areas is Gamma distributed with shape a and mean a/t.
struct FacetLaw {
  /// height  D [1] of the tube over the side;   radius  R [1] of the tube over the side
  FacetLaw(double height, double radius);
  double t, a;
  double facets() const;         // [1] 1/(mean area)
  double crease_length() const;  // [1] 2.1227 t/(a + 1)
  /// Share of the facets with a smaller square root of the area.
  double share_below(double root_of_area) const;
};

/// Largest distance between the distribution of the square roots of these areas [1, of the sheet]
/// and that of the law (Kolmogorov, Smirnov), times the square root of their number. In one case of
/// twenty a sample of the law itself exceeds 1.36.
double distance_from_law(std::vector<double> areas, const FacetLaw&);

/// What a facet carries.
struct FacetLoad {
  // [1] the load over the one under which it buckles: -s w^2/(4 pi^2 D), with the most compressive
  // principal value s [N/m] of the membrane stress, averaged by area over the facet and its
  // neighbours, and the width w [m] of the facet in that direction
  double load = 0;
  double membrane_share = 0;  // [1] of the energy of the facet and its neighbours
  Vector2d direction{0, 0};   // of the compression
  double width = 0;           // [m]
};

/// stress             |T| 2x2 [N/m] second Piola-Kirchhoff
/// membrane, bending  |T| [J]
std::vector<FacetLoad> facet_loads(const Sheet&, const Hinges&, const Facets&, const Paper&,
                                   const std::vector<Eigen::Matrix2d>& stress,
                                   const LocalEnergies&);

}  // namespace paperbake
