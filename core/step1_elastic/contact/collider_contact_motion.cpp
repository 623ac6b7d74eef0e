// Where colliders let a sheet go, and where they take it.

#include "core/geometry/box_of.h"
#include "core/step1_elastic/contact/additive_ccd.h"
#include "core/step1_elastic/contact/collider_contact.h"

#include <algorithm>
#include <array>

namespace paperbake {

Points3 ColliderContact::carried_by(std::size_t c) const {
  constexpr double anywhere = 1;  // [m]
  const ColliderState& a = states_[c];
  Points3 x = start_;
  if (motion_.from[c] == motion_.to[c]) return x;
  for (int v = 0; v < x.rows(); ++v)
    x.row(v) = carried(*motion_.from[c], *motion_.to[c], row(start_, v),
                       a.moved + (a.swept[v] ? anywhere : collider_dhat), a.side[v]);
  return x;
}

/// Flags the vertices of edges and triangles of the sheet that an edge or a corner of the collider
/// may meet in this step: they are carried along with it, however far away they are themselves.
void ColliderContact::find_swept_vertices(std::size_t c) {
  ColliderState& a = states_[c];
  a.swept.assign(held_.size(), 0);
  const Collider &from = *motion_.from[c], &to = *motion_.to[c];
  if (&from == &to) return;
  const double reach = a.moved + collider_dhat;
  const Points3& y = from.mesh().x;
  for (const SheetFeature& feature : a.features) {
    if (feature.corners == 1) continue;
    const TriangleCorners p = corners_of(feature, start_);
    const Eigen::AlignedBox3d near = grown(box_of(p), reach);
    bool meets = false;
    if (feature.corners == 2)
      from.edge_tree().visit(near, [&](int k) {
        const Collider::Edge& edge = from.edges()[k];
        meets |= edge_to_edge({p[0], p[1], row(y, edge.a), row(y, edge.b)}).distance() < reach;
      });
    else
      from.corner_tree().visit(near, [&](int k) {
        const Vector3d corner = row(y, from.corners()[k].vertex);
        meets |= vertex_to_triangle({corner, p[0], p[1], p[2]}).distance() < reach;
      });
    for (int i = 0; meets && i < feature.corners; ++i) a.swept[feature.vertices[i]] = 1;
  }
}

/// Moves from p towards `to` as far as the collider allows, then along its surface.
Vector3d ColliderContact::slide(const Collider& collider, Vector3d p, Vector3d to, int side) const {
  constexpr int max_turns = 4, max_steps = 100;
  constexpr double near_enough = 2e-6;  // [m]
  const double within = (to - p).norm() + collider_dhat;
  SurfacePoint s = collider.nearest(p, std::max(within, 2 * collider.depth()), side);
  if (s.distance < 0) {
    p -= s.distance * s.normal;
    s.distance = 0;
  }
  const double kept = std::min(s.distance, 0.2 * collider_dhat);
  for (int turn = 0; turn < max_turns; ++turn) {
    const Vector3d move = to - p;
    const double length = move.norm();
    double gone = 0;
    bool hit = false;
    for (int k = 0; k < max_steps && gone < length; ++k) {
      s = collider.nearest(p + gone / length * move, length - gone + kept + near_enough, side);
      const double free = s.distance - kept;
      hit = free < near_enough && move.dot(s.normal) < -1e-9 * length;
      if (hit) break;
      gone += std::max(free, near_enough);
    }
    if (!hit && gone >= length) return to;
    p += std::min(1.0, length > 0 ? gone / length : 1) * move;
    const Vector3d rest = to - p;
    to = p + rest - std::min(0.0, rest.dot(s.normal)) * s.normal;
  }
  return p;
}

/// Where the vertex gets to on its way to a target.
Vector3d ColliderContact::reachable(int v, Vector3d to) const {
  for (std::size_t c = 0; c < states_.size(); ++c)
    to = slide(collider(c), row(states_[c].carried, v), to, states_[c].side[v]);
  return to;
}

void ColliderContact::project_outside(PositionConstraints& constraints) const {
  for (PositionConstraint& c : constraints) c.target = reachable(c.vertex, c.target);
}

/// |V|x3 [m] where the colliders take the sheet: each vertex goes with the one that moves it
/// farthest.
Points3 ColliderContact::taken_along() const {
  Points3 taken = start_;
  for (const ColliderState& by_this : states_)
    for (int v = 0; v < taken.rows(); ++v)
      if ((by_this.carried.row(v) - start_.row(v)).squaredNorm() >
          (taken.row(v) - start_.row(v)).squaredNorm())
        taken.row(v) = by_this.carried.row(v);
  return taken;
}

void ColliderContact::project_outside(Points3& to) {
  Points3 from = taken_along(), move = to - from;
  for (int v = 0; v < to.rows(); ++v) {
    if (held_[v]) {
      from.row(v) = to.row(v);
      move.row(v).setZero();
    } else {
      move.row(v) = reachable(v, row(to, v)).transpose() - from.row(v);
    }
  }
  to = from + collision_free_step(from, move) * move;
}

/// What is left of a share of the motion when no vertex may go deeper into the collider than it
/// may.
double ColliderContact::free_share_of_vertices(std::size_t c, const Points3& y,
                                               const Points3& motion, double share) const {
  constexpr double near_enough = 2e-5;  // [m]
  const Collider& collider = this->collider(c);
  for (int v = 0; v < y.rows(); ++v) {
    const double length = motion.row(v).norm();
    if (length == 0 || held_[v]) continue;
    double floor = 0, gone = 0;
    while (gone < share * length) {
      const SurfacePoint s =
          collider.nearest(row(y, v) + gone / length * row(motion, v),
                           share * length - gone + collider.depth(), states_[c].side[v]);
      if (gone == 0) floor = std::min(floor, s.distance - 2 * near_enough);
      const double free = s.distance - floor;
      if (free < near_enough) break;
      gone += free;
    }
    share = std::min(share, gone / length);
  }
  return share;
}

/// What is left of a share of the motion when an edge or a triangle of the sheet may not pass
/// through an edge or a corner of the collider.
double ColliderContact::free_share_of_feature(std::size_t c, const SheetFeature& feature,
                                              const Points3& y, const Points3& motion,
                                              double share) const {
  const Collider& collider = this->collider(c);
  double fastest = 0;
  Eigen::AlignedBox3d swept;
  for (int i = 0; i < feature.corners; ++i) {
    const Vector3d p = row(y, feature.vertices[i]);
    swept.extend(p).extend(p + share * row(motion, feature.vertices[i]));
    fastest = std::max(fastest, share * motion.row(feature.vertices[i]).norm());
  }
  if (!feature.is_close && fastest < tube) return share;
  const int behind = corners_behind(feature, states_[c].side);
  const auto meet = [&](int k) {
    std::array<Vector3d, 4> x, m;
    const bool edges = feature.corners == 2;
    for (int i = 0; i < feature.corners; ++i) {
      const int at = edges ? i : i + 1;
      x[at] = row(y, feature.vertices[i]);
      m[at] = share * row(motion, feature.vertices[i]);
    }
    const Points3& fixed = collider.mesh().x;
    if (edges) {
      x[2] = row(fixed, collider.edges()[k].a);
      x[3] = row(fixed, collider.edges()[k].b);
      m[2] = m[3] = Vector3d::Zero();
    } else {
      x[0] = row(fixed, collider.corners()[k].vertex);
      m[0] = Vector3d::Zero();
    }
    // what is inside already has to be able to come out
    if (feature_pair(collider, feature, k, y, behind).where != FeaturePair::outside) return;
    const double free = paperbake::collision_free_step(
        x, m, edges ? Features::two_edges : Features::vertex_and_triangle);
    if (free < 1 && free > 0) share *= free;
  };
  if (feature.corners == 2)
    collider.edge_tree().visit(swept, meet);
  else
    collider.corner_tree().visit(swept, meet);
  return share;
}

double ColliderContact::collision_free_step(const Points3& y, const Points3& move) {
  double share = 1;
  for (std::size_t c = 0; c < states_.size(); ++c) {
    refresh(c, y);
    share = free_share_of_vertices(c, y, move, share);
    for (const SheetFeature& feature : states_[c].features)
      if (feature.corners > 1) share = free_share_of_feature(c, feature, y, move, share);
  }
  return share;
}

}  // namespace paperbake
