#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include <limits>
#include <numeric>

namespace paperbake {
namespace {

/// Several meshes in one, one after the other.
struct MergedMesh {
  Points2 pattern;
  Triangles triangles;
  std::vector<int> first{0};   // first vertex of each sheet, and one past the last vertex
  std::vector<int> of_vertex;  // index of the sheet of each vertex

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

/// Positions of all sheets in one matrix; at(k): |V_k|x3 of the k-th sheet
template <class At>
Points3 joined(const MergedMesh& mesh, At at) {
  Points3 all(mesh.first.back(), 3);
  for (std::size_t k = 0; k + 1 < mesh.first.size(); ++k)
    all.middleRows(mesh.first[k], mesh.rows(k)) = at(k);
  return all;
}

/// Adds the hard constraints of a sheet whose first vertex in the joint mesh is `first`.
void add_hard(const PositionConstraints& own, int first, PositionConstraints& all) {
  for (const PositionConstraint& c : own)
    if (c.is_hard()) all.push_back({first + c.vertex, c.target});
}

}  // namespace

double Elastic::dhat() const { return impl_->contact ? impl_->contact->dhat() : 0; }

bool Elastic::are_collision_free(const SweptSheet& a, const SweptSheet& b, double dhat) {
  MergedMesh mesh;
  PositionConstraints hard;
  for (const SweptSheet* swept : {&a, &b}) {
    add_hard(swept->constraints, mesh.first.back(), hard);
    mesh.add(swept->sheet.pattern, swept->sheet.triangles);
  }
  const Points3 initial_positions = a.initial_positions.rows()
                                        ? joined(mesh,
                                                 [&](std::size_t of) -> const Points3& {
                                                   return (of == 0 ? a : b).initial_positions;
                                                 })
                                        : Points3(0, 3);
  SheetContact contact(mesh.pattern, mesh.triangles,
                       {mesh.of_vertex, Eigen::MatrixXd::Constant(2, 2, dhat), initial_positions});
  const auto place = [&](std::size_t k) {
    return joined(mesh,
                  [&](std::size_t of) -> const Points3& { return (of == 0 ? a : b).places[k]; });
  };
  for (std::size_t k = 0; k + 1 < a.places.size(); ++k)
    if (!contact.is_collision_free_between_sheets(place(k), place(k + 1), hard)) return false;
  return true;
}

/// One step of several sheets, with one matrix and one contact for all.
class Elastic::Impl::JointStep {
 public:
  JointStep(const std::vector<JointStepSheet>& sheets, double dt);
  std::vector<ElasticReport> solve(const Eigen::MatrixXd& dhat);

 private:
  Impl& solver(std::size_t k) const { return *sheets_[k].elastic.impl_; }
  SheetContact make_contact(const Eigen::MatrixXd& dhat) const;
  BlockCholesky make_matrix(const SheetContact&) const;
  /// The sum of the potentials, with all their terms bound to the matrix.
  IncrementalPotential bind(BlockCholesky&, SheetContact&) const;
  std::vector<Points3> guesses() const;
  NewtonReport minimise(const IncrementalPotential&, BlockCholesky&, Points3& x) const;
  FrictionHistory history_of_pairs() const;
  void finish(std::size_t k, const Points3& x, const PositionConstraints& springs,
              const FrictionHistory& pairs, ElasticReport&) const;

  const std::vector<JointStepSheet>& sheets_;
  std::vector<StepProblem> problems_;  // of each sheet
  double dt_;                          // [s]
  MergedMesh mesh_;
  Points3 before_;            // |V|x3 [m] positions at the beginning
  PositionConstraints hard_;  // of all sheets
  // no vertex is eliminated: handles pull with springs
  std::vector<int> block_of_;
};

Elastic::Impl::JointStep::JointStep(const std::vector<JointStepSheet>& sheets, double dt)
    : sheets_(sheets), dt_(dt) {
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    Impl& s = solver(k);
    const Sheet& sheet = sheets[k].sheet;
    problems_.push_back(s.problem_of(sheet, sheets[k].input, dt));
    add_hard(problems_[k].hard, mesh_.first.back(), hard_);
    mesh_.add(s.pattern, s.triangles);
    s.begin_creases(sheet, sheets[k].input, problems_[k]);
    s.find_ridges_of_step(sheet, vertices_of(problems_[k].constraints));
    s.update_predictor(sheet, vertices_of(problems_[k].hard));
  }
  before_ = joined(mesh_, [&](std::size_t k) -> const Points3& { return sheets[k].sheet.x; });
  block_of_.resize(mesh_.first.back());
  std::iota(block_of_.begin(), block_of_.end(), 0);
}

SheetContact Elastic::Impl::JointStep::make_contact(const Eigen::MatrixXd& dhat) const {
  std::vector<double> friction;
  std::vector<int> number;
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    friction.push_back(solver(k).paper.friction);
    number.push_back(solver(k).options.sheet_number);
  }
  const Points3 initial_positions =
      sheets_.front().initial_positions.rows()
          ? joined(mesh_,
                   [&](std::size_t k) -> const Points3& { return sheets_[k].initial_positions; })
          : Points3(0, 3);
  return SheetContact(mesh_.pattern, mesh_.triangles,
                      {mesh_.of_vertex, dhat, initial_positions, friction, number, mesh_.first});
}

BlockCholesky Elastic::Impl::JointStep::make_matrix(const SheetContact& contact) const {
  std::vector<std::pair<int, int>> coupled = contact.coupled_vertices(before_);
  for (std::size_t k = 0; k < sheets_.size(); ++k)
    for (const auto& [i, j] : solver(k).energy->coupled_vertices())
      coupled.emplace_back(mesh_.first[k] + i, mesh_.first[k] + j);
  return BlockCholesky(mesh_.first.back(), std::move(coupled));
}

IncrementalPotential Elastic::Impl::JointStep::bind(BlockCholesky& matrix,
                                                    SheetContact& contact) const {
  contact.bind(matrix, block_of_);
  IncrementalPotential W{{}, &contact};
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    Impl& s = solver(k);
    const StepProblem& problem = problems_[k];
    s.matrix.reset();  // its energy is now bound to the matrix of all
    s.block_of.assign(block_of_.begin() + mesh_.first[k], block_of_.begin() + mesh_.first[k + 1]);
    s.energy->bind(matrix, s.block_of);
    if (s.colliders)
      s.colliders->begin(sheets_[k].sheet.x, problem.colliders, {}, problem.hard, s.state.friction);
    W.sheets.push_back(s.potential(sheets_[k].sheet, problem, problem.constraints));
  }
  return W;
}

/// Guesses for all sheets; one with fewer of its own repeats its last, which leaves it where it is.
std::vector<Points3> Elastic::Impl::JointStep::guesses() const {
  std::vector<std::vector<Points3>> starts;
  std::size_t max_starts = 0;
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    starts.push_back(solver(k).guesses(sheets_[k].sheet.x, problems_[k].hard, true));
    max_starts = std::max(max_starts, starts.back().size());
  }
  std::vector<Points3> guesses;
  for (std::size_t g = 0; g < max_starts; ++g)
    guesses.push_back(joined(mesh_, [&](std::size_t k) -> const Points3& {
      return starts[k][std::min(g, starts[k].size() - 1)];
    }));
  return guesses;
}

NewtonReport Elastic::Impl::JointStep::minimise(const IncrementalPotential& W,
                                                BlockCholesky& matrix, Points3& x) const {
  NewtonOptions how{solver(0).options.stop, 0};
  double mean_edge = std::numeric_limits<double>::infinity(), stiffness = 0;
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    const Impl& s = solver(k);
    mean_edge = std::min(mean_edge, s.mean_edge);
    stiffness = std::max(stiffness, s.paper.membrane_stiffness);
    how.max_iterations = std::max(how.max_iterations, s.max_contact_iterations());
  }
  return paperbake::minimise({W, matrix, block_of_, mean_edge, stiffness}, how, {}, x);
}

/// What pairs of features of all sheets remember. Each sheet keeps that of pairs whose first
/// feature is its own.
FrictionHistory Elastic::Impl::JointStep::history_of_pairs() const {
  FrictionHistory history;
  for (std::size_t k = 0; k < sheets_.size(); ++k)
    history.take(solver(k).state.friction,
                 [](const std::array<int, 2>& body) { return body[0] >= 0; });
  return history;
}

void Elastic::Impl::JointStep::finish(std::size_t k, const Points3& x,
                                      const PositionConstraints& springs,
                                      const FrictionHistory& pairs, ElasticReport& report) const {
  Impl& s = solver(k);
  Sheet& sheet = sheets_[k].sheet;
  const Points3 before = sheet.x;
  sheet.x = x.middleRows(mesh_.first[k], mesh_.rows(k));
  s.report_constraints(sheet.x, springs, report);
  s.friction_at_end.clear();
  if (s.colliders) s.colliders->remember(sheet.x, s.friction_at_end);
  s.friction_at_end.take(
      pairs, [&](const std::array<int, 2>& body) { return body[0] == s.options.sheet_number; });
  s.state.second.reset();
  s.state.descending = false;
  s.state.had_contact = report.has_contact();
  s.finish_step(sheet, before, problems_[k], report);
}

std::vector<ElasticReport> Elastic::Impl::JointStep::solve(const Eigen::MatrixXd& dhat) {
  SheetContact contact = make_contact(dhat);
  contact.begin(before_, hard_, history_of_pairs());
  BlockCholesky matrix = make_matrix(contact);
  const IncrementalPotential W = bind(matrix, contact);
  std::vector<Points3> starts = guesses();
  Points3 x = before_;
  choose_initial_guess(W, before_, starts, x);
  const NewtonReport newton = minimise(W, matrix, x);

  contact.update_candidates(x, Points3::Zero(x.rows(), 3));
  const std::vector<SheetContact::Touching> touching = contact.touching_by_sheet(x);
  FrictionHistory pairs;
  contact.remember(x, pairs);
  std::vector<ElasticReport> reports(sheets_.size());
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    reports[k].iterations = newton.iterations;
    reports[k].converged = newton.converged;
    reports[k].contact = true;
    reports[k].touching = touching[k].own;
    reports[k].touching_others = touching[k].others;
    finish(k, x, W.sheets[k].springs, pairs, reports[k]);
  }
  return reports;
}

std::vector<ElasticReport> Elastic::step_together(const std::vector<JointStepSheet>& all,
                                                  const Eigen::MatrixXd& dhat, double dt) {
  return Impl::JointStep(all, dt).solve(dhat);
}

}  // namespace paperbake
