#include "core/step1_elastic/solver/incremental_potential.h"

#include <algorithm>

namespace paperbake {

double SheetPotential::energy_and_springs(const Points3& x) const {
  double value = elastic.energy(x) + inertia_and_forces(x);
  if (!springs.empty()) value += spring_energy(springs, x);
  if (air) value += air->energy(x);
  return value;
}

double SheetPotential::differentiate(const Points3& x, HessianForm form, Points3& gradient,
                                     BlockCholesky& matrix, const MembraneStress* stress) const {
  double value = elastic.hessian(x, form, gradient, matrix, stress) + inertia_and_forces(x);
  for (int v = 0; v < x.rows(); ++v)
    gradient.row(v) += mass[v] * (inertia * (x.row(v) - xhat.row(v)) + forces.gradient());
  if (!springs.empty()) value += differentiate_springs(springs, x, block_of, gradient, matrix);
  if (air) value += air->differentiate(x, block_of, gradient, matrix);
  return value;
}

/// The rows of one sheet among several are copied; those of a single sheet are passed on as they
/// are.
template <class Visit>
void IncrementalPotential::for_each_sheet(const Points3& x, Visit visit) const {
  if (sheets.size() == 1) return visit(sheets.front(), x, 0);
  Eigen::Index first = 0;
  for (const SheetPotential& sheet : sheets) {
    visit(sheet, Points3(x.middleRows(first, sheet.mass.size())), first);
    first += sheet.mass.size();
  }
}

double IncrementalPotential::operator()(const Points3& x) const {
  double value = 0;
  for_each_sheet(x, [&](const SheetPotential& sheet, const Points3& own, Eigen::Index) {
    value += sheet.energy_and_springs(own);
  });
  if (contact) value += contact->energy(x);
  for_each_sheet(x, [&](const SheetPotential& sheet, const Points3& own, Eigen::Index) {
    if (sheet.colliders) value += sheet.colliders->energy(own);
  });
  return value;
}

double IncrementalPotential::differentiate(const Points3& x, HessianForm form, Points3& gradient,
                                           BlockCholesky& matrix,
                                           const MembraneStress* stress) const {
  matrix.set_zero();
  gradient.resize(x.rows(), 3);
  double value = 0;
  Points3 part;
  for_each_sheet(x, [&](const SheetPotential& sheet, const Points3& own, Eigen::Index first) {
    value += sheet.differentiate(own, form, part, matrix, stress);
    gradient.middleRows(first, own.rows()) = part;
  });
  if (contact) value += contact->differentiate(x, gradient, &matrix);
  for_each_sheet(x, [&](const SheetPotential& sheet, const Points3& own, Eigen::Index first) {
    if (sheet.colliders) {
      part = gradient.middleRows(first, own.rows());
      value += sheet.colliders->differentiate(own, sheet.block_of, part, &matrix);
      gradient.middleRows(first, own.rows()) = part;
    }
    for (int v = 0; v < own.rows(); ++v)
      matrix.add(matrix.slot(sheet.block_of[v], sheet.block_of[v]),
                 Matrix3d(sheet.mass[v] * sheet.inertia * Matrix3d::Identity()));
  });
  return value;
}

double IncrementalPotential::limit_step(const Points3& x, Points3& move) const {
  double free = 1, clear = 1;
  if (contact) {
    contact->update_candidates(x, move);
    free = contact->collision_free_step(x, move);
    move *= free;
  }
  for_each_sheet(x, [&](const SheetPotential& sheet, const Points3& own, Eigen::Index first) {
    if (sheet.colliders)
      clear = std::min(
          clear, sheet.colliders->collision_free_step(own, move.middleRows(first, own.rows())));
  });
  move *= clear;
  return free * clear;
}

}  // namespace paperbake
