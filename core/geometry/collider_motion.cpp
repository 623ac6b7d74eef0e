#include "core/geometry/collider_motion.h"

#include "core/geometry/measure.h"
#include "core/geometry/proximity.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace paperbake {
namespace {

/// Where the vertices of a collider are in a frame.
const Points3& positions_at(const Collider& collider, int row) {
  const std::vector<Points3>& frames = collider.frames();
  if (frames.empty()) return collider.mesh().x;
  return frames[std::clamp(row, 0, static_cast<int>(frames.size()) - 1)];
}

std::shared_ptr<const Collider> shape_at(const Collider& collider, int row) {
  const Points3& x = positions_at(collider, row);
  if (&x == &collider.mesh().x || x == collider.mesh().x)
    return {std::shared_ptr<void>(), &collider};
  return std::make_shared<const Collider>(collider, x);
}

}  // namespace

ColliderShapes shapes_at(const Colliders& colliders, int row) {
  ColliderShapes shapes;
  for (const Collider& c : colliders) shapes.push_back(shape_at(c, row));
  return shapes;
}

ColliderMotion motion_to(const Colliders& colliders, int row) {
  return motion_to(colliders, row, shapes_at(colliders, row - 1));
}

ColliderMotion motion_to(const Colliders& colliders, int row, ColliderShapes before) {
  ColliderMotion motion{std::move(before), {}};
  for (std::size_t c = 0; c < colliders.size(); ++c)
    motion.to.push_back(motion.from[c]->mesh().x == positions_at(colliders[c], row)
                            ? motion.from[c]
                            : shape_at(colliders[c], row));
  return motion;
}

double farthest_move(const Colliders& colliders, int from, int to) {
  double most = 0;
  for (const Collider& c : colliders)
    most = std::max(
        most, (positions_at(c, to) - positions_at(c, from)).rowwise().squaredNorm().maxCoeff());
  return std::sqrt(most);
}

ColliderShapes between(const ColliderShapes& a, const ColliderShapes& b, double share) {
  ColliderShapes on_the_way;
  for (std::size_t c = 0; c < a.size(); ++c)
    on_the_way.push_back(
        a[c] == b[c] ? b[c]
                     : std::make_shared<const Collider>(
                           *b[c], Points3((1 - share) * a[c]->mesh().x + share * b[c]->mesh().x)));
  return on_the_way;
}

void archive_shapes(Serializer& a, ColliderShapes& shapes, const Colliders& colliders) {
  if (a.reads()) shapes.clear();
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const Collider& first = colliders[c];
    Points3 x;  // [m] none: those of the first frame
    if (!a.reads() && shapes[c].get() != &first) x = shapes[c]->mesh().x;
    a(x);
    if (!a.reads()) continue;
    a.require(x.rows() == 0 || (x.rows() == first.mesh().x.rows() && x.allFinite()));
    if (x.rows() == 0)
      shapes.emplace_back(std::shared_ptr<void>(), &first);
    else
      shapes.push_back(std::make_shared<const Collider>(first, x));
  }
}

double farthest_move(const Collider& from, const Collider& to) {
  return &from == &to ? 0 : max_row_norm(to.mesh().x - from.mesh().x);
}

double farthest_move(const ColliderShapes& from, const ColliderShapes& to) {
  double most = 0;
  for (std::size_t c = 0; c < from.size(); ++c)
    most = std::max(most, farthest_move(*from[c], *to[c]));
  return most;
}

namespace {

/// The rotation from x, y, z to a triangle: its first edge, its normal, and across both.
Eigen::Matrix3d frame_of(const std::array<Vector3d, 3>& corners) {
  Eigen::Matrix3d frame;
  frame.col(0) = (corners[1] - corners[0]).normalized();
  frame.col(1) = triangle_normal(corners[0], corners[1], corners[2]);
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

Vector3d carried(const Collider& from, const Collider& to, const Vector3d& p, double within,
                 int side) {
  if (&from == &to) return p;
  const SurfacePoint near = from.nearest(p, within, side);
  if (near.triangle < 0) return p;
  std::array<Vector3d, 3> before, after;
  for (int i = 0; i < 3; ++i) {
    const int v = from.mesh().triangles(near.triangle, i);
    before[i] = from.mesh().x.row(v);
    after[i] = to.mesh().x.row(v);
  }
  const ClosestPoints at = vertex_to_triangle({p, before[0], before[1], before[2]});
  const Vector3d there =
      -(at.weights[1] * after[0] + at.weights[2] * after[1] + at.weights[3] * after[2]);
  return there + frame_of(after) * (frame_of(before).transpose() * (p - near.at));
}

double push_out(const ColliderShapes& colliders, const Points3& known, double clearance,
                Points3& x) {
  constexpr int max_passes = 3;  // a point that is pushed out may have entered elsewhere
  double deepest_found = 0;
  for (const auto& shape : colliders) {
    const Collider& collider = *shape;
    for (int v = 0; v < x.rows(); ++v) {
      const double range = (x.row(v) - known.row(v)).norm() + collider.depth();
      if (!collider.closed() &&
          collider.nearest(x.row(v).transpose(), range + clearance, 1).triangle < 0)
        continue;
      const int side = collider.side_of(x.row(v).transpose(), known.row(v).transpose(),
                                        range + 3 * collider.depth());
      for (int k = 0; k < max_passes; ++k) {
        const SurfacePoint near = collider.nearest(x.row(v).transpose(), range + clearance, side);
        if (!(near.distance < clearance)) break;
        if (k == 0) deepest_found = std::max(deepest_found, -near.distance);
        x.row(v) += (clearance - near.distance) * near.normal.transpose();
      }
    }
  }
  return deepest_found;
}

}  // namespace paperbake
