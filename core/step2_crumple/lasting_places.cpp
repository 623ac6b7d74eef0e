#include "core/step2_crumple/lasting_places.h"

#include "core/model/serializer.h"

#include <algorithm>

namespace paperbake {

std::vector<double> LastingPlaces::see(const std::vector<Seen>& now, double travel) {
  std::vector<Place> places;
  std::vector<double> lasted_for;
  for (const Seen& s : now) {
    double lasted = travel;
    for (const Place& old : seen_)
      if ((old.p - s.p).norm() < s.reach) lasted = std::max(lasted, old.travel + travel);
    places.push_back({s.p, lasted});
    lasted_for.push_back(lasted);
  }
  seen_ = std::move(places);
  return lasted_for;
}

std::vector<Vector2d> LastingPlaces::places() const {
  std::vector<Vector2d> all;
  for (const Place& place : seen_) all.push_back(place.p);
  return all;
}

void LastingPlaces::archive(Serializer& a) {
  std::vector<std::pair<Vector2d, double>> places;
  for (const Place& place : seen_) places.emplace_back(place.p, place.travel);
  a(places);
  seen_.clear();
  for (const auto& [p, travel] : places) seen_.push_back({p, travel});
}

}  // namespace paperbake
