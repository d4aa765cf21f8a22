#include "resilin/fit/regularised_problem.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"
#include "resilin/core/error.hpp"

namespace resilin {
namespace {

constexpr double least_influence =
    1e-8;  ///< least influence of a column of F beside the largest: nothing feels it
constexpr int points_per_decade = 8;
constexpr double weakest_share = 1e-12;  ///< weakest share of the largest of S
/// Weights with which the fit takes more than this part of the data follow noise, whatever the curve looks
/// like.
constexpr double most_freedom = 0.8;

}  // namespace

RegularisedProblem::RegularisedProblem(const DenseMatrix& J, const VectorX& d, const FieldPrior& prior)
    : prior_(prior), slopes_(J), d_(d), num_values_(d.size()) {
  if (J.rows() > J.cols()) {
    const dense::Reflections factors = dense::reflections(J);
    const VectorX turned = dense::transposed_times(factors, d);
    slopes_ = dense::upper_triangle(factors);
    d_ = turned.head(J.cols());
    left_ = turned.tail(d.size() - J.cols()).squaredNorm();
  }
  spread_ = prior.inverse_times(slopes_.transpose());
  spread_of_values_ = slopes_ * spread_;
  spread_of_values_ = 0.5 * (spread_of_values_ + spread_of_values_.transpose()).eval();
  slopes_of_unfelt_ = slopes_ * prior.unfelt();
  const Eigen::Index m = d_.size(), k = slopes_of_unfelt_.cols();
  const double size = slopes_.norm();
  for (Eigen::Index i = 0; i < k; ++i)
    if (!(slopes_of_unfelt_.col(i).norm() > least_influence * size))
      throw InputError("fit", "measurements that depend on all unknowns",
                       "a piece of a body, or a parameter, without effect on the data",
                       "measure there, leave it out, or take regularise = { kind = \"both\" }");
  if (k >= m)
    throw InputError("fit", "more than " + std::to_string(k) + " measured numbers", std::to_string(m),
                     "measure more");
  const dense::Reflections factors = dense::reflections(slopes_of_unfelt_);
  const DenseMatrix from_left = dense::transposed_times(factors, spread_of_values_);
  const DenseMatrix turned = dense::transposed_times(factors, from_left.transpose());
  const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(turned.bottomRightCorner(m - k, m - k));
  s_ = eigen.values.cwiseMax(0.0);
  DenseMatrix vectors = DenseMatrix::Zero(m, m - k);
  vectors.bottomRows(m - k) = eigen.vectors;
  basis_ = dense::times(factors, vectors);
  b_ = basis_.transpose() * d_;
}

RegularisedProblem::Point RegularisedProblem::at(double a) const {
  const auto damped = (s_.array() + a).inverse().eval();
  const auto b2 = b_.array().square().eval();
  Point point{.strength = a};
  point.misfit = left_ + (a * damped).square().matrix().dot(b2.matrix());
  point.roughness = (s_.array() * damped.square() * b2).sum();
  point.freedom = static_cast<double>(slopes_of_unfelt_.cols()) + (s_.array() * damped).sum();
  // By log a: T = sum s b^2 / (s + a)^3, P = sum s b^2 / (s + a)^4.
  const double T = (s_.array() * b2 * damped.cube()).sum();
  const double P = (s_.array() * b2 * damped.square().square()).sum();
  const double r1 = 2 * a * a * T / point.misfit, e1 = -2 * a * T / point.roughness;
  const double r2 = (4 * a * a * T - 6 * a * a * a * P) / point.misfit - r1 * r1;
  const double e2 = (-2 * a * T + 6 * a * a * P) / point.roughness - e1 * e1;
  point.curvature = (r1 * e2 - r2 * e1) / std::pow(r1 * r1 + e1 * e1, 1.5);
  return point;
}

VectorX RegularisedProblem::solution(double a) const {
  const VectorX c = basis_ * ((s_.array() + a).inverse() * b_.array()).matrix();
  const VectorX b = slopes_of_unfelt_.cols() > 0
                        ? VectorX(dense::least_squares(slopes_of_unfelt_, d_ - spread_of_values_ * c))
                        : VectorX();
  return spread_ * c + prior_.unfelt() * b;
}

double RegularisedProblem::strongest() const { return 10 * s_.maxCoeff(); }
double RegularisedProblem::weakest() const { return weakest_share * s_.maxCoeff(); }

RegularisedProblem::Uncertainty RegularisedProblem::uncertainty(double a) const {
  const Eigen::Index m = d_.size();
  const DenseMatrix& B = prior_.unfelt();
  DenseMatrix L;
  dense::cholesky(spread_of_values_ + a * DenseMatrix::Identity(m, m), L);
  const DenseMatrix half_spread = dense::solve_lower(L, spread_.transpose()),
                    half_F = dense::solve_lower(L, slopes_of_unfelt_);
  Uncertainty result;
  result.variance = (prior_.inverse_diagonal() - half_spread.colwise().squaredNorm().transpose()) / a;
  const DenseMatrix CJ =
      basis_ * ((s_.array() + a).inverse().matrix().asDiagonal() * (basis_.transpose() * slopes_));
  result.resolution = spread_.cwiseProduct(CJ.transpose()).rowwise().sum();
  if (B.cols() == 0) return result;
  DenseMatrix of_open;
  dense::cholesky(half_F.transpose() * half_F, of_open);
  const DenseMatrix rest = B.transpose() - half_F.transpose() * half_spread;
  result.variance += dense::solve_lower(of_open, rest).colwise().squaredNorm().transpose() / a;
  const DenseMatrix half = dense::solve_lower(of_open, DenseMatrix::Identity(B.cols(), B.cols()));
  result.of_open = half.transpose() * half / a;
  const DenseMatrix by_data = dense::least_squares(slopes_of_unfelt_, slopes_ - spread_of_values_ * CJ);
  result.resolution += B.cwiseProduct(by_data.transpose()).rowwise().sum();
  return result;
}

LCurve l_curve(const RegularisedProblem& problem) {
  LCurve curve;
  const double step = std::pow(10, -1.0 / points_per_decade);
  const double most = most_freedom * static_cast<double>(problem.num_values());
  double best = 0;
  for (double a = problem.strongest(); a >= problem.weakest(); a *= step) {
    const RegularisedProblem::Point point = problem.at(a);
    if (point.freedom > most || !(point.roughness > 0) || !(point.misfit > 0)) break;
    curve.points.push_back(point);
    if (!(point.curvature > best)) continue;
    best = point.curvature;
    curve.corner = a;
  }
  return curve;
}

double discrepancy_strength(const RegularisedProblem& problem) {
  // The misfit grows with the weight, the freedom falls.
  const auto excess = [&](double a) {
    const RegularisedProblem::Point point = problem.at(a);
    const double left = static_cast<double>(problem.num_values()) - point.freedom;
    return point.misfit - (left + 2 * std::sqrt(2 * left));
  };
  double low = problem.weakest(), high = problem.strongest();
  if (!(excess(low) < 0)) return 0;
  if (excess(high) < 0) return high;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (excess(middle) < 0 ? low : high) = middle;
  }
  return low;
}

double cross_validated_strength(const RegularisedProblem& problem) {
  double best = problem.strongest(), least = std::numeric_limits<double>::infinity();
  const double step = std::pow(10, -1.0 / points_per_decade);
  for (double a = problem.strongest(); a >= problem.weakest(); a *= step) {
    const RegularisedProblem::Point point = problem.at(a);
    const double left = static_cast<double>(problem.num_values()) - point.freedom;
    if (!(left > (1 - most_freedom) * static_cast<double>(problem.num_values()))) break;
    const double score = point.misfit / (left * left);
    if (!(score < least)) continue;
    least = score;
    best = a;
  }
  return best;
}

}  // namespace resilin
