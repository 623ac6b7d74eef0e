#pragma once

#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace paperbake::validation {

/// One line of the table.
struct Row {
  std::string name;  // of the case, mesh or method
  std::string quantity;
  double expected = 0, got = 0;
  double tolerance = 0;  // relative; absolute where `expected` is 0; 0: shown but not judged
  std::string source;
  std::string cannot;  // what a method cannot do, and why; then nothing was measured

  bool judged() const { return cannot.empty() && tolerance > 0; }
  double off() const { return expected == 0 ? got : got / expected - 1; }
  bool passed() const { return !judged() || std::abs(off()) <= tolerance; }
};
using Rows = std::vector<Row>;

Rows elastica();     // V1
Rows cantilever();   // V2
Rows d_cone();       // V3
Rows e_cone();       // V4
Rows ridge();        // V5
Rows moebius();      // V6
Rows wound_strip();  // V7
Rows crumple();      // V8
Rows exactness();    // V9

/// The methods for a paper of this shape, with their names. The number of hybrid is that of its
/// first triangles; the number of adaptive is its upper limit.
inline std::vector<std::pair<std::string, MethodChoice>> methods(const Pattern& pattern,
                                                                 const Paper& paper) {
  return {{"fem 1700", fem(1700)},
          {"hybrid 120", hybrid(pattern, paper, 120, {}, 0, 0)},
          {"adaptive 3000", adaptive(pattern, 3000)}};
}

/// The vertices for which `test` is true of their position on the pattern.
template <class Test>
std::vector<int> vertices_where(const Sheet& sheet, const Test& test) {
  std::vector<int> found;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (test(Vector2d(sheet.pattern.row(v)))) found.push_back(v);
  return found;
}

}  // namespace paperbake::validation
