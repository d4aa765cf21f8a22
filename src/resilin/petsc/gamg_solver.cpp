#include "resilin/petsc/gamg_solver.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "resilin/core/rigid_motions.hpp"
#include "resilin/linear/decoupled.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/linear/merged_pattern.hpp"
#include "resilin/petsc/session.hpp"

namespace resilin {
namespace {

/// A handle of PETSc's with the function that gives it back.
template <class Handle, PetscErrorCode (*destroy)(Handle*)>
class Owned {
 public:
  Owned() = default;
  ~Owned() { reset(); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  void reset() {
    if (handle_ != nullptr) destroy(&handle_);
    handle_ = nullptr;
  }
  Handle* to() {
    reset();
    return &handle_;
  }
  operator Handle() const { return handle_; }

 private:
  Handle handle_ = nullptr;
};

/// A preconditioner is worn when a digit takes so many iterations more than with the matrix that it was made
/// for: its set-up costs about thirty.
constexpr double worn_after_per_digit = 5;

/// Conjugate gradients preconditioned by PETSc's GAMG: smoothed aggregation (Vanek, Mandel & Brezina 1996)
/// with the rigid motions of the present shape. One matrix's preconditioner serves those that follow in a
/// search as it is, until iterations cost more than another: parts of it for new values (GAMG's
/// `reuse_interpolation`) turn it indefinite where a body stiffens, the whole of it stays definite.
///
/// The matrix is assembled from what each process has of it (MatSetValuesCOO): blocks of nodes that another
/// process owns are sent there.
class PetscGamg final : public LinearSolver {
 public:
  explicit PetscGamg(const LinearOptions& options)
      : share_(options.share), max_iterations_(options.max_iterations) {
    start_petsc();
    communicator_ = share_.is_whole() ? PETSC_COMM_SELF : PETSC_COMM_WORLD;
  }

  std::string_view name() const override { return "petsc_gamg"; }
  bool is_direct() const override { return false; }
  /// The values once more with their places, PETSc's own matrix, and about half as much for the coarse
  /// levels.
  double expected_bytes(const BlockPattern& pattern, int dim) const override {
    constexpr double bytes_per_entry = 8 + 8 + 12 + 6 + 24;
    return 2.0 * static_cast<double>(pattern.num_slots()) * dim * dim * bytes_per_entry;
  }
  void begin_search() override { is_worn_ = true; }
  void release() override {
    solver_.reset();
    matrix_.reset();
    pattern_.reset();
  }

  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    const bool is_new = pattern_.update(A, MergedPattern::Keep::superset);
    if (share_.any(is_new)) preallocate(A);
    positions_ = node_positions;
  }

  LinearReport factorize(const BlockMatrix& A) override {
    const int dim = A.dim;
    // A pattern that has lost extra blocks keeps their places.
    if (!pattern_.is_that_of(A)) std::ranges::fill(values_, 0.0);
    pattern_.for_each_block(A, [&](Offset slot, const double* block) {
      double* to = values_.data() + places_[static_cast<std::size_t>(slot)];
      std::copy_n(block, dim * dim, to);
      if (!is_diagonal_[static_cast<std::size_t>(slot)])
        for (int r = 0; r < dim; ++r)
          for (int c = 0; c < dim; ++c) to[dim * dim + c * dim + r] = block[r * dim + c];
    });
    require_petsc(MatSetValuesCOO(matrix_, values_.data(), INSERT_VALUES));
    find_fixed(A);
    if (solver_ == nullptr || is_worn_) return make_solver(dim);
    is_kept_ = true;
    require_petsc(KSPSetReusePreconditioner(solver_, PETSC_TRUE));
    require_petsc(KSPSetOperators(solver_, matrix_, matrix_));
    return {};
  }

  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override {
    const int dim = A.dim;
    put_owned(b, dim, right_side_);
    put_owned(x, dim, solution_);
    LinearReport report;
    KSPConvergedReason reason = run_solver(relative_tolerance, report.iterations);
    // With its own preconditioner from where the other has led to.
    if (reason < 0 && reason != KSP_DIVERGED_INDEFINITE_MAT && is_kept_ &&
        make_solver(dim).status == LinearReport::Status::ok)
      reason = run_solver(relative_tolerance, report.iterations);
    double residual = 0, size = 0;
    require_petsc(KSPGetResidualNorm(solver_, &residual));
    require_petsc(VecNorm(right_side_, NORM_2, &size));
    report.relative_residual = size > 0 ? residual / size : 0;
    report.status = status_of(reason);
    get_all(dim, x);
    // Fixed DOFs do not move, by no rounding either.
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (is_free_[i] == 0 && b[i] == 0) x[i] = 0;
    return report;
  }

 private:
  static LinearReport::Status status_of(KSPConvergedReason reason) {
    if (reason > 0) return LinearReport::Status::ok;
    const bool is_cut_short = reason == KSP_DIVERGED_ITS || reason == KSP_DIVERGED_BREAKDOWN;
    return is_cut_short ? LinearReport::Status::not_converged : LinearReport::Status::indefinite;
  }

  Offset ranked_number(Index node) const {
    return share_.is_whole() ? Offset{node}
                             : share_.exchange().ranked_numbers()[static_cast<std::size_t>(node)];
  }

  /// Where each entry goes: PETSc then knows whom to send it to, and its pattern.
  void preallocate(const BlockMatrix& A) {
    const int dim = A.dim;
    solver_.reset();
    places_.clear();
    is_diagonal_.clear();
    std::vector<PetscInt> rows, columns;
    const auto add_block = [&](Index i, Index j) {
      const Offset row = ranked_number(i) * dim, column = ranked_number(j) * dim;
      for (int r = 0; r < dim; ++r)
        for (int c = 0; c < dim; ++c) {
          rows.push_back(static_cast<PetscInt>(row + r));
          columns.push_back(static_cast<PetscInt>(column + c));
        }
    };
    for (Index i = 0; i < pattern_.num_nodes(); ++i)
      for (Offset slot = pattern_.row_begin[static_cast<std::size_t>(i)];
           slot < pattern_.row_begin[static_cast<std::size_t>(i) + 1]; ++slot) {
        const Index j = pattern_.columns[static_cast<std::size_t>(slot)];
        places_.push_back(static_cast<Offset>(rows.size()));
        is_diagonal_.push_back(i == j ? 1 : 0);
        add_block(i, j);
        if (i != j) add_block(j, i);
      }
    owned_.clear();
    for (Index node = 0; node < pattern_.num_nodes(); ++node)
      if (share_.owns(node)) owned_.push_back(node);
    const auto size = static_cast<PetscInt>(owned_.size() * static_cast<std::size_t>(dim));
    require_petsc(MatCreate(communicator_, matrix_.to()));
    require_petsc(MatSetSizes(matrix_, size, size, PETSC_DETERMINE, PETSC_DETERMINE));
    require_petsc(MatSetBlockSize(matrix_, dim));
    require_petsc(MatSetType(matrix_, MATAIJ));
    require_petsc(
        MatSetPreallocationCOO(matrix_, static_cast<PetscCount>(rows.size()), rows.data(), columns.data()));
    require_petsc(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
    require_petsc(MatCreateVecs(matrix_, solution_.to(), right_side_.to()));
    values_.assign(rows.size(), 0.0);
  }

  /// Unknowns that are fixed on every process that has them.
  void find_fixed(const BlockMatrix& A) {
    const std::vector<std::uint8_t> is_decoupled = decoupled_unknowns(A);
    VectorX couplings(static_cast<Eigen::Index>(is_decoupled.size()));
    for (Eigen::Index i = 0; i < couplings.size(); ++i)
      couplings[i] = is_decoupled[static_cast<std::size_t>(i)] != 0 ? 0 : 1;
    share_.add_copies(couplings);
    is_free_ = couplings.cwiseMin(1.0);
  }

  /// The rigid motions of the shape, zero at fixed unknowns, so that the preconditioner leaves these alone;
  /// orthonormal.
  void set_rigid_motions(int dim) {
    Vector3 center = Vector3::Zero();
    double num_nodes = 0;
    for (const Index node : owned_)
      for (int k = 0; k < dim; ++k) center[k] += positions_[Eigen::Index{node} * dim + k];
    num_nodes = share_.sum(static_cast<double>(owned_.size()));
    center = share_.sum(center) / num_nodes;
    const int count = dim == 3 ? 6 : 3;
    std::vector<Owned<Vec, VecDestroy>> vectors(static_cast<std::size_t>(count));
    std::vector<Vec> kept;
    for (int motion = 0; motion < count; ++motion) {
      Vec* vector = vectors[static_cast<std::size_t>(motion)].to();
      require_petsc(VecDuplicate(right_side_, vector));
      VectorX values = VectorX::Zero(positions_.size());
      for (const Index node : owned_) {
        Vector3 r = Vector3::Zero();
        r.head(dim) = positions_.segment(Eigen::Index{node} * dim, dim);
        values.segment(Eigen::Index{node} * dim, dim) = rigid_motions(dim, r - center).col(motion);
      }
      put_owned(values.cwiseProduct(is_free_), dim, *vector);
      double before = 0, after = 0;
      require_petsc(VecNorm(*vector, NORM_2, &before));
      for (const Vec other : kept) {
        PetscScalar product = 0;
        require_petsc(VecDot(*vector, other, &product));
        require_petsc(VecAXPY(*vector, -product, other));
      }
      require_petsc(VecNormalize(*vector, &after));
      if (after > 1e-8 * before) kept.push_back(*vector);  // else it is one of those before
    }
    if (kept.empty()) return;
    Owned<MatNullSpace, MatNullSpaceDestroy> motions;
    require_petsc(MatNullSpaceCreate(communicator_, PETSC_FALSE, static_cast<PetscInt>(kept.size()),
                                     kept.data(), motions.to()));
    require_petsc(MatSetNearNullSpace(matrix_, motions));
  }

  /// Conjugate gradients from what `solution_` holds; adds what it took to `iterations`.
  KSPConvergedReason run_solver(double relative_tolerance, int& iterations) {
    const double digits = std::max(1.0, -std::log10(relative_tolerance));
    const double allowed = (iterations_per_digit_ + worn_after_per_digit) * digits;
    const int most = is_kept_ ? std::min(max_iterations_, static_cast<int>(2 * allowed)) : max_iterations_;
    require_petsc(KSPSetTolerances(solver_, relative_tolerance, PETSC_DEFAULT, 1e10, most));
    require_petsc(KSPSetInitialGuessNonzero(solver_, iterations > 0 ? PETSC_TRUE : PETSC_FALSE));
    require_petsc(KSPSolve(solver_, right_side_, solution_));
    PetscInt taken = 0;
    require_petsc(KSPGetIterationNumber(solver_, &taken));
    iterations += static_cast<int>(taken);
    if (!is_kept_ && iterations_per_digit_ == 0) iterations_per_digit_ = taken / digits;
    if (is_kept_ && taken > allowed) is_worn_ = true;
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    require_petsc(KSPGetConvergedReason(solver_, &reason));
    return reason;
  }

  LinearReport make_solver(int dim) {
    if (positions_.size() > 0) set_rigid_motions(dim);
    is_worn_ = is_kept_ = false;
    iterations_per_digit_ = 0;
    require_petsc(KSPCreate(communicator_, solver_.to()));
    require_petsc(KSPSetType(solver_, KSPCG));
    require_petsc(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED));
    PC preconditioner = nullptr;
    require_petsc(KSPGetPC(solver_, &preconditioner));
    require_petsc(PCSetType(preconditioner, PCGAMG));
    require_petsc(KSPSetFromOptions(solver_));
    require_petsc(KSPSetOperators(solver_, matrix_, matrix_));
    require_petsc(KSPSetUp(solver_));
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    require_petsc(KSPGetConvergedReason(solver_, &reason));
    LinearReport report;
    if (reason == KSP_DIVERGED_PC_FAILED) report.status = LinearReport::Status::indefinite;
    return report;
  }

  void put_owned(const VectorX& values, int dim, Vec to) const {
    PetscScalar* entries = nullptr;
    require_petsc(VecGetArray(to, &entries));
    for (const Index node : owned_)
      for (int k = 0; k < dim; ++k) *entries++ = values[Eigen::Index{node} * dim + k];
    entries -= owned_.size() * static_cast<std::size_t>(dim);
    require_petsc(VecRestoreArray(to, &entries));
  }

  void get_all(int dim, VectorX& x) const {
    const PetscScalar* entries = nullptr;
    require_petsc(VecGetArrayRead(solution_, &entries));
    x.setZero();
    const PetscScalar* from = entries;
    for (const Index node : owned_)
      for (int k = 0; k < dim; ++k) x[Eigen::Index{node} * dim + k] = *from++;
    require_petsc(VecRestoreArrayRead(solution_, &entries));
    share_.add_copies(x);
  }

  ProcessGroup share_;
  int max_iterations_;
  MPI_Comm communicator_ = MPI_COMM_NULL;
  MergedPattern pattern_;
  std::vector<Offset> places_;             ///< by slot: of its first entry in `values_`
  std::vector<std::uint8_t> is_diagonal_;  ///< by slot; other blocks stand there twice, transposed
  std::vector<double> values_;
  std::vector<Index> owned_;
  VectorX positions_;  ///< the latest
  VectorX is_free_;    ///< by unknown: 1, or 0 where it is fixed
  Owned<Mat, MatDestroy> matrix_;
  Owned<Vec, VecDestroy> solution_, right_side_;
  Owned<KSP, KSPDestroy> solver_;
  bool is_worn_ = true;              ///< the next matrix gets its own preconditioner
  bool is_kept_ = false;             ///< it was made for a matrix before this one
  double iterations_per_digit_ = 0;  ///< iterations per digit of the first solve with it
};

std::unique_ptr<LinearSolver> make_petsc_gamg(const LinearOptions& options) {
  return std::make_unique<PetscGamg>(options);
}

}  // namespace

std::string petsc_version() {
  char library[MPI_MAX_LIBRARY_VERSION_STRING] = {};
  int length = 0;
  MPI_Get_library_version(library, &length);  // allowed before MPI begins
  const std::string mpi(library, static_cast<std::size_t>(length));
  return "PETSc " + std::to_string(PETSC_VERSION_MAJOR) + "." + std::to_string(PETSC_VERSION_MINOR) + "." +
         std::to_string(PETSC_VERSION_SUBMINOR) + " and " + mpi.substr(0, mpi.find_first_of(",\n"));
}

void register_petsc_solver() {
  register_linear_solver({.name = "petsc_gamg", .make = make_petsc_gamg, .is_distributed = true});
}

}  // namespace resilin
