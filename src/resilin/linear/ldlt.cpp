#include <Eigen/SparseCholesky>
#include <cmath>

#include "resilin/linear/catalog.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/ordering.hpp"
#include "resilin/linear/scalar_columns.hpp"

namespace resilin {
namespace {

/// Eigen's simplicial L D L^T in an order of the nodes: always there, quick for small systems only.
class SimplicialSolver : public DirectSolver {
 public:
  explicit SimplicialSolver(bool is_definite) : is_definite_(is_definite) {}

  std::string_view name() const override { return "ldlt"; }

 protected:
  void prepare(const BlockMatrix& A, MergedPattern::Keep keep) override {
    if (!pattern_.update(A, keep)) return;
    columns_.set_pattern(pattern_, A.dim);
    std::vector<int> order;
    for (const Index node : fill_reducing_order(NodeGraph(pattern_)))
      for (int d = 0; d < A.dim; ++d) order.push_back(node * A.dim + d);
    factors_.analyze(matrix(), order);
    // Eigen has asked for the factor by now: what its use takes is foreseen.
    foresee(static_cast<double>(factors_.num_entries()) * (sizeof(double) + sizeof(int)), A, free_memory);
  }

  void forget() override {
    pattern_.reset();
    factors_.release();
  }

  LinearReport factorize_prepared(const BlockMatrix& A) override {
    columns_.set_values(pattern_, A);
    LinearReport report;
    factors_.factorize(matrix());
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

  void solve_factored(const VectorX& b, VectorX& x) override { x = factors_.solve(b); }

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;

  struct Factors : Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> {
    /// @param order  of the unknowns: theirs by position
    void analyze(const SparseMatrix& lower, const std::vector<int>& order) {
      m_Pinv.indices() = Eigen::Map<const Eigen::VectorXi>(order.data(), lower.cols());
      m_P = m_Pinv.inverse();
      CholMatrixType upper(lower.cols(), lower.cols());
      upper.selfadjointView<Eigen::Upper>() = lower.selfadjointView<Eigen::Lower>().twistedBy(m_P);
      analyzePattern_preordered(upper, /*doLDLT=*/true);
    }
    Eigen::Index num_entries() const { return m_matrix.data().size(); }  ///< known from the analysis on
    void release() { m_matrix = CholMatrixType(); }
  };

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
  Factors factors_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_ldlt(const LinearOptions& options) {
  return std::make_unique<SimplicialSolver>(options.is_definite);
}

}  // namespace resilin
