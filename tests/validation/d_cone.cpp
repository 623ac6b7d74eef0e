#include "core/pattern_mesh.h"
#include "core/step1_elastic/elastic_energy.h"
#include "tests/test_meshes.h"
#include "tests/validation/cases.h"

#include <algorithm>

// A disc whose middle is held at the tip of a cone of slope eps and whose rim may not go below that cone: as if pushed into a
// ring of its own size without friction. The tool has no such obstacle, so the minimum is sought here, over the energy of step 1.
//
// The core is left out: between two radii a cone stores E = D/2 I ln(r2/r1), and its crest ruling has the slope of the table.

namespace paperbake::validation {
namespace {

constexpr double R = 0.05;                            // [m]
constexpr double inner = 0.3 * R, outer = 0.8 * R;    // [m] where energy and slope are measured; the core ends at about 3 mm
constexpr double obstacle = 2e3;                      // [N/m] stiffness of the ring against a rim vertex

/// Rings in geometric progression and rulings evenly round: edges along the rulings.
Sheet polar_disc(int rulings, double ratio) {
  std::vector<Vector2d> points{{0, 0}};
  std::vector<double> radii{R};
  while (radii.back() > 0.001) radii.push_back(radii.back() / ratio);
  std::reverse(radii.begin(), radii.end());
  for (const double r : radii)
    for (int k = 0; k < rulings; ++k) points.emplace_back(r * std::cos(2 * M_PI * k / rulings), r * std::sin(2 * M_PI * k / rulings));
  std::vector<Eigen::RowVector3i> faces;
  const auto at = [&](int ring, int k) { return 1 + ring * rulings + k % rulings; };
  for (int k = 0; k < rulings; ++k) {
    faces.emplace_back(0, at(0, k), at(0, k + 1));
    for (int ring = 0; ring + 1 < static_cast<int>(radii.size()); ++ring) {
      faces.emplace_back(at(ring, k), at(ring + 1, k), at(ring + 1, k + 1));
      faces.emplace_back(at(ring, k), at(ring + 1, k + 1), at(ring, k + 1));
    }
  }
  Points2 p(points.size(), 2);
  Triangles t(faces.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) p.row(i) = points[i];
  for (std::size_t i = 0; i < faces.size(); ++i) t.row(i) = faces[i];
  return test::flat_sheet(std::move(p), std::move(t));
}

/// The mesh of fem: near-equilateral.
Sheet equilateral_disc(double edge) {
  Pattern pattern;
  constexpr int sides = 128;
  for (int k = 0; k < sides; ++k) pattern.outline.push_back({R + R * std::cos(2 * M_PI * k / sides), R + R * std::sin(2 * M_PI * k / sides)});
  PatternMesh mesh = mesh_pattern(pattern, edge, {{R, R}});
  mesh.vertices.rowwise() -= Eigen::RowVector2d(R, R);
  return test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles));
}

/// A cone of slope eps that lifts off over 139 degrees, as isometric as a guess can be: rulings at elevation alpha(t) have the
/// azimuth phi with dphi = sqrt(1 - alpha'^2)/cos alpha dt, and the height of the crest closes the turn.
void guess(Sheet& sheet, double eps) {
  constexpr int n = 7200;
  const double half = 139.0 / 2 * M_PI / 180;
  const auto elevation = [&](double t, double crest) {
    return std::atan(eps + (std::abs(t) < half ? crest * 0.5 * (1 + std::cos(M_PI * t / half)) : 0.0));
  };
  std::vector<double> phi(n + 1);
  const auto turn = [&](double crest) {
    phi[0] = 0;
    for (int k = 0; k < n; ++k) {
      const double dt = 2 * M_PI / n, a = elevation(-M_PI + k * dt, crest), b = elevation(-M_PI + (k + 1) * dt, crest);
      phi[k + 1] = phi[k] + std::sqrt(std::max(0.0, dt * dt - (b - a) * (b - a))) / std::cos(0.5 * (a + b));
    }
    return phi[n];
  };
  double low = 0, high = 20 * eps;
  for (int k = 0; k < 60; ++k) (turn(0.5 * (low + high)) > 2 * M_PI ? low : high) = 0.5 * (low + high);
  const double crest = 0.5 * (low + high);
  turn(crest);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double r = sheet.pattern.row(v).norm(), t = std::atan2(sheet.pattern(v, 1), sheet.pattern(v, 0)), alpha = elevation(t, crest);
    const double place = (t + M_PI) / (2 * M_PI) * n;
    const int k = std::min(n - 1, static_cast<int>(place));
    const double azimuth = phi[k] + (place - k) * (phi[k + 1] - phi[k]);
    sheet.x.row(v) << r * std::cos(alpha) * std::cos(azimuth), r * std::cos(alpha) * std::sin(azimuth), r * std::sin(alpha);
  }
}

/// Energy of the sheet in the ring, and its derivatives.
class PushedDisc {
 public:
  PushedDisc(const Paper& paper, Sheet& sheet, double eps) : sheet_(sheet), eps_(eps), energy_(paper, sheet.pattern, sheet.triangles) {
    int blocks = 0;
    for (int v = 0; v < sheet.x.rows(); ++v) {
      const double r = sheet.pattern.row(v).norm();
      block_.push_back(r < 1e-9 ? -1 : blocks++);  // the middle is held
      if (r > R * (1 - 2e-3)) rim_.push_back(v);
    }
    std::vector<std::pair<int, int>> coupled;
    for (const auto& [i, j] : energy_.coupled_vertices())
      if (block_[i] >= 0 && block_[j] >= 0) coupled.emplace_back(block_[i], block_[j]);
    matrix_ = std::make_unique<BlockCholesky>(blocks, std::move(coupled));
    energy_.bind(*matrix_, block_);
  }

  double energy(const Points3& x) const {
    double sum = energy_.energy(x);
    for (const int v : rim_) sum += 0.5 * obstacle * std::pow(depth(x, v), 2);
    return sum;
  }

  /// Newton with the exact second derivative, the projected one where that is not positive definite.
  /// returns the last step's largest move [m]
  double minimise() {
    constexpr int most = 400;
    double move = 1;
    for (int k = 0; k < most && move > 1e-9; ++k) {
      Points3 gradient;
      Eigen::VectorXd b;
      double shift = 1e-6;  // [N/m] the sheet may turn about the axis
      for (HessianForm form : {HessianForm::exact, HessianForm::projected}) {
        matrix_->set_zero();
        energy_.hessian(sheet_.x, form, gradient, *matrix_);
        for (const int v : rim_) push_back(v, gradient);
        matrix_->shift_diagonal(shift);
        if (matrix_->factorise()) break;
      }
      b.resize(3 * (sheet_.x.rows() - 1));
      for (int v = 0; v < sheet_.x.rows(); ++v)
        if (block_[v] >= 0) b.segment<3>(3 * block_[v]) = -gradient.row(v).transpose();
      const Eigen::VectorXd& step = matrix_->solve(b);
      double size = std::min(1.0, 0.002 / step.cwiseAbs().maxCoeff());
      const double before = energy(sheet_.x), slope = -b.dot(step);
      Points3 x;
      for (int halving = 0; halving < 30; ++halving, size *= 0.5) {
        x = sheet_.x;
        for (int v = 0; v < x.rows(); ++v)
          if (block_[v] >= 0) x.row(v) += size * step.segment<3>(3 * block_[v]).transpose();
        if (energy(x) <= before + 1e-4 * size * slope + 1e-15 * before) break;
      }
      sheet_.x = x;
      move = size * step.cwiseAbs().maxCoeff();
    }
    return move;
  }

  /// Bending energy between two radii. [J]
  static double bending_between(const Paper& paper, const Sheet& sheet, double r1, double r2) {
    std::vector<double> share(sheet.triangles.rows());
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      const double r = ((sheet.pattern.row(sheet.triangles(t, 0)) + sheet.pattern.row(sheet.triangles(t, 1)) + sheet.pattern.row(sheet.triangles(t, 2))) / 3).norm();
      share[t] = r > r1 && r < r2 ? 1 : 0;
    }
    return ElasticEnergy(paper, sheet.pattern, sheet.triangles, share).parts(sheet.x).bending;
  }

 private:
  double depth(const Points3& x, int v) const { return std::max(0.0, eps_ * std::hypot(x(v, 0), x(v, 1)) - x(v, 2)); }

  void push_back(int v, Points3& gradient) {
    const double d = depth(sheet_.x, v);
    if (d <= 0) return;
    const double rho = std::hypot(sheet_.x(v, 0), sheet_.x(v, 1));
    const Vector3d n(-eps_ * sheet_.x(v, 0) / rho, -eps_ * sheet_.x(v, 1) / rho, 1);
    gradient.row(v) -= obstacle * d * n.transpose();
    matrix_->add(matrix_->slot(block_[v], block_[v]), Eigen::Matrix3d(obstacle * n * n.transpose()));
  }

  Sheet& sheet_;
  double eps_;
  ElasticEnergy energy_;
  std::unique_ptr<BlockCholesky> matrix_;
  std::vector<int> block_, rim_;
};

/// The radii nearest to the wished ones between which whole rings of triangles lie; any radius will do for other meshes.
void judge(Rows& rows, const std::string& name, Sheet sheet, double ratio, double eps, double energy, double crest) {
  const Paper paper;
  guess(sheet, eps);
  PushedDisc disc(paper, sheet, eps);
  const double move = disc.minimise();
  double r1 = inner, r2 = outer;
  if (ratio > 1) {
    r1 = R / std::pow(ratio, std::round(std::log(R / inner) / std::log(ratio)));
    r2 = R / std::pow(ratio, std::round(std::log(R / outer) / std::log(ratio)));
  }
  const double stored = PushedDisc::bending_between(paper, sheet, r1, r2);
  // the crest: the steepest line between the two radii, by a fit of z over the horizontal distance in a narrow sector about it
  double top = 0, crest_at = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (sheet.pattern.row(v).norm() > 0.97 * R && sheet.x(v, 2) > top) top = sheet.x(v, 2), crest_at = std::atan2(sheet.pattern(v, 1), sheet.pattern(v, 0));
  double n = 0, s = 0, ss = 0, z = 0, sz = 0;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double r = sheet.pattern.row(v).norm(), t = std::remainder(std::atan2(sheet.pattern(v, 1), sheet.pattern(v, 0)) - crest_at, 2 * M_PI);
    if (r < 0.99 * r1 || r > 1.01 * r2 || std::abs(t) > 0.04) continue;
    const double rho = std::hypot(sheet.x(v, 0), sheet.x(v, 1));
    n += 1, s += rho, ss += rho * rho, z += sheet.x(v, 2), sz += rho * sheet.x(v, 2);
  }
  char label[80];
  std::snprintf(label, sizeof label, "%s, eps %.2f", name.c_str(), eps);
  const char* const source = "V3b: exact spherical curve";
  rows.push_back({label, "crest slope / eps", crest, (n * sz - s * z) / (n * ss - s * s) / eps, 0.02, source, ""});
  rows.push_back({label, "2 E / (D ln r2/r1)", energy, 2 * stored / (paper.bending_stiffness * std::log(r2 / r1)), 0.02, source, ""});
  if (move > 1e-9) rows.push_back({label, "Newton's last move, m", 0, move, 1e-7, "", ""});
}

}  // namespace

Rows d_cone() {
  constexpr double table[][3] = {{0.10, 1.285, 3.98}, {0.20, 4.728, 4.59}};  // eps, int kg^2, crest slope / eps
  Rows rows;
  for (const auto& [eps, energy, crest] : table) {
    judge(rows, "48 rulings", polar_disc(48, 1.15), 1.15, eps, energy, crest);
    judge(rows, "96 rulings", polar_disc(96, 1.10), 1.10, eps, energy, crest);
    judge(rows, "fem, edge 1.6 mm", equilateral_disc(0.0016), 0, eps, energy, crest);
  }
  rows.push_back({"paperbake bake", "any", 0, 0, 0, "", "no colliders in this version: nothing in a scene can stand for the ring"});
  return rows;
}

}  // namespace paperbake::validation
