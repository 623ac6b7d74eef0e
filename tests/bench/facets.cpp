#include "tests/bench/facets.h"

#include "core/model/segment2.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

namespace paperbake {
namespace {

double pattern_area(const Sheet& sheet, int t) {
  const Vector2d a = sheet.pattern.row(sheet.triangles(t, 0)),
                 b = sheet.pattern.row(sheet.triangles(t, 1)),
                 c = sheet.pattern.row(sheet.triangles(t, 2));
  return 0.5 * cross(b - a, c - a);
}

Vector2d edge_of(const Sheet& sheet, const Hinge& hinge) {
  return sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0]);
}

/// Regularised lower incomplete gamma function P(s, x).
/// source  [Abramowitz 1964] 6.5.29 (series), 6.5.31 (continued fraction)
double lower_gamma(double s, double x) {
  if (!(x > 0)) return 0;
  const double front = std::exp(-x + s * std::log(x) - std::lgamma(s));
  if (x < s + 1) {
    double term = 1 / s, sum = term;
    for (double k = s + 1; term > 1e-15 * sum; ++k) sum += term *= x / k;
    return front * sum;
  }
  double b = x + 1 - s, c = 1e300, d = 1 / b, fraction = d;
  for (int i = 1; i < 1000; ++i) {
    const double an = -i * (i - s);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return 1 - front * fraction;
}

/// Sums over the triangles of facets.
struct Carried {
  Eigen::Matrix2d force = Eigen::Matrix2d::Zero();  // [N m] stress times area
  double area = 0, membrane = 0, bending = 0;       // [m2] [J] [J]
  void add(const Carried& other) {
    force += other.force;
    area += other.area;
    membrane += other.membrane;
    bending += other.bending;
  }
};

/// The sums of each facet and of those beside it.
std::vector<Carried> with_neighbours(const std::vector<Carried>& own, const Hinges& hinges,
                                     const Facets& facets) {
  std::set<std::pair<int, int>> neighbours;
  for (const Hinge& hinge : hinges.hinges) {
    const int a = facets.of_triangle[hinge.triangles[0]],
              b = facets.of_triangle[hinge.triangles[1]];
    if (a != b) neighbours.emplace(std::min(a, b), std::max(a, b));
  }
  std::vector<Carried> sums = own;
  for (const auto& [a, b] : neighbours) {
    sums[a].add(own[b]);
    sums[b].add(own[a]);
  }
  return sums;
}

}  // namespace

Facets find_facets(const Sheet& sheet, const Hinges& hinges, const std::vector<double>& turn,
                   double crease) {
  const int triangles = static_cast<int>(sheet.triangles.rows());
  std::vector<int> parent(triangles);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  for (std::size_t h = 0; h < hinges.hinges.size(); ++h)
    if (!(std::abs(turn[h]) > crease))
      parent[root(hinges.hinges[h].triangles[0])] = root(hinges.hinges[h].triangles[1]);
  Facets facets;
  facets.of_triangle.assign(triangles, -1);
  std::vector<int> number(triangles, -1);
  for (int t = 0; t < triangles; ++t) {
    int& n = number[root(t)];
    if (n < 0) {
      n = static_cast<int>(facets.area.size());
      facets.area.push_back(0);
    }
    facets.of_triangle[t] = n;
    facets.area[n] += pattern_area(sheet, t);
  }
  for (const Hinge& hinge : hinges.hinges)
    if (facets.of_triangle[hinge.triangles[0]] != facets.of_triangle[hinge.triangles[1]])
      facets.crease_length += edge_of(sheet, hinge).norm();
  return facets;
}

std::vector<double> plastic_turns(const Sheet& sheet, const Hinges& hinges,
                                  const PlasticMemory& memory) {
  std::vector<double> turns;
  for (const Hinge& hinge : hinges.hinges) {
    const Vector2d edge = edge_of(sheet, hinge);
    const double length = edge.norm();
    const Vector2d n = Vector2d(-edge.y(), edge.x()) / length;
    double turn = 0;
    for (const int t : hinge.triangles) {
      const Eigen::RowVector3d S = memory.curvature.row(t);
      turn += pattern_area(sheet, t) / length *
              (S[0] * n.x() * n.x() + 2 * S[1] * n.x() * n.y() + S[2] * n.y() * n.y());
    }
    turns.push_back(turn);
  }
  return turns;
}

FacetLaw::FacetLaw(double height, double radius)
    : t(2 / (radius * radius) * (1 - height * height) *
        std::log1p(9.031 * radius * radius / std::sqrt(2 * M_PI) / (height * (1 + height)))),
      a(std::sqrt(t / 24.04)) {}

double FacetLaw::facets() const { return t * t / (a * (a + 1)); }

double FacetLaw::crease_length() const { return 2.1227 * t / (a + 1); }

double FacetLaw::share_below(double root_of_area) const { return lower_gamma(a, t * root_of_area); }

double distance_from_law(std::vector<double> areas, const FacetLaw& law) {
  std::sort(areas.begin(), areas.end());
  const double n = static_cast<double>(areas.size());
  double most = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double share = law.share_below(std::sqrt(areas[i]));
    most = std::max({most, std::abs(share - i / n), std::abs(share - (i + 1) / n)});
  }
  return most * std::sqrt(n);
}

std::vector<FacetLoad> facet_loads(const Sheet& sheet, const Hinges& hinges, const Facets& facets,
                                   const Paper& paper, const std::vector<Eigen::Matrix2d>& stress,
                                   const LocalEnergies& stored) {
  std::vector<Carried> own(facets.area.size());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const double area = pattern_area(sheet, t);
    own[facets.of_triangle[t]].add({area * stress[t], area, stored.membrane[t], stored.bending[t]});
  }
  std::vector<FacetLoad> loads;
  for (const Carried& c : with_neighbours(own, hinges, facets)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(
        Eigen::Matrix2d(c.force / c.area));
    const double stored_in_all = c.membrane + c.bending;
    loads.push_back({-principal.eigenvalues()[0] / (4 * M_PI * M_PI * paper.bending_stiffness),
                     stored_in_all > 0 ? c.membrane / stored_in_all : 0,
                     principal.eigenvectors().col(0), 0});
  }
  std::vector<double> low(loads.size(), std::numeric_limits<double>::max()), high(low);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int f = facets.of_triangle[t];
      const double at = sheet.pattern.row(sheet.triangles(t, i)).dot(loads[f].direction);
      low[f] = std::min(low[f], at);
      high[f] = std::min(high[f], -at);
    }
  for (std::size_t f = 0; f < loads.size(); ++f) {
    loads[f].width = -high[f] - low[f];
    loads[f].load *= loads[f].width * loads[f].width;
  }
  return loads;
}

}  // namespace paperbake
