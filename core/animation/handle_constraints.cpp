#include "core/animation/handle_constraints.h"

#include <algorithm>
#include <map>

namespace paperbake {

Grip::Grip(const Shot& shot, std::vector<int> vertices, int first_frame)
    : handles_(shot.handles),
      colliders_(shot.colliders.get()),
      vertex_(std::move(vertices)),
      first_frame_(first_frame),
      exact_(std::min(1e-4, 1e-3 * longer_side(shot.pattern))),
      reach_(shot.pattern, shot.handles),
      anchor_(shot.handles.size()) {}

bool Grip::holds(std::size_t h, int frame) const {
  const Handle& handle = handles_[h];
  return handle.held(frame) && (handle.mode == HandleMode::absolute || anchor_[h]);
}

Vector3d Grip::keyed(std::size_t h, int frame) const {
  const Handle& handle = handles_[h];
  const Vector3d now = keyed_position(handle, frame - first_frame_);
  return anchor_[h] ? Vector3d(*anchor_[h] + now) : now;
}

void Grip::anchor(const Points3& x, int frame) {
  for (std::size_t h = 0; h < handles_.size(); ++h)
    if (handles_[h].mode == HandleMode::relative && handles_[h].held(frame) && !anchor_[h])
      anchor_[h] =
          x.row(vertex_[h]).transpose() - keyed_position(handles_[h], frame - first_frame_);
}

Held Grip::held(int frame) const {
  std::vector<int> hard, soft;
  for (std::size_t h = 0; h < handles_.size(); ++h)
    if (holds(h, frame)) (handles_[h].stiffness > 0 ? soft : hard).push_back(static_cast<int>(h));
  Points3 targets(hard.size(), 3);
  for (std::size_t k = 0; k < hard.size(); ++k) targets.row(k) = keyed(hard[k], frame);
  reach_.project(hard, targets);
  // Two handles on one vertex hold it at the mean of their targets, soft ones weighted by their
  // stiffness. Beside a hard handle a soft one has no effect.
  struct Pull {
    // sum of the targets; for soft handles of stiffness x target
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double weight = 0, stiffness = 0;
  };
  std::map<int, Pull> by_vertex;
  for (std::size_t k = 0; k < hard.size(); ++k) {
    Pull& pull = by_vertex[vertex_[hard[k]]];
    pull.sum += targets.row(k);
    pull.weight += 1;
  }
  for (const int h : soft) {
    Pull& pull = by_vertex[vertex_[h]];
    if (pull.weight > pull.stiffness) continue;  // held by a hard handle
    pull.sum += handles_[h].stiffness * keyed(h, frame).transpose();
    pull.weight = pull.stiffness += handles_[h].stiffness;
  }
  Held held;
  held.targets.resize(by_vertex.size(), 3);
  for (const auto& [vertex, pull] : by_vertex) {
    held.targets.row(held.vertices.size()) = pull.sum / pull.weight;
    held.vertices.push_back(vertex);
    held.stiffness.push_back(pull.stiffness);
  }
  if (colliders_)
    held.colliders = {poses_at(*colliders_, frame - 1 - first_frame_),
                      poses_at(*colliders_, frame - first_frame_)};
  return held;
}

std::vector<HandleFrame> Grip::report(const Points3& x, int frame) const {
  std::vector<HandleFrame> frames(handles_.size());
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    frames[h].keyed = keyed(h, frame);
    frames[h].at = x.row(vertex_[h]);
    if (!holds(h, frame)) continue;
    const bool soft = handles_[h].stiffness > 0;  // a soft handle is meant to lag
    frames[h].state = !soft && (frames[h].at - frames[h].keyed).norm() > exact_
                          ? HandleFrame::jammed
                          : HandleFrame::held;
  }
  return frames;
}

void Grip::archive(Archive& a) {
  a(anchor_);
  a.demand(anchor_.size() == handles_.size());
}

}  // namespace paperbake
