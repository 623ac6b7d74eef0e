#include "core/step1_elastic/contact/collider_contact.h"

#include "core/geometry/box_of.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/step1_elastic/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

constexpr double in_cone = 0.1;  // [1] sine by which the way out may lean along a face

}  // namespace

ColliderContact::ColliderContact(std::shared_ptr<const Colliders> colliders,
                                 const Triangles& triangles, int vertices)
    : colliders_(std::move(colliders)),
      states_(colliders_->size()),
      held_(vertices, 0),
      reduction_(vertices, 0.0) {
  std::vector<SheetFeature> features;
  for (int v = 0; v < vertices; ++v) features.push_back({{v, -1, -1}, 1, {}});
  for (const MeshEdge& e : MeshEdges(triangles)) features.push_back({{e.low, e.high, -1}, 2, {}});
  for (int t = 0; t < triangles.rows(); ++t)
    features.push_back({{triangles(t, 0), triangles(t, 1), triangles(t, 2)}, 3, {}});
  for (ColliderState& a : states_) {
    a.features = features;
    a.reference = Points3::Constant(vertices, 3, std::numeric_limits<double>::quiet_NaN());
    a.side.assign(vertices, 1);
  }
}

TriangleCorners ColliderContact::corners_of(const SheetFeature& feature, const Points3& x) {
  TriangleCorners p;
  for (int i = 0; i < 3; ++i) p[i] = row(x, feature.vertices[i < feature.corners ? i : 0]);
  return p;
}

void ColliderContact::find_candidates(std::size_t c, SheetFeature& feature) const {
  const Collider& collider = this->collider(c);
  const TriangleCorners p = corners_of(feature, states_[c].reference);
  const double within = std::max(collider_dhat, collider.depth()) + tube;
  const Eigen::AlignedBox3d near = grown(box_of(p), within);
  const Points3& z = collider.mesh().x;
  feature.near.clear();
  feature.is_close = false;
  const auto add = [&](int k, double distance) {
    feature.is_close = true;
    if (distance <= within) feature.near.push_back(k);
  };
  if (feature.corners == 1) collider.triangle_tree().visit(near, [&](int k) { add(k, 0); });
  if (feature.corners == 2)
    collider.edge_tree().visit(near, [&](int k) {
      const Collider::Edge& edge = collider.edges()[k];
      add(k, edge_to_edge({p[0], p[1], row(z, edge.a), row(z, edge.b)}).distance());
    });
  if (feature.corners == 3)
    collider.corner_tree().visit(near, [&](int k) {
      const Vector3d corner = row(z, collider.corners()[k].vertex);
      add(k, vertex_to_triangle({corner, p[0], p[1], p[2]}).distance());
    });
  std::sort(feature.near.begin(), feature.near.end());
}

/// Rebuilds the lists of the features that have moved.
void ColliderContact::refresh(std::size_t c, const Points3& y) {
  ColliderState& a = states_[c];
  if (a.of != &collider(c)) {
    a.of = &collider(c);
    a.reference.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  std::vector<char> stale(y.rows(), 0);
  bool any = false;
  for (int v = 0; v < y.rows(); ++v)
    if (!((y.row(v) - a.reference.row(v)).squaredNorm() <= tube * tube)) {
      stale[v] = 1;
      any = true;
    }
  if (!any) return;
  for (int v = 0; v < y.rows(); ++v)
    if (stale[v]) a.reference.row(v) = y.row(v);
  a.close.clear();
  for (std::size_t k = 0; k < a.features.size(); ++k) {
    SheetFeature& feature = a.features[k];
    bool moved = false;
    for (int i = 0; i < feature.corners; ++i) moved |= stale[feature.vertices[i]] != 0;
    if (moved) find_candidates(c, feature);
    if (feature.is_close) a.close.push_back(static_cast<int>(k));
  }
}

/// Whether a line from the sheet to a feature of a collider leads out of its face.
static bool leads_out(const Vector3d& n, const Vector3d& inward) {
  return n.dot(inward) <= in_cone * n.norm();
}

/// An edge of the sheet and the k-th edge of the collider.
/// behind  how many corners of the edge touch the collider from behind
ColliderContact::FeaturePair ColliderContact::edge_pair(const Collider& collider, const EdgeEnds& y,
                                                        int k, int behind) const {
  const Points3& x = collider.mesh().x;
  const Collider::Edge& edge = collider.edges()[k];
  const ClosestPoints near = edge_to_edge({y[0], y[1], row(x, edge.a), row(x, edge.b)});
  FeaturePair m{{near.weights[0], near.weights[1], 0},
                -near.weights[2] * row(x, edge.a) - near.weights[3] * row(x, edge.b),
                near.apart,
                near.distance(),
                FeaturePair::outside};
  const Vector3d along = row(x, edge.b) - row(x, edge.a), first = edge.inward[0],
                 second = behind == 2 && edge.border ? Vector3d(-edge.inward[1]) : edge.inward[1];
  const bool is_beside_ends = near.weights[2] == 0 || near.weights[3] == 0;
  if (behind == 1) {  // it hangs over a border: inside below it
    if (edge.border && m.apart.dot(first) > 0 && !is_beside_ends && m.weights[0] > 0 &&
        m.weights[1] > 0)
      m.where = FeaturePair::inside;
    return m;
  }
  // the sheet lies beyond the plane of one face, seen from the other face
  const auto above = [&](const Vector3d& face, const Vector3d& other) {
    const Vector3d normal = along.cross(face);
    return m.apart.dot(normal) * normal.dot(other) < 0;
  };
  if (above(first, second) || above(second, first)) return m;
  // beside the ends of the edge the contact of a vertex gives the depth
  const bool out_of_all = leads_out(-m.apart, first) && leads_out(-m.apart, second) &&
                          !is_beside_ends && m.weights[0] > 0 && m.weights[1] > 0;
  m.where = out_of_all ? FeaturePair::inside : FeaturePair::nearer_to_another;
  return m;
}

/// A triangle of the sheet and the k-th corner of the collider.
ColliderContact::FeaturePair ColliderContact::corner_pair(const Collider& collider,
                                                          const TriangleCorners& y, int k,
                                                          int behind) const {
  const Points3& x = collider.mesh().x;
  const Collider::Corner& corner = collider.corners()[k];
  const ClosestPoints near = vertex_to_triangle({row(x, corner.vertex), y[0], y[1], y[2]});
  FeaturePair m{{-near.weights[1], -near.weights[2], -near.weights[3]},
                row(x, corner.vertex),
                -near.apart,
                near.distance(),
                FeaturePair::outside};
  const bool is_within = m.weights[0] > 0 && m.weights[1] > 0 && m.weights[2] > 0;
  Vector3d inward = Vector3d::Zero();
  bool out_of_all = is_within;
  for (const Vector3d& in : corner.inward) {
    inward += in;
    out_of_all = out_of_all && leads_out(-m.apart, in);
  }
  if (behind > 0) {
    const bool hangs_over = behind < 3 && corner.border;
    if (hangs_over && is_within && m.apart.dot(inward - corner.inward.back()) > 0)
      m.where = FeaturePair::inside;
    return m;
  }
  if (m.apart.dot(inward) < 0) return m;
  // outside the triangle the contact of a vertex or an edge gives the depth
  m.where = out_of_all ? FeaturePair::inside : FeaturePair::nearer_to_another;
  return m;
}

/// What an edge or a triangle of the sheet shares with every edge or corner of a collider: tells
/// cheaply of most of them that they cannot touch.
class ColliderContact::NearTest {
 public:
  NearTest(const Collider& collider, const SheetFeature& feature, const Points3& y)
      : collider_(collider), corners_(feature.corners) {
    for (int i = 0; i < corners_; ++i) y_[i] = row(y, feature.vertices[i]);
    if (corners_ == 3) normal_ = triangle_normal(y_[0], y_[1], y_[2]);
  }

  /// True if the feature, of which no corner touches the collider from behind, is farther than
  /// collider_dhat in front of the k-th edge or corner, or farther than depth() from it. It may be
  /// false then, too.
  bool is_apart(int k) const { return corners_ == 2 ? is_edge_apart(k) : is_corner_apart(k); }

 private:
  static constexpr double rounding = 1e-9;  // [1], [m]

  bool is_edge_apart(int k) const {
    const Collider::Edge& edge = collider_.edges()[k];
    const Points3& x = collider_.mesh().x;
    const Vector3d a = row(x, edge.a), b = row(x, edge.b), middle = 0.5 * (a + b),
                   along = y_[1] - y_[0];
    const double share = std::clamp(along.dot(middle - y_[0]) / along.squaredNorm(), 0.0, 1.0);
    const double beyond = (y_[0] + share * along - middle).norm() - 0.5 * (b - a).norm() - rounding;
    if (beyond > std::max(collider_dhat, collider_.depth())) return true;
    const auto is_above = [&](const Vector3d& out) {
      return out.dot(y_[0] - a) > rounding && out.dot(y_[1] - a) > rounding;
    };
    return beyond > collider_dhat && (is_above(edge.outward[0]) || is_above(edge.outward[1]));
  }

  bool is_corner_apart(int k) const {
    const int corner = collider_.corners()[k].vertex;
    const double above = normal_.dot(row(collider_.mesh().x, corner) - y_[0]);
    if (std::abs(above) > std::max(collider_dhat, collider_.depth()) + rounding) return true;
    // In front of all faces it is on the side of their mean normal. What is inside as far as they
    // tell leads out of each of them, at most in_cone off, and so to the other side, or nearly.
    const double lean = (above < 0 ? 1 : -1) * normal_.dot(collider_.vertex_normal(corner));
    return std::abs(above) > collider_dhat + rounding && lean > 2 * in_cone;
  }

  const Collider& collider_;
  int corners_;
  TriangleCorners y_;
  Vector3d normal_;  // of a triangle
};

/// Whether an edge or a triangle of the sheet that lies between the planes of the faces beside an
/// edge or a corner is outside all the same, because one of those faces ends before it. It is where
/// neither its closest point nor what lies beside that, by half of the distance towards the
/// vertices, is inside.
bool ColliderContact::is_in_front(const Collider& collider, const SheetFeature& feature,
                                  const FeaturePair& m, const Points3& y) {
  const auto in_front = [&](const Vector3d& p) {
    return collider.nearest(p, 2 * m.distance, 1).distance > 0;
  };
  Vector3d at = Vector3d::Zero();
  for (int i = 0; i < feature.corners; ++i) at += m.weights[i] * row(y, feature.vertices[i]);
  if (!in_front(at)) return false;
  for (int i = 0; i < feature.corners; ++i) {
    const Vector3d off = row(y, feature.vertices[i]) - at;
    if (!in_front(at + std::min(1.0, 0.5 * m.distance / off.norm()) * off)) return false;
  }
  return true;
}

/// How many corners of a feature of the sheet touch the collider from behind.
int ColliderContact::corners_behind(const SheetFeature& feature,
                                    const std::vector<std::int8_t>& side) {
  int behind = 0;
  for (int i = 0; i < feature.corners; ++i) behind += side[feature.vertices[i]] < 0;
  return behind;
}

/// `inside` is what the faces beside the edge or the corner say: see is_in_front.
ColliderContact::FeaturePair ColliderContact::feature_pair(const Collider& collider,
                                                           const SheetFeature& feature, int k,
                                                           const Points3& y, int behind) const {
  const auto& v = feature.vertices;
  return feature.corners == 2
             ? edge_pair(collider, {row(y, v[0]), row(y, v[1])}, k, behind)
             : corner_pair(collider, {row(y, v[0]), row(y, v[1]), row(y, v[2])}, k, behind);
}

/// Visits every contact of a feature that is inside or nearer than collider_dhat, and others that
/// are farther away: who asks has to look at the distance.
template <class Visit>
void ColliderContact::touches_of(std::size_t c, const SheetFeature& feature, const Points3& y,
                                 Visit visit) const {
  const Collider& collider = this->collider(c);
  const std::vector<std::int8_t>& side = states_[c].side;
  const auto& v = feature.vertices;
  if (feature.corners == 1) {
    for (const SurfacePoint& s : collider.nearest(row(y, v[0]), feature.near, side[v[0]]))
      if (s.distance > -collider.depth() - tube)
        visit(ContactPoint{v, {1, 0, 0}, 1, s.at, s.normal, s.distance});
    return;
  }
  if (feature.near.empty()) return;
  const int behind = corners_behind(feature, side);
  const bool all_in_front = behind == 0;
  const NearTest test(collider, feature, y);
  for (const int k : feature.near) {
    if (all_in_front && test.is_apart(k)) continue;
    const FeaturePair m = feature_pair(collider, feature, k, y, behind);
    if (m.where == FeaturePair::nearer_to_another || m.distance < 1e-12) continue;
    const double sign = m.where == FeaturePair::inside ? -1 : 1;
    if (sign < 0 &&
        (m.distance > collider.depth() || (all_in_front && is_in_front(collider, feature, m, y))))
      continue;
    const Vector3d normal = sign / m.distance * m.apart;
    visit(ContactPoint{v, m.weights, feature.corners, m.at, normal, sign * m.distance});
  }
}

template <class Visit>
void ColliderContact::for_each_touch(std::size_t c, const Points3& y, Visit visit) const {
  const ColliderState& a = states_[c];
  for (const int k : a.close) {
    const SheetFeature& feature = a.features[k];
    bool held = true;
    for (int i = 0; i < feature.corners; ++i) held &= held_[feature.vertices[i]] != 0;
    if (held) continue;
    touches_of(c, feature, y, [&](const ContactPoint& touch) {
      ContactPoint felt = touch;
      if (feature.corners == 1) felt.distance += reduction_[feature.vertices[0]];
      if (felt.distance < collider_dhat) visit(felt);
    });
  }
}

void ColliderContact::begin(const Points3& x, const ColliderMotion& motion,
                            const std::vector<int>& held, const PositionConstraints& pulled,
                            const FrictionHistory& history) {
  start_ = x;
  motion_ = motion;
  std::fill(held_.begin(), held_.end(), 0);
  for (const int v : held) held_[v] = 1;
  std::fill(reduction_.begin(), reduction_.end(), 0.0);
  friction_contacts_.clear();
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const Collider& before = *motion_.from[c];
    if (!before.closed())
      for (int v = 0; v < x.rows(); ++v)
        states_[c].side[v] =
            static_cast<std::int8_t>(before.side_of(row(x, v), 4 * before.depth()));
    states_[c].moved = farthest_move(before, collider(c));
    find_swept_vertices(c);
    states_[c].carried = carried_by(c);
    refresh(c, states_[c].carried);
    reduce_barrier_near_handles(c, pulled);
    begin_friction(c, history);
  }
}

void ColliderContact::reduce_barrier_near_handles(std::size_t c,
                                                  const PositionConstraints& pulled) {
  for (const PositionConstraint& pull : pulled) {
    const int v = pull.vertex;
    const double wanted =
        collider(c).nearest(pull.target, collider_dhat, states_[c].side[v]).distance;
    reduction_[v] = std::max(reduction_[v], collider_dhat - std::clamp(wanted, 0.0, collider_dhat));
  }
}

void ColliderContact::begin_friction(std::size_t c, const FrictionHistory& history) {
  const Points3& carried = states_[c].carried;
  const double mu = collider(c).mesh().friction;
  if (mu == 0) return;
  std::array<int, 3> last{-1, -1, -1};
  int count = 0;  // of contacts of the same feature of the sheet, as in a concave corner
  for_each_touch(c, carried, [&](const ContactPoint& touch) {
    const double force = mu * -collider_barrier(touch.distance).slope;
    Vector3d slip = Vector3d::Zero();
    for (int i = 0; i < touch.corners; ++i)
      slip += touch.weights[i] * (row(carried, touch.vertices[i]) - row(start_, touch.vertices[i]));
    const Eigen::Matrix<double, 3, 2> along = tangents_of(touch.normal);
    count = touch.vertices == last ? count + 1 : 0;
    last = touch.vertices;
    const TouchingFeatures name{{-1, -1 - static_cast<int>(c)}, {last[0], last[1], last[2], count}};
    const Eigen::Vector2d shear = along.transpose() * history.shear(name);
    friction_contacts_.push_back(
        {touch.vertices, touch.weights, touch.corners, along, slip, force, name, shear});
  });
}

template <class Visit>
void ColliderContact::for_each_touch(const Points3& y, Visit visit) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    refresh(c, y);
    for_each_touch(c, y, [&](const ContactPoint& touch) { visit(c, touch); });
  }
}

/// [m] The shear of a contact with the sheet at y, if it does not slide.
Eigen::Vector2d ColliderContact::trial_shear(const FrictionContact& friction,
                                             const Points3& y) const {
  Vector3d u = -friction.carried;
  for (int i = 0; i < friction.corners; ++i)
    u += friction.weights[i] * (row(y, friction.vertices[i]) - row(start_, friction.vertices[i]));
  return friction.shear + friction.along.transpose() * u;
}

void ColliderContact::remember(const Points3& y, FrictionHistory& history) const {
  for (const FrictionContact& friction : friction_contacts_)
    history.remember(friction.name, friction.along * sheared(trial_shear(friction, y)));
}

double ColliderContact::energy(const Points3& y) {
  double sum = 0;
  for_each_touch(y, [&](std::size_t, const ContactPoint& touch) {
    sum += collider_barrier(touch.distance).value;
  });
  for (const FrictionContact& friction : friction_contacts_)
    sum +=
        friction.force * friction_mollifier(trial_shear(friction, y).norm(), sticking_shear).value;
  return sum;
}

double ColliderContact::differentiate(const Points3& y, const std::vector<int>& block_of,
                                      Points3& gradient, BlockCholesky* matrix) {
  double sum = 0;
  const auto add = [&](const std::array<int, 3>& v, const std::array<double, 3>& w, int corners,
                       const Vector3d& force, const Matrix3d& second) {
    for (int i = 0; i < corners; ++i)
      for (int k = 0; k < 3; ++k) gradient(v[i], k) += w[i] * force[k];
    if (!matrix) return;
    for (int i = 0; i < corners; ++i)
      for (int j = i; j < corners; ++j) {
        const double both = w[i] * w[j];
        if (both != 0) matrix->add(matrix->slot(block_of[v[i]], block_of[v[j]]), both * second);
      }
  };
  for_each_touch(y, [&](std::size_t, const ContactPoint& touch) {
    const Barrier b = collider_barrier(touch.distance);
    const Vector3d n = touch.normal, force = b.slope * n;
    const Matrix3d second = (b.second * n).lazyProduct(n.transpose());
    sum += b.value;
    add(touch.vertices, touch.weights, touch.corners, force, second);
  });
  for (const FrictionContact& friction : friction_contacts_) {
    const Eigen::Vector2d shear = trial_shear(friction, y);
    const FrictionMollifierInPlane f = friction_mollifier(shear, sticking_shear);
    sum += friction.force * f.value;
    const Vector3d force = friction.force * f.across * (friction.along * shear);
    const Eigen::Matrix<double, 3, 2> half = friction.force * friction.along.lazyProduct(f.second);
    const Matrix3d stiffness = half.lazyProduct(friction.along.transpose());
    add(friction.vertices, friction.weights, friction.corners, force, stiffness);
  }
  return sum;
}

int ColliderContact::touching(const Points3& y) {
  int count = 0;
  for_each_touch(y, [&](std::size_t, const ContactPoint&) { ++count; });
  return count;
}

/// Finds out which corners of the features near an open collider have come round its border, in a
/// straight line from the start.
void ColliderContact::find_sides(const Points3& y) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    if (collider(c).closed()) continue;
    refresh(c, y);
    ColliderState& a = states_[c];
    std::vector<double> within(y.rows(), 0.0);  // [m] how far the collider may be; 0: never asked
    for (const int k : a.close) {
      const SheetFeature& feature = a.features[k];
      double longest = 0;
      for (int i = 0; i < feature.corners; ++i)
        for (int j = 0; j < i; ++j)
          longest =
              std::max(longest, (y.row(feature.vertices[i]) - y.row(feature.vertices[j])).norm());
      for (int i = 0; i < feature.corners; ++i) {
        double& far = within[feature.vertices[i]];
        far = std::max(far, longest + 4 * collider(c).depth());
      }
    }
    for (int v = 0; v < y.rows(); ++v)
      if (within[v] > 0)
        a.side[v] = static_cast<std::int8_t>(collider(c).side_of(
            row(y, v), row(start_, v), within[v] + (y.row(v) - start_.row(v)).norm()));
  }
}

void ColliderContact::push_out(const std::vector<char>& held, double clearance, Points3& y) {
  find_sides(y);
  std::vector<ContactPoint> within;
  for (std::size_t c = 0; c < states_.size(); ++c) {
    refresh(c, y);
    for (const int k : states_[c].close) {
      within.clear();
      touches_of(c, states_[c].features[k], y, [&](const ContactPoint& touch) {
        if (touch.distance < clearance) within.push_back(touch);
      });
      for (const ContactPoint& touch : within) {
        double free = 0;
        for (int i = 0; i < touch.corners; ++i)
          if (!held[touch.vertices[i]]) free += touch.weights[i] * touch.weights[i];
        if (free == 0) continue;
        const double out = std::max(0.0, -touch.distance),
                     on = clearance - std::max(0.0, touch.distance);
        for (int i = 0; i < touch.corners; ++i) {
          if (held[touch.vertices[i]]) continue;
          const double share = touch.weights[i] / free;
          y.row(touch.vertices[i]) +=
              (share * out + std::min(1.0, share) * on) * touch.normal.transpose();
        }
      }
    }
  }
}

double ColliderContact::inside(const Points3& y) {
  double deepest = 0;
  for (std::size_t c = 0; c < states_.size(); ++c) deepest = std::max(deepest, inside(c, y));
  return deepest;
}

double ColliderContact::cut_by_open(const Points3& y) {
  find_sides(y);
  double deepest = 0;
  for (std::size_t c = 0; c < states_.size(); ++c)
    if (!collider(c).closed()) deepest = std::max(deepest, inside(c, y));
  return deepest;
}

double ColliderContact::inside(std::size_t c, const Points3& y) {
  double deepest = 0;
  refresh(c, y);
  for (const int k : states_[c].close)
    touches_of(c, states_[c].features[k], y,
               [&](const ContactPoint& t) { deepest = std::max(deepest, -t.distance); });
  return deepest;
}

}  // namespace paperbake
