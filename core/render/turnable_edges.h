#pragma once

#include "core/model/sheet.h"

#include <map>
#include <set>
#include <utility>

namespace paperbake {

/// The edges of a triangulation, to be looked up and flipped.
class TurnableEdges {
 public:
  /// pattern    |V|x2 [m]
  /// triangles  |T|x3 counter-clockwise; edges are flipped in it
  TurnableEdges(const Points2& pattern, Triangles& triangles);
  bool has(int a, int b) const;
  /// Makes a-b an edge if it crosses exactly one edge and the flip makes no needle.
  /// keep     edges (smaller vertex first) that are not flipped
  /// returns  whether it is an edge now
  bool turn_to(int a, int b, const std::set<std::pair<int, int>>& keep);
  /// A vertex between a and b, which are not neighbours, nearer to their segment than `off` [m];
  /// -1: none.
  int between(int a, int b, double off) const;

 private:
  void enter(int t);
  int third(int t, int a, int b) const;
  double min_angle(int a, int b, int c) const;

  const Points2& pattern_;
  Triangles& triangles_;
  std::map<std::pair<int, int>, int> left_;  // triangle on the left of each directed edge
};

}  // namespace paperbake
