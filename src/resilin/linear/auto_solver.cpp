#include <utility>

#include "resilin/linear/catalog.hpp"

namespace resilin {
namespace {

/// Conjugate gradients first; a direct factorisation where they do not arrive within some iterations.
///
/// Every solve begins with conjugate gradients, so that a run which is taken up again gives the same bits.
class IterativeThenDirect : public LinearSolver {
 public:
  IterativeThenDirect(std::unique_ptr<LinearSolver> iterative, std::unique_ptr<LinearSolver> direct)
      : iterative_(std::move(iterative)), direct_(std::move(direct)) {}

  std::string_view name() const override { return iterative_->name(); }
  bool is_direct() const override { return false; }
  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    iterative_->analyze(A, node_positions);
  }
  LinearReport factorize(const BlockMatrix& A) override { return iterative_->factorize(A); }

  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override {
    LinearReport report = iterative_->solve(A, b, x, relative_tolerance);
    if (report.status != LinearReport::Status::not_converged) return report;
    const int iterations = report.iterations;
    const LinearReport factors = direct_->factorize(A);
    if (factors.status == LinearReport::Status::out_of_memory)
      return report;  // the last iterate is all there is
    if (factors.status == LinearReport::Status::indefinite) {
      report.status = factors.status;
      report.worst_node = factors.worst_node;
      return report;
    }
    report = direct_->solve(A, b, x, relative_tolerance);
    report.iterations = iterations;
    return report;
  }

 private:
  std::unique_ptr<LinearSolver> iterative_, direct_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_auto(const LinearOptions& options, Index num_unknowns) {
  constexpr Index most_unknowns_direct = 60000;
  constexpr int most_iterations = 300;  // about the cost of a factorisation
  LinearOptions direct = options, iterative = options;
  direct.kind = "cholesky";
  iterative.kind = "cg_ic0";
  iterative.max_iterations = num_unknowns <= most_unknowns_direct ? most_iterations : options.max_iterations;
  if (!options.is_dynamic && num_unknowns <= most_unknowns_direct)
    return make_linear_solver(direct, num_unknowns);
  return std::make_unique<IterativeThenDirect>(make_linear_solver(iterative, num_unknowns),
                                               make_linear_solver(direct, num_unknowns));
}

}  // namespace resilin
