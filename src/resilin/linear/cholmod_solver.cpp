#include <cholmod.h>

#include <new>

#include "resilin/linear/blas.hpp"
#include "resilin/linear/catalog.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/ordering.hpp"
#include "resilin/linear/scalar_columns.hpp"

namespace resilin {
namespace {

/// CHOLMOD's supernodal L L^T. METIS orders the graph of the nodes, which is quicker than that of the
/// unknowns and gives the same fill.
class CholmodSolver : public DirectSolver {
 public:
  CholmodSolver() {
    cholmod_l_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    common_.postorder = 1;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.final_ll = 1;
  }
  ~CholmodSolver() override {
    cholmod_l_free_dense(&solution_, &common_);
    cholmod_l_free_dense(&solve_work_, &common_);
    cholmod_l_free_dense(&solve_more_work_, &common_);
    cholmod_l_free_factor(&factors_, &common_);
    cholmod_l_finish(&common_);
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  std::string_view name() const override { return "cholesky"; }

 protected:
  void prepare(const BlockMatrix& A, MergedPattern::Keep keep) override;
  LinearReport factorize_prepared(const BlockMatrix& A) override;
  void forget() override {
    pattern_.reset();
    cholmod_l_free_factor(&factors_, &common_);
  }
  void solve_factored(const VectorX& b, VectorX& x) override;

 private:
  void analyze_pattern(int dim);
  double bytes_needed() const;
  cholmod_sparse matrix();

  MergedPattern pattern_;
  ScalarColumns<SuiteSparse_long> columns_;
  cholmod_common common_{};
  cholmod_factor* factors_ = nullptr;
  cholmod_dense *solution_ = nullptr, *solve_work_ = nullptr, *solve_more_work_ = nullptr;
};

cholmod_sparse CholmodSolver::matrix() {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = columns_.begin.size() - 1;
  matrix.nzmax = columns_.rows.size();
  matrix.p = columns_.begin.data();
  matrix.i = columns_.rows.data();
  matrix.x = columns_.values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_LONG;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
  return matrix;
}

void CholmodSolver::analyze_pattern(int dim) {
  std::vector<SuiteSparse_long> order;
  for (const Index node : fill_reducing_order(NodeGraph(pattern_)))
    for (int d = 0; d < dim; ++d) order.push_back(SuiteSparse_long{node} * dim + d);
  columns_.set_pattern(pattern_, dim);
  cholmod_sparse lower = matrix();
  cholmod_l_free_factor(&factors_, &common_);
  factors_ = cholmod_l_analyze_p(&lower, order.data(), nullptr, 0, &common_);
}

double CholmodSolver::bytes_needed() const {
  return static_cast<double>(factors_->xsize + factors_->maxcsize) * sizeof(double);
}

void CholmodSolver::prepare(const BlockMatrix& A, MergedPattern::Keep keep) {
  if (!pattern_.update(A, keep)) return;
  analyze_pattern(A.dim);
  if (factors_ == nullptr || common_.status < CHOLMOD_OK) throw std::bad_alloc();
  foresee(bytes_needed(), A);
}

LinearReport CholmodSolver::factorize_prepared(const BlockMatrix& A) {
  // CHOLMOD starts up to 4 threads by OpenMP, which ends the process where it cannot have their stacks.
  constexpr double stacks = 4 * 8 << 20;
  columns_.set_values(pattern_, A);
  cholmod_sparse lower = matrix();
  const SingleThreadedBlas single_threaded(1, static_cast<std::size_t>(bytes_needed() + stacks));
  cholmod_l_factorize(&lower, factors_, &common_);
  if (common_.status < CHOLMOD_OK) throw std::bad_alloc();
  LinearReport report;
  if (factors_->minor < factors_->n) {
    report.status = LinearReport::Status::indefinite;
    report.worst_node =
        static_cast<Index>(static_cast<SuiteSparse_long*>(factors_->Perm)[factors_->minor] / A.dim);
  }
  return report;
}

void CholmodSolver::solve_factored(const VectorX& b, VectorX& x) {
  const SingleThreadedBlas single_threaded;
  cholmod_dense right_side{};
  right_side.nrow = right_side.d = right_side.nzmax = static_cast<std::size_t>(b.size());
  right_side.ncol = 1;
  right_side.x = const_cast<double*>(b.data());  // read only: CHOLMOD's interface has no const
  right_side.xtype = CHOLMOD_REAL;
  right_side.dtype = CHOLMOD_DOUBLE;
  if (cholmod_l_solve2(CHOLMOD_A, factors_, &right_side, nullptr, &solution_, nullptr, &solve_work_,
                       &solve_more_work_, &common_) == 0)
    throw std::bad_alloc();
  x = Eigen::Map<const VectorX>(static_cast<const double*>(solution_->x), b.size());
}

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod(const LinearOptions&) { return std::make_unique<CholmodSolver>(); }

}  // namespace resilin
