#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

struct StrainLimitOptions {
  double limit = 0.02;  // [1] |l - L|/L that an edge may have
  // [1] at most, over the edges that are beyond it; in a crumple 10 leave 6 %, 30 leave 3-5 %
  int sweeps = 60;
};

/// Brings edges that are much too long or too short back to the limit, and moves nothing else:
/// where a fold runs beside the edges of a mesh, it cuts through triangles and leaves them too
/// short across it, by a fifth and more. Edge after edge, in their order, both ends go along it by
/// half of what is too much, again and again, until none is beyond.
/// source  [Provot 1995], with a limit for shortening too
class StrainLimit {
 public:
  StrainLimit(const Points2& pattern, const Triangles&, const StrainLimitOptions& = {});

  /// x  |V|x3 [m];  held  |V| vertices that stay. Several threads may ask at the same time.
  void operator()(Points3& x, const std::vector<char>& held) const;

  double worst(const Points3& x) const;  // [1] largest |l - L|/L of an edge

 private:
  struct Edge {
    int a, b;
    double rest;  // [m]
  };
  std::vector<Edge> edges_;
  std::vector<int> start_, of_vertex_;  // edges of each vertex
  StrainLimitOptions options_;
};

}  // namespace paperbake
