#include <Eigen/SparseCholesky>
#include <cmath>
#include <new>

#include "resilin/linear/catalog.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/scalar_columns.hpp"

namespace resilin {
namespace {

/// Eigen's simplicial L D L^T in approximate minimum degree order: always there, quick for small systems
/// only.
class SimplicialSolver : public DirectSolver {
 public:
  explicit SimplicialSolver(bool is_definite) : is_definite_(is_definite) {}

  std::string_view name() const override { return "ldlt"; }

  void analyze(const BlockMatrix& A, const VectorX&) override {
    if (pattern_.update(A, MergedPattern::Keep::superset)) analyze_pattern(A.dim);
  }

  LinearReport factorize(const BlockMatrix& A) override {
    analyze(A, {});
    columns_.set_values(pattern_, A);
    LinearReport report;
    try {
      factors_.factorize(matrix());
    } catch (const std::bad_alloc&) {
      report.status = LinearReport::Status::out_of_memory;
      return report;
    }
    const VectorX& pivots = factors_.vectorD();
    for (Offset k = 0; k < pivots.size(); ++k) {
      if (pivots[k] > 0 && std::isfinite(pivots[k])) continue;
      if (!is_definite_ && pivots[k] < 0 && std::isfinite(pivots[k])) {
        ++report.negative_pivots;
        continue;
      }
      report.status = LinearReport::Status::indefinite;
      report.worst_node = static_cast<Index>(factors_.permutationPinv().indices()[k] / A.dim);
      break;
    }
    return report;
  }

 protected:
  void solve_factored(const VectorX& b, VectorX& x) override { x = factors_.solve(b); }

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;

  void analyze_pattern(int dim) {
    columns_.set_pattern(pattern_, dim);
    factors_.analyzePattern(matrix());
  }

  Eigen::Map<const SparseMatrix> matrix() const {
    const auto size = static_cast<Offset>(columns_.begin.size()) - 1;
    return {size,
            size,
            static_cast<Offset>(columns_.rows.size()),
            columns_.begin.data(),
            columns_.rows.data(),
            columns_.values.data()};
  }

  bool is_definite_;
  MergedPattern pattern_;
  ScalarColumns<int> columns_;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factors_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_ldlt(const LinearOptions& options) {
  return std::make_unique<SimplicialSolver>(options.is_definite);
}

}  // namespace resilin
