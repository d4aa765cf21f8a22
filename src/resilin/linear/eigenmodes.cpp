#include "resilin/linear/eigenmodes.hpp"

#include <random>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

using Eigen::MatrixXd;

constexpr double first_shift = 1e-8;     ///< first shift, relative to the largest diagonal entry of M^-1 K
constexpr double zero_in_shifts = 1e-3;  ///< a value below this part of the shift is zero
constexpr double largest_residual =
    1e-9;  ///< largest residual of a vector, relative; that of its value is its square
constexpr double solve_tolerance = 1e-12;
constexpr Index more_columns = 4;  ///< columns of a block beyond the values that are asked for
constexpr int max_blocks = 8;      ///< in the basis, then it is restarted from the best vectors
constexpr int max_restarts = 30;
constexpr Index most_unknowns_dense = 200;
constexpr double rank_tolerance = 1e-24;  ///< rank tolerance of squared lengths in a block

class KrylovSearch {
 public:
  KrylovSearch(const EigenProblem& problem, Index count, LinearSolver& solver)
      : problem_(problem), solver_(solver), count_(count) {
    for (std::size_t i = 0; i < problem.is_fixed.size(); ++i)
      if (problem.is_fixed[i] == 0) free_.push_back(static_cast<Eigen::Index>(i));
  }

  EigenModes run(const std::function<bool()>& is_stopped);

 private:
  bool factorize_shifted(EigenModes& modes);
  EigenModes solve_densely() const;
  MatrixXd random_block(Eigen::Index columns) const;
  MatrixXd times_mass(const MatrixXd& X) const;
  MatrixXd apply(const MatrixXd& X, int& num_solves);
  bool orthonormalize(MatrixXd& W, MatrixXd& factor) const;

  const EigenProblem& problem_;
  LinearSolver& solver_;
  Eigen::Index count_;
  std::vector<Eigen::Index> free_;
  BlockMatrix shifted_;
  double shift_ = 0;
};

/// Entries that differ from run to run in nothing, in (-1, 1).
MatrixXd KrylovSearch::random_block(Eigen::Index columns) const {
  std::mt19937_64 generator(20240607);
  MatrixXd X = MatrixXd::Zero(static_cast<Eigen::Index>(problem_.is_fixed.size()), columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (const Eigen::Index i : free_) X(i, j) = static_cast<double>(generator() >> 11) * 0x1p-52 - 1;
  }
  return X;
}

MatrixXd KrylovSearch::times_mass(const MatrixXd& X) const {
  MatrixXd MX(X.rows(), X.cols());
  VectorX y;
  for (Eigen::Index j = 0; j < X.cols(); ++j) {
    problem_.multiply_mass(X.col(j), y);
    MX.col(j) = y;
  }
  return MX;
}

/// (K + s M)^-1 M X.
MatrixXd KrylovSearch::apply(const MatrixXd& X, int& num_solves) {
  MatrixXd Y = times_mass(X);
  for (Eigen::Index j = 0; j < Y.cols(); ++j) {
    VectorX b = VectorX::Zero(Y.rows());
    for (const Eigen::Index i : free_) b[i] = Y(i, j);
    VectorX x = VectorX::Zero(Y.rows());
    solver_.solve(shifted_, b, x, solve_tolerance);
    Y.col(j) = x;
    ++num_solves;
  }
  return Y;
}

/// W = V R with V^T M V = 1; V, with fewer columns when W has not full rank, takes the place of W. False when
/// nothing is left.
bool KrylovSearch::orthonormalize(MatrixXd& W, MatrixXd& R) const {
  R = MatrixXd::Identity(W.cols(), W.cols());
  for (int pass = 0; pass < 2; ++pass) {
    const MatrixXd gram = dense::transposed_product(W, times_mass(W));
    const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(0.5 * (gram + gram.transpose()));
    const VectorX& squares = eigen.values;
    const double smallest = std::max(rank_tolerance * squares.tail(1)[0], 1e-300);
    const Eigen::Index rank = (squares.array() > smallest).count();
    if (rank == 0) return false;
    const MatrixXd kept = eigen.vectors.rightCols(rank);
    const VectorX lengths = squares.tail(rank).cwiseSqrt();
    R = dense::transposed_product(kept * lengths.asDiagonal(), R);
    W = dense::product(W, kept) * lengths.cwiseInverse().asDiagonal();
  }
  return true;
}

/// Factorises K + s M; s grows until the matrix is positive definite.
bool KrylovSearch::factorize_shifted(EigenModes& modes) {
  const BlockMatrix& K = problem_.stiffness;
  BlockMatrix M(K.dim, K.pattern);
  problem_.add_mass(1, M);
  double largest = 0;
  for (const Eigen::Index i : free_) {
    const Offset diagonal = K.pattern->row_begin[static_cast<std::size_t>(i / K.dim)];
    const auto entry = (i % K.dim) * (K.dim + 1);
    largest = std::max(largest, std::abs(K.block(diagonal)[entry]) / M.block(diagonal)[entry]);
  }
  for (shift_ = first_shift * largest; shift_ <= 100 * largest; shift_ *= 10) {
    shifted_ = K;
    problem_.add_mass(shift_, shifted_);
    eliminate(shifted_, problem_.is_fixed);
    solver_.analyze(shifted_, {});
    const LinearReport report = solver_.factorize(shifted_);
    if (report.status == LinearReport::Status::ok) {
      modes.zero = zero_in_shifts * first_shift * largest;
      return true;
    }
    const bool is_short = report.status == LinearReport::Status::out_of_memory;
    modes.status = is_short ? EigenModes::Status::out_of_memory : EigenModes::Status::not_converged;
    modes.shortage = report.shortage;
    if (is_short) return false;
  }
  return false;
}

EigenModes KrylovSearch::solve_densely() const {
  const auto n = static_cast<Eigen::Index>(free_.size());
  MatrixXd K(n, n), M(n, n);
  const auto size = static_cast<Eigen::Index>(problem_.is_fixed.size());
  VectorX y;
  for (Eigen::Index j = 0; j < n; ++j) {
    const VectorX unit = VectorX::Unit(size, free_[static_cast<std::size_t>(j)]);
    multiply(problem_.stiffness, unit, y);
    K.col(j) = y(free_);
    problem_.multiply_mass(unit, y);
    M.col(j) = y(free_);
  }
  const dense::Eigenpairs eigen = dense::generalized_eigenpairs(0.5 * (K + K.transpose()), M);
  EigenModes modes;
  if (!eigen.is_converged) modes.status = EigenModes::Status::not_converged;
  modes.values = eigen.values.head(count_);
  modes.vectors = MatrixXd::Zero(size, count_);
  modes.vectors(free_, Eigen::all) = eigen.vectors.leftCols(count_);
  modes.zero = zero_in_shifts * first_shift * eigen.values.cwiseAbs().maxCoeff();
  return modes;
}

EigenModes KrylovSearch::run(const std::function<bool()>& is_stopped) {
  const auto n = static_cast<Eigen::Index>(free_.size());
  const Eigen::Index columns = count_ + more_columns;
  if (n <= std::max<Eigen::Index>(most_unknowns_dense, 3 * columns)) return solve_densely();
  EigenModes modes;
  if (!factorize_shifted(modes)) return modes;
  MatrixXd next = apply(random_block(columns), modes.num_solves);
  MatrixXd R;
  orthonormalize(next, R);
  for (int restart = 0; restart < max_restarts; ++restart) {
    MatrixXd basis(next.rows(), 0);
    MatrixXd projected(0, 0);  // basis^T M (K + s M)^-1 M basis
    for (int block = 0; block < max_blocks; ++block) {
      const Eigen::Index before = basis.cols(), size = before + next.cols();
      basis.conservativeResize(Eigen::NoChange, size);
      basis.rightCols(next.cols()) = next;
      MatrixXd W = apply(next, modes.num_solves);
      MatrixXd H = dense::transposed_product(basis, times_mass(W));
      W -= dense::product(basis, H);
      // Once more: orthogonal to round-off.
      const MatrixXd correction = dense::transposed_product(basis, times_mass(W));
      W -= dense::product(basis, correction);
      H += correction;
      projected.conservativeResize(size, size);
      projected.rightCols(next.cols()) = H;
      projected.bottomLeftCorner(next.cols(), before) = H.topRows(before).transpose();
      const Eigen::Index last = next.cols();
      const bool is_exhausted = !orthonormalize(W, R);
      if (is_exhausted) R = MatrixXd::Zero(1, last);
      const dense::Eigenpairs ritz = dense::symmetric_eigenpairs(0.5 * (projected + projected.transpose()));
      const Eigen::Index found = std::min(size, columns);
      const VectorX theta = ritz.values.tail(found).reverse();
      const MatrixXd coordinates = ritz.vectors.rightCols(found).rowwise().reverse();
      const VectorX residuals = dense::product(R, coordinates.bottomRows(last)).colwise().norm();
      const bool is_converged =
          found >= count_ &&
          (residuals.head(count_).array() <= largest_residual * theta.head(count_).array().abs()).all();
      if (is_converged || is_exhausted) {
        modes.status = is_converged ? EigenModes::Status::converged : EigenModes::Status::not_converged;
        modes.values = theta.head(count_).cwiseInverse().array() - shift_;
        modes.vectors = dense::product(basis, coordinates.leftCols(count_));
        return modes;
      }
      if (is_stopped && is_stopped()) {
        modes.status = EigenModes::Status::interrupted;
        return modes;
      }
      next = W;
      if (block + 1 == max_blocks) next = dense::product(basis, coordinates);
    }
  }
  modes.status = EigenModes::Status::not_converged;
  return modes;
}

}  // namespace

EigenModes smallest_eigenmodes(const EigenProblem& problem, Index count, LinearSolver& solver,
                               const std::function<bool()>& is_stopped) {
  return KrylovSearch(problem, count, solver).run(is_stopped);
}

}  // namespace resilin
