#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include <limits>
#include <numeric>

namespace paperbake {
namespace {

/// Meshes one after the other.
struct MergedMesh {
  Points2 pattern;
  Triangles triangles;
  std::vector<int> first{0};   // vertex of each sheet, and one past the last
  std::vector<int> of_vertex;  // number of its sheet

  void add(const Points2& own, const Triangles& own_triangles) {
    const int before = first.back(), t = static_cast<int>(triangles.rows());
    pattern.conservativeResize(before + own.rows(), 2);
    pattern.bottomRows(own.rows()) = own;
    triangles.conservativeResize(t + own_triangles.rows(), 3);
    triangles.bottomRows(own_triangles.rows()) = own_triangles.array() + before;
    of_vertex.resize(pattern.rows(), static_cast<int>(first.size()) - 1);
    first.push_back(static_cast<int>(pattern.rows()));
  }

  Eigen::Index rows(std::size_t k) const { return first[k + 1] - first[k]; }
};

/// Positions of all; at(k): |V_k|x3 of the k-th
template <class At>
Points3 joined(const MergedMesh& mesh, At at) {
  Points3 all(mesh.first.back(), 3);
  for (std::size_t k = 0; k + 1 < mesh.first.size(); ++k)
    all.middleRows(mesh.first[k], mesh.rows(k)) = at(k);
  return all;
}

void add_grips(const HardConstraints& own, int first, HardConstraints& all) {
  for (const int v : own.vertices) all.vertices.push_back(first + v);
  all.targets.conservativeResize(all.vertices.size(), 3);
  all.targets.bottomRows(own.targets.rows()) = own.targets;
}

}  // namespace

double Elastic::dhat() const { return impl_->contact ? impl_->contact->dhat() : 0; }

bool Elastic::clear(const SweptSheet& a, const SweptSheet& b, double dhat) {
  MergedMesh mesh;
  HardConstraints grips{{}, Points3(0, 3)};
  for (const SweptSheet* way : {&a, &b}) {
    add_grips(hard_handles(way->held), mesh.first.back(), grips);
    mesh.add(way->sheet.pattern, way->sheet.triangles);
  }
  const Points3 begun =
      a.begun.rows()
          ? joined(mesh, [&](std::size_t of) -> const Points3& { return (of == 0 ? a : b).begun; })
          : Points3(0, 3);
  Contact contact(mesh.pattern, mesh.triangles,
                  {mesh.of_vertex, Eigen::MatrixXd::Constant(2, 2, dhat), begun});
  const auto place = [&](std::size_t k) {
    return joined(mesh,
                  [&](std::size_t of) -> const Points3& { return (of == 0 ? a : b).places[k]; });
  };
  for (std::size_t k = 0; k + 1 < a.places.size(); ++k)
    if (!contact.is_collision_free_between_sheets(place(k), place(k + 1), grips)) return false;
  return true;
}

std::vector<ElasticReport> Elastic::step_together(const std::vector<JointStepSheet>& all,
                                                  const Eigen::MatrixXd& dhat, double dt) {
  const std::size_t n = all.size();
  MergedMesh mesh;
  std::vector<PositionConstraints> held;
  std::vector<HardConstraints> hard;
  HardConstraints grips{{}, Points3(0, 3)};
  std::vector<double> friction;
  for (const JointStepSheet& one : all) {
    Impl& s = *one.elastic.impl_;
    friction.push_back(s.paper.friction);
    held.push_back(s.reachable_targets(one.sheet, one.held, dt));
    hard.push_back(hard_handles(held.back()));
    add_grips(hard.back(), mesh.first.back(), grips);
    mesh.add(s.pattern, s.triangles);
    s.find_ridges_of_step(one.sheet, held.back().vertices);
    s.update_predictor(one.sheet, hard.back().vertices);
  }
  const Points3 before =
      joined(mesh, [&](std::size_t k) -> const Points3& { return all[k].sheet.x; });
  const Points3 begun =
      all.front().begun.rows()
          ? joined(mesh, [&](std::size_t k) -> const Points3& { return all[k].begun; })
          : Points3(0, 3);
  Contact contact(mesh.pattern, mesh.triangles, {mesh.of_vertex, dhat, begun, friction});
  contact.begin(before, grips, dt);

  // one matrix for all, in which nothing is held: handles pull
  std::vector<std::pair<int, int>> coupled = contact.coupled_vertices(before);
  for (std::size_t k = 0; k < n; ++k)
    for (const auto& [i, j] : all[k].elastic.impl_->energy->coupled_vertices())
      coupled.emplace_back(mesh.first[k] + i, mesh.first[k] + j);
  BlockCholesky matrix(mesh.first.back(), std::move(coupled));
  std::vector<int> blocks(mesh.first.back());
  std::iota(blocks.begin(), blocks.end(), 0);
  contact.bind(matrix, blocks);

  IncrementalPotential W{{}, &contact};
  std::vector<std::vector<Points3>> starts;
  std::size_t max_starts = 0;
  NewtonOptions how{all.front().elastic.impl_->options.stop, 0};
  double mean_edge = std::numeric_limits<double>::infinity(), stiffness = 0;
  for (std::size_t k = 0; k < n; ++k) {
    Impl& s = *all[k].elastic.impl_;
    s.matrix.reset();  // its energy is bound to that of all
    s.block_of.assign(blocks.begin() + mesh.first[k], blocks.begin() + mesh.first[k + 1]);
    s.energy->bind(matrix, s.block_of);
    if (s.colliders) s.colliders->begin(all[k].sheet.x, held[k].colliders, {}, dt, hard[k]);
    W.sheets.push_back(
        s.potential(all[k].sheet, dt, handle_springs(held[k], HardHandles::may_yield)));
    starts.push_back(s.guesses(all[k].sheet.x, hard[k], true));
    max_starts = std::max(max_starts, starts.back().size());
    mean_edge = std::min(mean_edge, s.mean_edge);
    stiffness = std::max(stiffness, s.paper.membrane_stiffness);
    how.max_iterations = std::max(how.max_iterations, s.max_contact_iterations());
  }
  std::vector<Points3> guesses;
  for (std::size_t g = 0; g < max_starts; ++g)  // the last of each: it stays where it is
    guesses.push_back(joined(mesh, [&](std::size_t k) -> const Points3& {
      return starts[k][std::min(g, starts[k].size() - 1)];
    }));
  Points3 x = before;
  choose_initial_guess(W, before, guesses, x);
  const NewtonReport newton = minimise({W, matrix, blocks, mean_edge, stiffness}, how, {}, x);

  contact.update_candidates(x, Points3::Zero(x.rows(), 3));
  const std::vector<Contact::Active> active = contact.active_by_sheet(x);
  std::vector<ElasticReport> reports(n);
  for (std::size_t k = 0; k < n; ++k) {
    Impl& s = *all[k].elastic.impl_;
    Sheet& sheet = all[k].sheet;
    ElasticReport& report = reports[k];
    const Points3 begun = sheet.x;
    sheet.x = x.middleRows(mesh.first[k], mesh.rows(k));
    report.iterations = newton.iterations;
    report.converged = newton.converged;
    report.contact = true;
    report.touching = active[k].own;
    report.touching_others = active[k].others;
    s.report_constraints(sheet.x, W.sheets[k].springs, report);
    s.state.second.reset();
    s.state.descending = false;
    s.state.had_contact = report.touching > 0 || report.yielding > 0;
    s.finish_step(sheet, begun, held[k], dt, report);
  }
  return reports;
}

}  // namespace paperbake
