#include "core/step2_crumple/regions.h"

#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace paperbake {

Regions::Regions(const Pattern& pattern, const RulingOptions& options)
    : grid_(pattern),
      options_(options),
      curved_above_(options.curved_above / longer_side(pattern)),
      curved_(grid_.count(), 0),
      region_of_sample_(grid_.count(), -1) {}

void Regions::update(const BendingField& field) {
  bending_.clear();
  for (int i = 0; i < grid_.count(); ++i) {
    bending_.push_back(field.at(grid_.sample_points[i]));
    const Principal& k = bending_.back();
    curved_[i] = std::abs(k.k1) > (curved_[i] ? options_.flat_below : 1.0) * curved_above_ &&
                 std::abs(k.k2) < options_.coherent * std::abs(k.k1);
  }
  std::vector<int> old_ids(grid_.count(), -1);
  for (int i = 0; i < grid_.count(); ++i)
    if (region_of_sample_[i] >= 0) old_ids[i] = regions_[region_of_sample_[i]].id;
  std::vector<int> sign_of;
  region_of_sample_ = grow_regions(sign_of);
  fit_cones(sign_of);
  assign_ids(old_ids);
}

static void archive(Serializer& a, CurvedRegion& r) {
  a(r.id, r.sign, r.area, r.bend, r.cone.centre, r.cone.scale, r.cone.apex);
}

void Regions::archive(Serializer& a) {
  a(curved_, region_of_sample_, regions_, next_id_);
  const auto known = [&](int region) {
    return region >= -1 && region < static_cast<int>(regions_.size());
  };
  a.require(static_cast<int>(curved_.size()) == grid_.count() &&
            curved_.size() == region_of_sample_.size() &&
            std::all_of(region_of_sample_.begin(), region_of_sample_.end(), known));
}

/// Joins neighbouring sample points that bend to the same side around nearly the same ruling.
/// Specks of less than 1/200 of the sheet count as flat.
std::vector<int> Regions::grow_regions(std::vector<int>& sign_of) const {
  // [1] cosine of the angle between the rulings of neighbours: 26 degrees, as in a fan near its
  // apex
  constexpr double same_ruling = 0.9;
  std::vector<int> label(grid_.count(), -1);
  for (int seed = 0; seed < grid_.count(); ++seed) {
    if (!curved_[seed] || label[seed] >= 0) continue;
    const int number = static_cast<int>(sign_of.size()), sign = bending_[seed].k1 > 0 ? 1 : -1;
    std::vector<int> members{seed};
    label[seed] = number;
    for (std::size_t k = 0; k < members.size(); ++k)
      for (const int j : grid_.neighbours[members[k]]) {
        if (!curved_[j] || label[j] >= 0 || bending_[j].k1 * sign < 0) continue;
        if (std::abs(bending_[j].across.dot(bending_[members[k]].across)) < same_ruling) continue;
        label[j] = number;
        members.push_back(j);
      }
    if (200 * static_cast<int>(members.size()) >= grid_.count())
      sign_of.push_back(sign);
    else
      for (const int j : members) label[j] = -2;
  }
  for (int& l : label) l = std::max(l, -1);
  return label;
}

void Regions::fit_cones(const std::vector<int>& sign_of) {
  regions_.assign(sign_of.size(), CurvedRegion{-1, 0, 0, 0, {}});
  std::vector<std::vector<RulingSample>> samples(sign_of.size());
  const double cell = grid_.step * grid_.step;
  for (int i = 0; i < grid_.count(); ++i) {
    if (region_of_sample_[i] < 0) continue;
    CurvedRegion& region = regions_[region_of_sample_[i]];
    const double k = std::abs(bending_[i].k1);
    region.area += cell;
    region.bend += k * cell;
    samples[region_of_sample_[i]].push_back({grid_.sample_points[i], bending_[i].across, k * k});
  }
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    regions_[r].sign = sign_of[r];
    regions_[r].cone =
        fit_cone(samples[r], std::sqrt(regions_[r].area), options_.cylinder_regularization);
  }
}

/// Each region takes the id of the old region with which it shares most sample points; the largest
/// overlap chooses first.
void Regions::assign_ids(const std::vector<int>& old_ids) {
  std::map<std::pair<int, int>, int> shared;  // (old id, region) -> number of shared sample points
  for (int i = 0; i < grid_.count(); ++i)
    if (region_of_sample_[i] >= 0 && old_ids[i] >= 0) ++shared[{old_ids[i], region_of_sample_[i]}];
  std::vector<std::pair<int, std::pair<int, int>>> claims;
  for (const auto& [pair, sample_points] : shared) claims.emplace_back(-sample_points, pair);
  std::sort(claims.begin(), claims.end());
  std::vector<int> taken;
  for (const auto& [sample_points, pair] : claims) {
    CurvedRegion& region = regions_[pair.second];
    if (region.id >= 0 || std::count(taken.begin(), taken.end(), pair.first)) continue;
    region.id = pair.first;
    taken.push_back(pair.first);
  }
  for (CurvedRegion& region : regions_)
    if (region.id < 0) region.id = next_id_++;
}

}  // namespace paperbake
