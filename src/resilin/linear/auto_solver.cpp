#include <utility>

#include "resilin/core/log.hpp"
#include "resilin/linear/catalog.hpp"

namespace resilin {
namespace {

/// Tries solvers in turn: the next one where the one before does not converge.
///
/// Every solve begins with the first, so that a run that is taken up again gives the same bits as an unbroken
/// one. Where there is no memory for a direct one that comes first, a spare takes its place for good.
class SolverChain : public LinearSolver {
 public:
  /// `spare` may be null.
  SolverChain(std::vector<std::unique_ptr<LinearSolver>> solvers, std::unique_ptr<LinearSolver> spare)
      : solvers_(std::move(solvers)), spare_(std::move(spare)) {}

  std::string_view name() const override { return solvers_.front()->name(); }
  bool is_direct() const override { return solvers_.front()->is_direct(); }

  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    solvers_.front()->analyze(A, node_positions);
    node_positions_ = node_positions;
  }

  LinearReport factorize(const BlockMatrix& A) override {
    const LinearReport report = solvers_.front()->factorize(A);
    if (report.status != LinearReport::Status::out_of_memory || spare_ == nullptr) return report;
    solvers_.front() = std::move(spare_);
    log_info(report.shortage + "; " + std::string(name()) + " solves instead");
    return solvers_.front()->factorize(A);
  }

  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override {
    LinearReport report = solvers_.front()->solve(A, b, x, relative_tolerance);
    int iterations = report.iterations;
    for (std::size_t k = 1; k < solvers_.size(); ++k) {
      if (report.status != LinearReport::Status::not_converged) break;
      solvers_[k]->analyze(A, node_positions_);
      LinearReport next = solvers_[k]->factorize(A);
      if (next.status == LinearReport::Status::out_of_memory) break;  // the last iterate is all there is
      if (next.status == LinearReport::Status::ok) next = solvers_[k]->solve(A, b, x, relative_tolerance);
      report = next;
      iterations += report.iterations;
    }
    report.iterations = iterations;
    return report;
  }

 private:
  std::vector<std::unique_ptr<LinearSolver>> solvers_;
  std::unique_ptr<LinearSolver> spare_;
  VectorX node_positions_;
};

}  // namespace

// Limits from `resilin bench solvers` (docs/performance.md): in 3D at rest the multigrid overtakes the direct
// solver at about 2,500 unknowns and is 6 times faster at 47,000; it gives way to it only where the material
// is all but incompressible. With mass, incomplete Cholesky needs some 5 to 40 iterations and the cheapest
// set-up.
std::unique_ptr<LinearSolver> make_auto(const LinearOptions& options, Index num_unknowns) {
  constexpr Index most_unknowns_direct_first = 2500;
  constexpr Index most_unknowns_direct = 300000;  // about 4 GB
  constexpr int iterations_incomplete = 80;       // then a multigrid set-up pays
  constexpr int iterations_multigrid = 200;       // about the cost of a factorisation
  std::vector<std::unique_ptr<LinearSolver>> solvers;
  const auto add = [&](const char* kind, int max_iterations) {
    LinearOptions choice = options;
    choice.kind = kind;
    choice.max_iterations = max_iterations;
    solvers.push_back(make_linear_solver(choice, num_unknowns));
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
