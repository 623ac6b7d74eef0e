#include "core/methods/hybrid.h"

#include "core/geometry/pattern_mesh.h"
#include "core/model/serializer.h"
#include "core/step3_developable/developable.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// A mesh of about so many triangles. Where handles stand so close together that they alone take
/// most of the triangles, there are more: otherwise the cells between the handles would be as large
/// as the sheet, and a straight edge from clamp to handle would be a taut string. (S8 with 60: 40
/// triangles in the clamps, edges of 45 mm, stretched by 8 %.)
PatternMesh first_mesh_with(const Pattern& pattern, const FirstLattice& lattice,
                            const std::vector<Vector2d>& points) {
  constexpr double largest_edge = 1.15;  // [1] of the edge of as many equilateral triangles
  PatternMesh coarsest = mesh_pattern(
      pattern, largest_edge * equilateral_edge(pattern, lattice.triangles), points, lattice.turn);
  return coarsest.triangles.rows() > lattice.triangles
             ? coarsest
             : mesh_pattern_with(pattern, lattice.triangles, points, lattice.turn);
}

BentParts bent_parts(const Crumple& crumple, const Sheet& sheet) {
  BentParts parts;
  for (const Ruling& ruling : crumple.rulings()) parts.rulings.emplace_back(ruling.a, ruling.b);
  const Regions& regions = crumple.regions();
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Eigen::RowVector3i corners = sheet.triangles.row(t);
    const Vector2d centre = (sheet.pattern.row(corners[0]) + sheet.pattern.row(corners[1]) +
                             sheet.pattern.row(corners[2])) /
                            3;
    const int place = regions.grid().nearest(centre),
              region = place < 0 ? -1 : regions.region_of_sample()[place];
    parts.region.push_back(region < 0 ? -1 : regions.all()[region].id);
  }
  return parts;
}

class Hybrid : public Method {
 public:
  Hybrid(const FirstLattice& lattice, const CrumpleOptions& options, Crumple crumple)
      : lattice_(lattice),
        max_first_triangles_(options.max_first_triangles),
        is_limited_(options.max_first_triangles <= options.max_triangles),
        crumple_(std::move(crumple)) {}

  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    pattern_ = pattern;
    points_ = points;
    return base_mesh();
  }
  std::optional<PatternMesh> finer_mesh() override {
    if (!has_finer_mesh()) return std::nullopt;
    ++doublings_;
    return base_mesh();
  }

  int doublings() const override { return doublings_; }
  bool has_finer_mesh() const override {
    return doublings_ < max_doublings && 2 * lattice_now().triangles <= max_first_triangles_;
  }

  bool is_crumpled(const Sheet& sheet) const override { return paperbake::is_crumpled(sheet); }
  bool finds_folds(const Sheet& sheet) const override { return !is_crumpled(sheet); }
  std::vector<FoldLine> fold_lines(const Sheet& sheet, const PlasticMemory& memory) const override {
    return crumple_.fold_lines(sheet, memory);
  }
  std::vector<FoldLine> pressed_lines(const Sheet& sheet,
                                      const std::function<PlasticMemory()>& memory,
                                      const ColliderShapes& colliders) const override {
    return crumple_.pressed_lines(sheet, memory, colliders);
  }
  std::optional<PatternMesh> mesh_with_creases(const Pattern& pattern,
                                               const std::vector<Vector2d>& points,
                                               int refinement) const override {
    const double edge = equilateral_edge(pattern, refinement * lattice_now().triangles);
    std::optional<PatternMesh> mesh = try_mesh_pattern(pattern, edge, points, lattice_.turn);
    if (mesh) number_points_first(*mesh);
    return mesh;
  }

  std::optional<Sheet> propose(const Sheet& sheet, const RemeshContext& context) override {
    // A sheet that yields keeps its mesh: another mesh folds in other places, and what yields there
    // is not undone.
    if (!context.moving || !context.at_minimum || context.yielding) return std::nullopt;
    // edges are where creases need them
    if (!sheet.prescribed_creases.empty()) return std::nullopt;
    return crumple_.propose(sheet, context.isolated_moving_handles, context.rests_on_contact,
                            context.now);
  }
  void on_proposal_result(bool accepted, const FrameTime& now) override {
    crumple_.on_proposal_result(accepted, now);
  }

  MeshChange remesh(Sheet& sheet, const RemeshContext& context) override {
    if (context.jammed)
      return crumple_.refine_where_jammed(sheet, context.fixed, context.local_energies()) > 0
                 ? MeshChange::moved
                 : MeshChange::none;
    const bool pressed = context.squeeze > 0 && is_crumpled(sheet);
    if (context.snap_in_progress && !pressed) return MeshChange::none;
    const double travel =
        std::max({context.relative_handle_motion,
                  context.rests_on_contact ? context.deformation : 0, context.squeeze});
    const CrumpleReport report = crumple_.step(
        sheet, context.fixed, context.now, {travel, context.moving, context.at_minimum, pressed},
        context.local_energies);
    if (report.moves + report.resized > 0) return MeshChange::moved;
    return report.mesh_changed() ? MeshChange::local : MeshChange::none;
  }
  int load_parts(const Sheet& sheet, double motion) const override {
    return crumple_.load_parts(sheet, motion);
  }

  bool finish(Sheet& shown, const std::vector<int>& held) const override {
    restore_lengths(shown, held);
    return true;
  }
  BentParts parts(const Sheet& sheet) const override { return bent_parts(crumple_, sheet); }
  void archive(Serializer& a) override {
    a(doublings_);
    if (a.reads()) {
      a.require(0 <= doublings_ && doublings_ <= max_doublings);
      if (doublings_ > 0) base_mesh();
    }
    crumple_.archive(a);
  }

 private:
  static constexpr int max_doublings = 4;

  FirstLattice lattice_now() const { return {lattice_.triangles << doublings_, lattice_.turn}; }

  /// The mesh from which all others are derived.
  PatternMesh base_mesh() {
    PatternMesh mesh = first_mesh_with(pattern_, lattice_now(), points_);
    const int required = number_points_first(mesh);
    crumple_.set_base_mesh(mesh.vertices, mesh.triangles, required);
    if (!is_limited_ && doublings_ > 0) crumple_.allow_triangles(2 * lattice_now().triangles);
    return mesh;
  }

  FirstLattice lattice_;
  int max_first_triangles_;
  bool is_limited_;    // to that number also while it crumples
  int doublings_ = 0;  // of the number of triangles of the first lattice
  Crumple crumple_;
  Pattern pattern_;
  std::vector<Vector2d> points_;  // [m] that every mesh has as vertices
};

}  // namespace

int triangles_in_two_rows(const Pattern& pattern) {
  const double height = mean_width(pattern) / 2, of_one = height * height / std::sqrt(3.0);
  return static_cast<int>(std::ceil(area(pattern) / of_one));
}

MethodChoice hybrid(const Pattern& pattern, const Paper& paper, const FirstLattice& lattice,
                    const CrumpleOptions& options, std::uint32_t seed, std::uint32_t sheet) {
  return {"hybrid", [=] {
            return std::make_unique<Hybrid>(lattice, options,
                                            Crumple(pattern, paper, options, seed, sheet));
          }};
}

}  // namespace paperbake
