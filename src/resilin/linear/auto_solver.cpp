#include <algorithm>
#include <utility>

#include "resilin/core/log.hpp"
#include "resilin/linear/catalog.hpp"

namespace resilin {
namespace {

/// A solver and what it may cost: the iterations on one matrix after which the next solver is the cheaper
/// one.
struct Candidate {
  std::unique_ptr<LinearSolver> solver;
  int affordable_iterations;
};

/// Tries solvers in turn, each until it has spent what the next one costs: within a solve that does not
/// converge and from solve to solve with the same matrix. The matrices that follow in the same search begin
/// with the solver that this has led to, and every search with the first, so that a run that is taken up
/// again gives the same bits as an unbroken one. Where there is no memory for a direct one that comes first,
/// a spare takes its place for good; one that comes later is left out.
class SolverChain : public LinearSolver {
 public:
  /// `spare` may be null.
  SolverChain(std::vector<Candidate> candidates, std::unique_ptr<LinearSolver> spare)
      : candidates_(std::move(candidates)), spare_(std::move(spare)) {}

  std::string_view name() const override { return candidates_.front().solver->name(); }
  bool is_direct() const override { return candidates_.front().solver->is_direct(); }
  void begin_search() override {
    current_ = 0;
    for (const Candidate& candidate : candidates_) candidate.solver->begin_search();
  }
  double expected_bytes(const BlockPattern& pattern, int dim) const override {
    return candidates_.front().solver->expected_bytes(pattern, dim);
  }
  void release() override {
    for (const Candidate& candidate : candidates_) candidate.solver->release();
  }

  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    solver().analyze(A, node_positions);
    node_positions_ = node_positions;
  }

  LinearReport factorize(const BlockMatrix& A) override {
    spent_ = 0;
    LinearReport report = solver().factorize(A);
    if (report.status != LinearReport::Status::out_of_memory) return report;
    if (current_ > 0) {
      candidates_.resize(current_);
      current_ = 0;
    } else {
      if (spare_ == nullptr) return report;
      candidates_.front().solver = std::move(spare_);
    }
    log_info(report.shortage + "; " + std::string(solver().name()) + " solves instead");
    solver().analyze(A, node_positions_);
    return solver().factorize(A);
  }

  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override {
    if (has_next() && spent_ > candidates_[current_].affordable_iterations) go_to_next(A);
    LinearReport report = solver().solve(A, b, x, relative_tolerance);
    int iterations = report.iterations;
    while (report.status == LinearReport::Status::not_converged && has_next()) {
      const LinearReport next = go_to_next(A);
      if (next.status == LinearReport::Status::out_of_memory) break;  // the last iterate is all there is
      report = next;
      if (next.status != LinearReport::Status::ok) break;
      report = solver().solve(A, b, x, relative_tolerance);
      iterations += report.iterations;
    }
    spent_ += iterations;
    report.iterations = iterations;
    return report;
  }

 private:
  LinearSolver& solver() { return *candidates_[current_].solver; }
  bool has_next() const { return current_ + 1 < candidates_.size(); }

  /// Stays where it is unless the next solver has its factors.
  LinearReport go_to_next(const BlockMatrix& A) {
    LinearSolver& next = *candidates_[current_ + 1].solver;
    next.analyze(A, node_positions_);
    const LinearReport report = next.factorize(A);
    spent_ = 0;
    if (report.status == LinearReport::Status::ok) ++current_;
    if (report.status == LinearReport::Status::out_of_memory) candidates_.resize(current_ + 1);
    return report;
  }

  std::vector<Candidate> candidates_;
  std::unique_ptr<LinearSolver> spare_;
  std::size_t current_ = 0;
  int spent_ = 0;  ///< iterations with the present matrix
  VectorX node_positions_;
};

}  // namespace

// Limits from `resilin bench solvers` (docs/performance.md): in 3D at rest the multigrid overtakes the direct
// solver at about 2,500 unknowns and is 6 times faster at 47,000. Thin walls, materials that are all but
// incompressible or full of stiff fibres and many solves with one matrix make it give way to it. With mass,
// incomplete Cholesky needs some 5 to 40 iterations and the cheapest set-up.
std::unique_ptr<LinearSolver> make_auto(const LinearOptions& options, Index num_unknowns) {
  constexpr Index most_unknowns_direct_first = 2500;
  constexpr Index most_unknowns_direct = 300000;  // about 4 GB
  constexpr int iterations_incomplete = 80;       // then a multigrid set-up pays
  // A factorisation costs 200 iterations of the multigrid at 47,000 unknowns, and grows like their square.
  const int iterations_multigrid = std::max(40, num_unknowns / 230);
  std::vector<Candidate> solvers;
  const auto add = [&](const char* kind, int max_iterations) {
    LinearOptions choice = options;
    choice.kind = kind;
    choice.max_iterations = max_iterations;
    solvers.push_back({make_linear_solver(choice, num_unknowns), max_iterations});
  };
  const bool has_direct = !options.is_definite || num_unknowns <= most_unknowns_direct;
  const bool is_small = num_unknowns <= most_unknowns_direct_first;
  const bool is_direct_first = !options.is_definite || (!options.is_dynamic && is_small);
  if (!is_direct_first) {
    if (options.is_dynamic) add("cg_ic0", iterations_incomplete);
    add("cg_amg", has_direct ? iterations_multigrid : options.max_iterations);
  }
#ifdef RESILIN_HAS_LAPACK
  if (has_direct) add("multifrontal", 0);
#else
  if (has_direct) add(options.is_definite ? "cholesky" : "ldlt", 0);
#endif
  // One that works in less memory: without the BLAS, whose own is 128 MiB.
  std::unique_ptr<LinearSolver> spare = is_direct_first && is_small ? make_ldlt(options) : nullptr;
  return std::make_unique<SolverChain>(std::move(solvers), std::move(spare));
}

}  // namespace resilin
