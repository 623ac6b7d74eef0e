#include "core/animation/sheet_islands.h"

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/sheet_distance.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace paperbake {
namespace {

constexpr double initial_gap_ratio = 0.9;  // [1] of the distance at which two sheets begin
// [1] of the full dhat: two sheets that begin closer than the first value begin on each other, and
// get the second as their dhat
constexpr double merged_dhat_ratio = 0.02, joined_dhat_ratio = 0.1;
// [1] if more of the vertices than this begin closer than that, the two sheets coincide
constexpr double coincident_fraction = 0.5;

/// Merges islands until `collide` holds for no two sheets of different islands.
template <class Collide>
std::vector<SheetIslands::Island> merge_islands(std::vector<SheetIslands::Island> islands,
                                                Collide collide) {
  const auto any = [&](const SheetIslands::Island& a, const SheetIslands::Island& b) {
    return std::any_of(a.begin(), a.end(), [&](std::size_t i) {
      return std::any_of(b.begin(), b.end(), [&](std::size_t j) { return collide(i, j); });
    });
  };
  for (std::size_t a = 0; a < islands.size(); ++a)
    for (std::size_t b = a + 1; b < islands.size();) {
      if (!any(islands[a], islands[b])) {
        ++b;
        continue;
      }
      islands[a].insert(islands[a].end(), islands[b].begin(), islands[b].end());
      islands.erase(islands.begin() + b);
      b = a + 1;
    }
  for (SheetIslands::Island& island : islands) std::sort(island.begin(), island.end());
  return islands;
}

/// Positions of a sheet at a time of the frame (0: start, 1: end), linear between the recorded
/// ones, of which the last is at 1.
Points3 positions_at(const std::vector<TrajectoryPoint>& trajectory, double at) {
  const auto next = std::find_if(trajectory.begin(), trajectory.end(),
                                 [&](const TrajectoryPoint& p) { return p.at >= at; });
  if (next->at == at || next == trajectory.begin()) return next->x;
  const TrajectoryPoint& last = *(next - 1);
  return last.x + (at - last.at) / (next->at - last.at) * (next->x - last.x);
}

Eigen::AlignedBox3d swept_box(const std::vector<TrajectoryPoint>& trajectory) {
  Eigen::AlignedBox3d box;
  for (const TrajectoryPoint& p : trajectory)
    box.extend(Vector3d(p.x.colwise().minCoeff())).extend(Vector3d(p.x.colwise().maxCoeff()));
  return box;
}

}  // namespace

SheetIslands::SheetIslands(Sheets& sheets, Start begin) : sheets_(sheets) {
  if (begin == Start::resumed) return;
  for (std::size_t b = 0; b < sheets.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) sheets[b]->dhat[a] = initial_dhat(a, b);
}

/// Contact distance of two sheets, from where they begin. [m]
double SheetIslands::initial_dhat(std::size_t a, std::size_t b) const {
  const Sheet &one = sheets_[a]->sheet(), &other = sheets_[b]->sheet();
  const double near = merged_dhat_ratio * full_dhat(a, b),
               apart = initial_gap_ratio *
                       distance_between(one, other, full_dhat(a, b) / initial_gap_ratio);
  return apart > near ? apart
         : share_within(one, other, near) > coincident_fraction
             ? 0
             : joined_dhat_ratio * full_dhat(a, b);
}

double SheetIslands::full_dhat(std::size_t a, std::size_t b) const {
  return std::min(sheets_[a]->elastic().dhat(), sheets_[b]->elastic().dhat());
}

bool SheetIslands::is_admissible(std::size_t s, const Sheet& here, const Sheet& there,
                                 double moved) const {
  constexpr double share = 0.5;  // [1] of the distance before
  for (std::size_t o = 0; o < sheets_.size(); ++o) {
    if (o == s) continue;
    const Sheet& other = sheets_[o]->sheet();
    const double dhat = dhat_between(s, o);
    if (dhat == 0) continue;
    const double before = distance_between(here, other, dhat + moved);
    if (before == dhat + moved) continue;
    if (before < moved || distance_between(there, other, dhat) < share * std::min(dhat, before))
      return false;
    if (crossings_between(there, other) > crossings_between(here, other)) return false;
  }
  return true;
}

std::vector<SheetIslands::Island> SheetIslands::build_islands() const {
  std::vector<Island> each;
  for (std::size_t s = 0; s < sheets_.size(); ++s) each.push_back({s});
  return merge_islands(std::move(each), [&](std::size_t a, std::size_t b) {
    return !(sheets_[a]->is_idle() && sheets_[b]->is_idle()) &&
           distance_between(sheets_[a]->sheet(), sheets_[b]->sheet(), dhat_between(a, b)) <
               dhat_between(a, b);
  });
}

bool SheetIslands::collide(std::size_t a, std::size_t b) const {
  if (dhat_between(a, b) == 0 || (sheets_[a]->is_idle() && sheets_[b]->is_idle())) return false;
  Eigen::AlignedBox3d box = swept_box(sheets_[a]->trajectory());
  box.min().array() -= dhat_between(a, b);
  box.max().array() += dhat_between(a, b);
  if (!box.intersects(swept_box(sheets_[b]->trajectory()))) return false;
  std::vector<double> times;
  for (const std::size_t s : {a, b})
    for (const TrajectoryPoint& p : sheets_[s]->trajectory()) times.push_back(p.at);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<Points3> of_a, of_b;
  for (const double at : times) {
    of_a.push_back(positions_at(sheets_[a]->trajectory(), at));
    of_b.push_back(positions_at(sheets_[b]->trajectory(), at));
  }
  Points3 initial_a(0, 3), initial_b(0, 3);
  if (initial_gap({a, b}) == SheetSimulation::InitialGap::within_dhat) {
    initial_a = sheets_[a]->initial_positions();
    initial_b = sheets_[b]->initial_positions();
  }
  return !Elastic::are_collision_free(
      {sheets_[a]->sheet(), sheets_[a]->constraints(), of_a, initial_a},
      {sheets_[b]->sheet(), sheets_[b]->constraints(), of_b, initial_b}, dhat_between(a, b));
}

std::vector<SheetIslands::Island> SheetIslands::merge_colliding(
    const std::vector<Island>& islands) const {
  return merge_islands(islands, [&](std::size_t a, std::size_t b) { return collide(a, b); });
}

SheetSimulation::InitialGap SheetIslands::initial_gap(const Island& island) const {
  for (const std::size_t a : island)
    for (const std::size_t b : island)
      if (a < b && dhat_between(a, b) < full_dhat(a, b))
        return SheetSimulation::InitialGap::within_dhat;
  return SheetSimulation::InitialGap::apart;
}

void SheetIslands::step(const Island& island) const {
  const auto n = static_cast<Eigen::Index>(island.size());
  Eigen::MatrixXd dhat(n, n);
  std::vector<SheetSimulation*> all;
  for (Eigen::Index i = 0; i < n; ++i) {
    all.push_back(sheets_[island[i]].get());
    for (Eigen::Index j = 0; j < n; ++j)
      dhat(i, j) = i == j ? all.back()->elastic().dhat() : dhat_between(island[i], island[j]);
  }
  SheetSimulation::step_together(all, dhat, initial_gap(island), [this](std::size_t s) {
    return [this, s](const Sheet& here, const Sheet& there, double moved) {
      return is_admissible(s, here, there, moved);
    };
  });
}

void SheetIslands::finalize(const Island& island) const {
  for (const std::size_t s : island) sheets_[s]->finalize(SheetSimulation::Output::finished_sheet);
  for (const std::size_t a : island)
    for (const std::size_t b : island)
      if (a < b && crossings_between(sheets_[a]->output_sheet(), sheets_[b]->output_sheet()) >
                       crossings_between(sheets_[a]->sheet(), sheets_[b]->sheet()))
        for (const std::size_t s : {a, b})
          sheets_[s]->finalize(SheetSimulation::Output::simulated_sheet);
}

void SheetIslands::restore_contact_distances() {
  for (std::size_t b = 0; b < sheets_.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      double& dhat = sheets_[b]->dhat[a];
      if (dhat >= full_dhat(a, b)) continue;
      const double apart =
          initial_gap_ratio * distance_between(sheets_[a]->sheet(), sheets_[b]->sheet(),
                                               full_dhat(a, b) / initial_gap_ratio);
      if (apart > merged_dhat_ratio * full_dhat(a, b)) dhat = std::max(dhat, apart);
    }
}

}  // namespace paperbake
