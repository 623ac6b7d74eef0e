#include "core/hands/handle_feasibility.h"

#include "core/geometry/measure.h"

#include <algorithm>

namespace paperbake {

HandleFeasibility::HandleFeasibility(const Pattern& pattern, const std::vector<Handle>& handles) {
  const int n = static_cast<int>(handles.size());
  paper_.setZero(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      paper_(i, j) = paper_(j, i) = paper_distance(pattern, handles[i].pattern, handles[j].pattern);
}

std::vector<UnreachablePair> HandleFeasibility::impossible_pairs(const std::vector<Handle>& handles,
                                                                 int first_frame,
                                                                 int last_frame) const {
  std::vector<UnreachablePair> pairs;
  for (std::size_t i = 0; i < handles.size(); ++i)
    for (std::size_t j = i + 1; j < handles.size(); ++j) {
      const Handle &a = handles[i], &b = handles[j];
      if (a.mode == HandleMode::relative || b.mode == HandleMode::relative) continue;
      if (a.stiffness > 0 || b.stiffness > 0) continue;  // a soft handle gives way
      UnreachablePair pair{a.name, b.name, 0, 0, 0, 0, paper_(i, j)};
      double worst = 0;
      for (int frame = first_frame; frame <= last_frame; ++frame) {
        if (!a.held(frame) || !b.held(frame)) continue;
        const double apart =
            (keyed_position(a, frame - first_frame) - keyed_position(b, frame - first_frame))
                .norm();
        const double over = apart - limit(i, j);
        if (over <= unseen) continue;
        if (worst == 0) pair.first = frame;
        pair.last = frame;
        if (over > worst) {
          worst = over;
          pair.frame = frame;
          pair.apart = apart;
        }
      }
      if (worst > 0) pairs.push_back(pair);
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const UnreachablePair& p, const UnreachablePair& q) {
                     return p.apart - p.allowed > q.apart - q.allowed;
                   });
  return pairs;
}

double HandleFeasibility::project(const std::vector<int>& handles, Points3& targets) const {
  // [1] sweeps towards the nearest feasible result, and in all, unless it settles before; assumed
  constexpr int towards = 300, sweeps = 2000;
  constexpr double settled = 1e-9;  // [m] overshoot that nobody can see
  const Points3 asked = targets;
  const int n = static_cast<int>(handles.size());
  // [Dykstra 1983]: each pair first takes back its own correction of the sweep before; otherwise
  // the result would be feasible, but not the nearest one. The last sweeps leave this out and so
  // end at a feasible result.
  Points3 correction = Points3::Zero(n * n, 3);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double change = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) {
        auto mine = correction.row(i * n + j);  // the correction of j is its opposite
        if (sweep >= towards) mine.setZero();
        const Eigen::RowVector3d d = targets.row(i) - targets.row(j) + 2 * mine;
        const double apart = d.norm(), over = apart - limit(handles[i], handles[j]);
        const Eigen::RowVector3d now = over > (sweep < towards ? 0 : settled)
                                           ? Eigen::RowVector3d(0.5 * over / apart * d)
                                           : Eigen::RowVector3d::Zero();
        const Eigen::RowVector3d move = mine - now;
        if (move.isZero(0)) continue;
        targets.row(i) += move;
        targets.row(j) -= move;
        mine = now;
        change = std::max(change, move.norm());
      }
    if (change == 0) break;
    if (change <= settled) sweep = std::max(sweep, towards - 1);
  }
  return max_row_norm(targets - asked);
}

Overshoot overshoot(const Pattern& pattern, const std::vector<Handle>& handles,
                    const std::vector<HandleFrame>& frame, int handle) {
  Overshoot worst;
  const Vector2d& from = handles[handle].pattern;
  for (int other = 0; other < static_cast<int>(frame.size()); ++other) {
    const HandleFrame& held = frame[other];
    if (other == handle || (held.state != HandleFrame::held && held.state != HandleFrame::jammed))
      continue;
    const Vector2d& to = handles[other].pattern;
    const double apart = (frame[handle].keyed - held.keyed).norm() - HandleFeasibility::unseen;
    // the way on the paper is not shorter than a straight line
    if (apart - HandleFeasibility::reach((to - from).norm()) <= worst.length) continue;
    const double over = apart - HandleFeasibility::reach(paper_distance(pattern, from, to));
    if (over > worst.length) worst = {other, over};
  }
  return worst;
}

}  // namespace paperbake
