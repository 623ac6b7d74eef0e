#pragma once

#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

struct StrainLimitOptions {
  double limit = 0.02;  // [1] largest |l - L|/L allowed
  // [1] the same, one after the other, as long as only a few edges are beyond it, at most this
  // share of all: where folds cross, but not in a crumple, where it would take many sweeps
  std::array<double, 2> aims{0.005, 0.003};
  double few = 0.01;
  // [1] at most, over the edges beyond the limit; in a crumple 10 leave an error of 6 %, 30 of
  // 3-5 %
  int sweeps = 60;
};

/// Brings edges that are much too long or too short back to the limit and moves nothing else. Such
/// edges arise where a fold does not run along the edges of a mesh: it cuts through triangles and
/// leaves them too short across it, by a fifth and more. Edge by edge, in their order, both ends
/// move along the edge, each by half of the excess; this is repeated until no edge is beyond the
/// limit, and then with lower ones where few edges are beyond these.
/// source  [Provot 1995], extended to edges that are too short
class StrainLimit {
 public:
  StrainLimit(const Points2& pattern, const Triangles&, const StrainLimitOptions& = {});

  /// x     |V|x3 [m]
  /// held  |V| vertices that stay where they are
  /// May be called by several threads at the same time.
  void operator()(Points3& x, const std::vector<char>& held) const;

  double worst(const Points3& x) const;  // [1] largest |l - L|/L of an edge

 private:
  bool is_beyond(double limit, std::size_t edge, const Points3& x) const;
  /// The edges that are beyond a limit, in their order.
  std::vector<int> beyond(double limit, const Points3& x) const;
  /// edges    those that are beyond the limit
  /// returns  whether none is any more
  bool limit_to(double limit, std::vector<int> edges, Points3& x,
                const std::vector<char>& held) const;

  struct Edge {
    int a, b;
    double rest;  // [m]
  };
  std::vector<Edge> edges_;
  std::vector<int> start_, of_vertex_;  // edges of each vertex
  StrainLimitOptions options_;
};

}  // namespace paperbake
