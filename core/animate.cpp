#include "core/animate.h"

#include "core/error.h"
#include "core/locate.h"
#include "core/measure.h"
#include "core/reach.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <optional>

namespace paperbake {
namespace {

constexpr double disc_stiffening = 10;
constexpr double start_noise = 1e-6;     // [m] lets a flat sheet choose a side
constexpr int max_halvings = 8;
constexpr double torn = 0.5;             // [1] an edge this much too long: the step is not to be trusted

/// CPU time of this thread. [ms]
double cpu_ms() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

/// A number in [-1, 1) that depends on seed and index alone. source [SplitMix64, Steele 2014]
double noise(unsigned seed, std::uint64_t index) {
  std::uint64_t z = (std::uint64_t(seed) << 32) + (index + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-52 - 1;
}

/// Adds noise along the common normal when all points lie in one plane.
void disturb_if_flat(Points3& x, double size, unsigned seed) {
  const Eigen::RowVector3d centre = x.colwise().mean();
  const Eigen::Matrix3d scatter = (x.rowwise() - centre).transpose() * (x.rowwise() - centre);
  const Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  if (((x.rowwise() - centre) * normal).cwiseAbs().maxCoeff() > 1e-7 * size) return;
  const Vector3d up = normal.z() < 0 ? Vector3d(-normal) : normal;  // the side an eigenvector points to is an accident
  for (int v = 0; v < x.rows(); ++v) x.row(v) += start_noise * noise(seed, v) * up.transpose();
}

/// Handles of the shot as the loop needs them: where they are asked to be, and which vertices that holds.
class Grip {
 public:
  Grip(const Shot& shot, std::vector<int> vertices, int first_frame)
      : handles_(shot.handles), vertex_(std::move(vertices)), first_frame_(first_frame),
        reach_(shot.pattern, shot.handles), anchor_(shot.handles.size()) {}

  /// A relative handle begins where the sheet is at its grab frame, after that frame was simulated without it.
  bool holds(std::size_t h, int frame) const {
    const Handle& handle = handles_[h];
    return handle.held(frame) && (handle.mode == HandleMode::absolute || anchor_[h]);
  }

  Vector3d keyed(std::size_t h, int frame) const {
    const Handle& handle = handles_[h];
    const Vector3d now = keyed_position(handle, frame - first_frame_);
    return anchor_[h] ? Vector3d(*anchor_[h] + now) : now;
  }

  void anchor(const Points3& x, int frame) {
    for (std::size_t h = 0; h < handles_.size(); ++h)
      if (handles_[h].mode == HandleMode::relative && handles_[h].held(frame) && !anchor_[h])
        anchor_[h] = x.row(vertex_[h]).transpose() - keyed_position(handles_[h], frame - first_frame_);
  }

  /// Held vertices and their targets at a frame, drawn together where paper cannot reach.
  Held held(int frame) const {
    std::vector<int> who;
    for (std::size_t h = 0; h < handles_.size(); ++h)
      if (holds(h, frame)) who.push_back(static_cast<int>(h));
    Points3 targets(who.size(), 3);
    for (std::size_t k = 0; k < who.size(); ++k) targets.row(k) = keyed(who[k], frame);
    reach_.project(who, targets);
    // two handles on one point of the sheet hold it where they agree best
    std::map<int, std::pair<Eigen::RowVector3d, int>> by_vertex;
    for (std::size_t k = 0; k < who.size(); ++k) {
      auto& [sum, count] = by_vertex.try_emplace(vertex_[who[k]], Eigen::RowVector3d::Zero(), 0).first->second;
      sum += targets.row(k);
      ++count;
    }
    Held held;
    held.targets.resize(by_vertex.size(), 3);
    for (const auto& [vertex, mean] : by_vertex) {
      held.targets.row(held.vertices.size()) = mean.first / mean.second;
      held.vertices.push_back(vertex);
    }
    return held;
  }

  std::vector<HandleFrame> report(const Points3& x, int frame) const {
    constexpr double exact = 1e-4;  // [m]
    std::vector<HandleFrame> frames(handles_.size());
    for (std::size_t h = 0; h < handles_.size(); ++h) {
      frames[h].keyed = keyed(h, frame);
      frames[h].at = x.row(vertex_[h]);
      if (!holds(h, frame)) continue;
      frames[h].state = (frames[h].at - frames[h].keyed).norm() > exact ? HandleFrame::jammed : HandleFrame::held;
    }
    return frames;
  }

 private:
  const std::vector<Handle>& handles_;
  std::vector<int> vertex_;
  int first_frame_;
  Reach reach_;
  std::vector<std::optional<Vector3d>> anchor_;  // [m] what is added to a relative handle's own position
};

/// The start shape is the first frame as it was modelled, unless a handle is keyed away from it there already. A slight arch
/// that tells which way to buckle would be lost if it were relaxed: handles that were left lying under it are no reason to.
bool in_place(Sheet& sheet, const Held& held, double side) {
  const double same = 5e-4 * side;  // [m]
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    if ((sheet.x.row(held.vertices[k]) - held.targets.row(k)).norm() > same) return false;
  for (std::size_t k = 0; k < held.vertices.size(); ++k) sheet.x.row(held.vertices[k]) = held.targets.row(k);
  return true;
}

/// The elastic step of one frame, in halves where a whole one fails.
struct SteppedFrame {
  int substeps = 0, iterations = 0;
  bool converged = true;
  ElasticReport last;
};

SteppedFrame follow(Elastic& elastic, Sheet& sheet, const Held& held, double dt, int halvings, const std::string& where) {
  const Sheet before = sheet;
  SteppedFrame result;
  std::string failure;
  try {
    result.last = elastic.step(sheet, held, dt);
    result.substeps = 1;
    result.iterations = result.last.iterations;
    result.converged = result.last.converged;
  } catch (const Error& error) {
    failure = error.cause;
  }
  if (failure.empty() && result.converged) return result;
  const LengthDistortion distortion = length_distortion(sheet);
  if (failure.empty() && distortion.largest < torn) return result;
  if (halvings == max_halvings) {
    char cause[200];
    std::snprintf(cause, sizeof cause, "The sheet cannot follow the handles: %d halvings of the time step, worst stretch %.0f %% at pattern (%.1f cm, %.1f cm).",
                  halvings, 100 * distortion.largest, 100 * distortion.where.x(), 100 * distortion.where.y());
    throw Error(Fault::simulation, where, failure.empty() ? cause : failure, "Move the handles more slowly before this frame.");
  }
  sheet = before;
  Held half = held;
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    half.targets.row(k) = 0.5 * (before.x.row(held.vertices[k]) + held.targets.row(k));
  const SteppedFrame first = follow(elastic, sheet, half, 0.5 * dt, halvings + 1, where);
  SteppedFrame second = follow(elastic, sheet, held, 0.5 * dt, halvings + 1, where);
  second.substeps += first.substeps;
  second.iterations += first.iterations + result.iterations;
  second.converged &= first.converged;
  return second;
}

}  // namespace

StartedSheet start_sheet(const Shot& shot, const Method& method, unsigned seed) {
  std::vector<Vector2d> points;
  std::vector<double> radius;
  for (std::size_t h = 0; h < shot.handles.size(); ++h) {
    points.push_back(shot.handles[h].pattern);
    radius.push_back(disc_radius(shot.handles, h, shot.pattern));
  }
  for (std::size_t h = 0; h < shot.handles.size(); ++h)
    for (const Vector2d& p : disc_rim(shot.pattern, shot.handles[h].pattern, radius[h])) points.push_back(p);

  Method::FirstMesh mesh = method.first_mesh(shot.pattern, points);
  StartedSheet started;
  started.handle_vertex.assign(mesh.point_vertex.begin(), mesh.point_vertex.begin() + shot.handles.size());
  Sheet& sheet = started.sheet;
  sheet.pattern = std::move(mesh.pattern);
  sheet.triangles = std::move(mesh.triangles);
  sheet.x.resize(sheet.pattern.rows(), 3);
  sheet.v = Points3::Zero(sheet.pattern.rows(), 3);
  const Locator locator(shot.start.pattern, shot.start.triangles);
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    sheet.x.row(v) = interpolate(locator.locate(sheet.pattern.row(v)), shot.start.triangles, shot.start.x);
  disturb_if_flat(sheet.x, longer_side(shot.pattern), seed);

  started.stiffening.assign(sheet.triangles.rows(), 1.0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (std::size_t h = 0; h < shot.handles.size(); ++h) {
      bool within = radius[h] > 0;
      for (int i = 0; i < 3; ++i)
        within &= (sheet.pattern.row(sheet.triangles(t, i)).transpose() - shot.handles[h].pattern).norm() <= 1.001 * radius[h];
      if (within) started.stiffening[t] = disc_stiffening;
    }
  return started;
}

void animate(const Shot& shot, const Method& method, const AnimateOptions& options,
             const std::function<bool(const AnimatedFrame&)>& on_frame) {
  double begun = cpu_ms();
  StartedSheet started = start_sheet(shot, method, options.seed);
  Sheet& sheet = started.sheet;
  Elastic elastic(shot.paper, options.elastic);
  elastic.set_mesh(sheet, started.stiffening);
  Grip grip(shot, started.handle_vertex, options.first_frame);
  double geometry_ms = cpu_ms() - begun;

  for (int frame = options.first_frame; frame <= options.last_frame; ++frame) {
    AnimatedFrame result;
    result.frame = frame;
    begun = cpu_ms();
    const std::string where = "frame " + std::to_string(frame) + " of " + std::to_string(options.last_frame);
    const Held held = grip.held(frame);
    SteppedFrame step;
    if (frame == options.first_frame && in_place(sheet, held, longer_side(shot.pattern))) step.last = elastic.look(sheet);
    else step = follow(elastic, sheet, held, 1 / options.fps, 0, where);
    result.elastic_ms = cpu_ms() - begun;

    begun = cpu_ms();
    if (method.after_step && method.after_step(sheet)) elastic.set_mesh(sheet);
    grip.anchor(sheet.x, frame);
    result.geometry_ms = geometry_ms + cpu_ms() - begun;
    geometry_ms = 0;

    result.sheet = &sheet;
    result.handles = grip.report(sheet.x, frame);
    result.substeps = step.substeps;
    result.newton_iterations = step.iterations;
    result.converged = step.converged;
    result.energy = step.last.energy;
    result.membrane_energy = step.last.membrane;
    if (step.last.lower_branch > 1e-3)
      result.note = "snap: a second start ended " + std::to_string(static_cast<int>(std::lround(100 * step.last.lower_branch))) + " % lower in energy and was taken";
    if (!on_frame(result)) return;
  }
}

}  // namespace paperbake
