#include "core/animation/handle_constraints.h"

#include <algorithm>
#include <map>

namespace paperbake {

HandleConstraints::HandleConstraints(const Shot& shot, std::vector<int> vertices, int first_frame)
    : handles_(shot.handles),
      vertex_(std::move(vertices)),
      first_frame_(first_frame),
      jammed_beyond_(std::min(1e-4, 1e-3 * longer_side(shot.pattern))),
      grip_(grip_on(shot.paper)),
      feasibility_(shot.pattern, shot.handles),
      offset_(shot.handles.size()) {}

bool HandleConstraints::is_active(std::size_t h, int frame) const {
  const Handle& handle = handles_[h];
  return handle.held(frame) && (handle.mode == HandleMode::absolute || offset_[h]);
}

Vector3d HandleConstraints::keyed(std::size_t h, int frame) const {
  const Handle& handle = handles_[h];
  const Vector3d now = keyed_position(handle, frame - first_frame_);
  return offset_[h] ? Vector3d(*offset_[h] + now) : now;
}

void HandleConstraints::bind_relative_handles(const Points3& x, int frame) {
  for (std::size_t h = 0; h < handles_.size(); ++h)
    if (handles_[h].mode == HandleMode::relative && handles_[h].held(frame) && !offset_[h])
      offset_[h] =
          x.row(vertex_[h]).transpose() - keyed_position(handles_[h], frame - first_frame_);
}

PositionConstraints HandleConstraints::held(int frame) const {
  std::vector<int> hard, soft;
  for (std::size_t h = 0; h < handles_.size(); ++h)
    if (is_active(h, frame))
      (handles_[h].stiffness > 0 ? soft : hard).push_back(static_cast<int>(h));
  Points3 targets(hard.size(), 3);
  for (std::size_t k = 0; k < hard.size(); ++k) targets.row(k) = keyed(hard[k], frame);
  feasibility_.project(hard, targets);
  // Two handles on one vertex hold it at the mean of their targets, soft ones weighted by their
  // stiffness. Beside a hard handle a soft one has no effect.
  struct Pull {
    // sum of the targets; for soft handles of stiffness x target
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double weight = 0, stiffness = 0;
    bool is_hard = false;
  };
  std::map<int, Pull> by_vertex;
  for (std::size_t k = 0; k < hard.size(); ++k) {
    Pull& pull = by_vertex[vertex_[hard[k]]];
    pull.sum += targets.row(k);
    pull.weight += 1;
    pull.is_hard = true;
  }
  for (const int h : soft) {
    Pull& pull = by_vertex[vertex_[h]];
    if (pull.is_hard) continue;
    pull.sum += handles_[h].stiffness * keyed(h, frame).transpose();
    pull.weight = pull.stiffness += handles_[h].stiffness;
  }
  PositionConstraints held;
  for (const auto& [vertex, pull] : by_vertex)
    held.push_back({vertex, pull.sum / pull.weight, pull.stiffness, grip_});
  return held;
}

std::vector<HandleFrame> HandleConstraints::report(const Points3& x, int frame) const {
  std::vector<HandleFrame> frames(handles_.size());
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    frames[h].keyed = keyed(h, frame);
    frames[h].at = x.row(vertex_[h]);
    if (!is_active(h, frame)) continue;
    frames[h].state = HandleFrame::held;
    if (handles_[h].stiffness > 0)
      frames[h].state = HandleFrame::soft;
    else if (frames[h].error() > jammed_beyond_)
      frames[h].state = HandleFrame::jammed;
  }
  return frames;
}

void HandleConstraints::archive(Serializer& a) {
  a(offset_);
  a.require(offset_.size() == handles_.size());
}

}  // namespace paperbake
