#include "core/animation/sheet_islands.h"

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/sheet_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>

namespace paperbake {
namespace {

constexpr double kept = 0.9;  // [1] of the distance at which two sheets begin
// [1] of the full dhat: two sheets that begin closer than the first value begin on each other, and
// get the second as their dhat
constexpr double least = 0.02, some = 0.1;
// [1] if more of the vertices than this begin closer than that, the two sheets coincide
constexpr double one_place = 0.5;

/// Merges islands until `meet` holds for no two sheets of different islands.
template <class Meet>
std::vector<SheetsBeside::Party> join(std::vector<SheetsBeside::Party> parties, Meet meet) {
  const auto any = [&](const SheetsBeside::Party& a, const SheetsBeside::Party& b) {
    return std::any_of(a.begin(), a.end(), [&](std::size_t i) {
      return std::any_of(b.begin(), b.end(), [&](std::size_t j) { return meet(i, j); });
    });
  };
  for (std::size_t a = 0; a < parties.size(); ++a)
    for (std::size_t b = a + 1; b < parties.size();) {
      if (!any(parties[a], parties[b])) {
        ++b;
        continue;
      }
      parties[a].insert(parties[a].end(), parties[b].begin(), parties[b].end());
      parties.erase(parties.begin() + b);
      b = a + 1;
    }
  for (SheetsBeside::Party& party : parties) std::sort(party.begin(), party.end());
  return parties;
}

/// Positions of a sheet at a time of the frame (0: start, 1: end), linear between the recorded
/// ones.
Points3 place_at(const std::vector<Passed>& way, double at) {
  const auto next =
      std::find_if(way.begin(), way.end(), [&](const Passed& p) { return p.at >= at; });
  if (next->at == at || next == way.begin()) return next->x;
  const Passed& last = *(next - 1);
  return last.x + (at - last.at) / (next->at - last.at) * (next->x - last.x);
}

Eigen::AlignedBox3d box_of(const std::vector<Passed>& way) {
  Eigen::AlignedBox3d box;
  for (const Passed& p : way)
    box.extend(Vector3d(p.x.colwise().minCoeff())).extend(Vector3d(p.x.colwise().maxCoeff()));
  return box;
}

}  // namespace

SheetsBeside::SheetsBeside(Sheets& sheets, Begin begin) : sheets_(sheets) {
  if (begin == Begin::as_kept) return;
  for (std::size_t b = 0; b < sheets.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) sheets[b]->reach[a] = begun(a, b);
}

/// Contact distance of two sheets, from where they begin. [m]
double SheetsBeside::begun(std::size_t a, std::size_t b) const {
  const Sheet &one = sheets_[a]->sheet(), &other = sheets_[b]->sheet();
  const double near = least * whole(a, b),
               apart = kept * distance_between(one, other, whole(a, b) / kept);
  return apart > near ? apart : share_within(one, other, near) > one_place ? 0 : some * whole(a, b);
}

double SheetsBeside::whole(std::size_t a, std::size_t b) const {
  return std::min(sheets_[a]->elastic().reach(), sheets_[b]->elastic().reach());
}

bool SheetsBeside::fits(std::size_t s, const Sheet& here, const Sheet& there, double moved) const {
  constexpr double share = 0.5;  // [1] of the distance before
  for (std::size_t o = 0; o < sheets_.size(); ++o) {
    if (o == s) continue;
    const Sheet& other = sheets_[o]->sheet();
    const double reach = between(s, o);
    if (reach == 0) continue;
    const double before = distance_between(here, other, reach + moved);
    if (before == reach + moved) continue;
    if (before < moved || distance_between(there, other, reach) < share * std::min(reach, before))
      return false;
    if (crossings_between(there, other) > crossings_between(here, other)) return false;
  }
  return true;
}

std::vector<SheetsBeside::Party> SheetsBeside::within_reach() const {
  std::vector<Party> each;
  for (std::size_t s = 0; s < sheets_.size(); ++s) each.push_back({s});
  return join(std::move(each), [&](std::size_t a, std::size_t b) {
    return !(sheets_[a]->stays() && sheets_[b]->stays()) &&
           distance_between(sheets_[a]->sheet(), sheets_[b]->sheet(), between(a, b)) <
               between(a, b);
  });
}

bool SheetsBeside::meet(std::size_t a, std::size_t b) const {
  if (between(a, b) == 0 || (sheets_[a]->stays() && sheets_[b]->stays())) return false;
  Eigen::AlignedBox3d box = box_of(sheets_[a]->way());
  box.min().array() -= between(a, b);
  box.max().array() += between(a, b);
  if (!box.intersects(box_of(sheets_[b]->way()))) return false;
  std::vector<double> times;
  for (const std::size_t s : {a, b})
    for (const Passed& p : sheets_[s]->way()) times.push_back(p.at);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<Points3> of_a, of_b;
  for (const double at : times)
    of_a.push_back(place_at(sheets_[a]->way(), at)),
        of_b.push_back(place_at(sheets_[b]->way(), at));
  Points3 begun_a(0, 3), begun_b(0, 3);
  if (began({a, b}) == Animation::Begun::near_each_other)
    begun_a = sheets_[a]->begun(), begun_b = sheets_[b]->begun();
  return !Elastic::clear({sheets_[a]->sheet(), sheets_[a]->held(), of_a, begun_a},
                         {sheets_[b]->sheet(), sheets_[b]->held(), of_b, begun_b}, between(a, b));
}

std::vector<SheetsBeside::Party> SheetsBeside::where_ways_meet(
    const std::vector<Party>& parties) const {
  return join(parties, [&](std::size_t a, std::size_t b) { return meet(a, b); });
}

Animation::Begun SheetsBeside::began(const Party& party) const {
  for (const std::size_t a : party)
    for (const std::size_t b : party)
      if (a < b && between(a, b) < whole(a, b)) return Animation::Begun::near_each_other;
  return Animation::Begun::apart;
}

void SheetsBeside::step(const Party& party) const {
  const auto n = static_cast<Eigen::Index>(party.size());
  Eigen::MatrixXd reach(n, n);
  std::vector<Animation*> all;
  for (Eigen::Index i = 0; i < n; ++i) {
    all.push_back(sheets_[party[i]].get());
    for (Eigen::Index j = 0; j < n; ++j)
      reach(i, j) = i == j ? all.back()->elastic().reach() : between(party[i], party[j]);
  }
  Animation::step_together(all, reach, began(party));
}

void SheetsBeside::show(const Party& party) const {
  for (const std::size_t s : party) sheets_[s]->show(Animation::Shown::as_finished);
  for (const std::size_t a : party)
    for (const std::size_t b : party)
      if (a < b && crossings_between(sheets_[a]->shown(), sheets_[b]->shown()) >
                       crossings_between(sheets_[a]->sheet(), sheets_[b]->sheet()))
        for (const std::size_t s : {a, b}) sheets_[s]->show(Animation::Shown::as_simulated);
}

void SheetsBeside::part() {
  for (std::size_t b = 0; b < sheets_.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      double& reach = sheets_[b]->reach[a];
      if (reach >= whole(a, b)) continue;
      const double apart =
          kept * distance_between(sheets_[a]->sheet(), sheets_[b]->sheet(), whole(a, b) / kept);
      if (apart > least * whole(a, b)) reach = std::max(reach, apart);
    }
}

}  // namespace paperbake
