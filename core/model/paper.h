#pragma once

#include <cmath>
#include <string>

namespace paperbake {

inline constexpr double max_friction = 10;  // [1] a larger value is a typing error

/// The material of one sheet. Values of a grade come from presets/*.toml, which give their sources.
struct Paper {
  std::string name = "copy70";
  double thickness = 90e-6;           // h      [m]
  double bending_stiffness = 2.7e-4;  // D      [N m]    per unit width, E h^3 / 12(1-nu^2)
  double membrane_stiffness = 3.6e5;  // E h    [N/m]
  double poisson = 0.3;               // nu     [1]
  double area_density = 0.070;        // rho    [kg/m2]
  // sigma [m]  standard deviation of the place of a new singular point, [Schreck 2015] fig. 3
  double apex_scatter = 0.005;
  // eps_y [1]  strain of the outer fibre, h k/2, beyond which bending is permanent: k_y = 2 eps_y/h
  double yield_strain = 0.0045;
  // eta [1]  fraction of D that is left beyond yield, in [0, 1)
  double hardening = 0.3;
  // [1] D_MD/D_CD: bending stiffness along the machine direction over that across it; D is their
  // geometric mean
  double grain_ratio = 1;
  double grain_angle = 0;  // [rad] of the machine direction, from u towards v
  // mu [1]  Coulomb friction of layer on layer; 0: none. The grades have theirs
  double friction = 0;
};

/// [1/m] Curvature beyond which paper keeps a part of it: there the strain of its faces is
/// yield_strain.
inline double yield_curvature(const Paper& paper) {
  return 2 * paper.yield_strain / paper.thickness;
}

/// [J] What a sheet that is nearly flat may store: as much as a square of any size that is bent
/// evenly by 4.2 degrees, D angle^2/2.
inline double energy_when_nearly_flat(const Paper& paper) {
  constexpr double angle = 0.0735;  // [rad] assumed: 1e-6 J for copier paper of 80 g/m2
  return paper.bending_stiffness * angle * angle / 2;
}

/// [m] Width of a ridge of length X between flat facets: 0.4 h^(1/3) X^(2/3).
/// source  exponents of the stretching ridge [Lobkovsky 1996]; the prefactor is this project's,
///         measured on S4
inline double ridge_width(const Paper& paper, double X) {
  return 0.4 * std::cbrt(paper.thickness) * std::pow(X, 2.0 / 3);
}

}  // namespace paperbake
