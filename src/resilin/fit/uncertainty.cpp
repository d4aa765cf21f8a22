#include "resilin/fit/uncertainty.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "resilin/core/dense.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr double no_influence =
    1e-7;  ///< singular values below this part of the largest are round-off and model
constexpr double strong_correlation = 0.95;
constexpr double large_condition = 1e6;

/// An orthonormal basis of what is orthogonal to these rows.
DenseMatrix directions_along(const DenseMatrix& rows, Eigen::Index n) {
  if (rows.rows() == 0) return DenseMatrix::Identity(n, n);
  const DenseMatrix columns = rows.transpose();
  return dense::times(dense::pivoted_reflections(columns), DenseMatrix::Identity(n, n))
      .rightCols(n - dense::rank(columns, 1e-8));
}

std::string two_digits(double value) {
  const double size = std::pow(10, std::floor(std::log10(std::abs(value))) - 1);
  return format_short(std::round(value / size) * size);
}

}  // namespace

double student_t_95(double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

double chi_square_99(double degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), 0.99);
}

Uncertainty uncertainty_of(const DenseMatrix& slopes, double variance, const DenseMatrix& reached) {
  const Eigen::Index n = slopes.cols();
  Uncertainty result;
  result.is_determined.assign(static_cast<std::size_t>(n), true);
  result.covariance = DenseMatrix::Zero(n, n);
  result.condition = 1;
  VectorX scale = slopes.colwise().norm();
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(scale[i] > 0)) scale[i] = 1;
  const DenseMatrix along = directions_along(reached * scale.cwiseInverse().asDiagonal(), n);
  result.num_free = static_cast<int>(along.cols());
  if (along.cols() == 0) return result;
  const DenseMatrix scaled = slopes * scale.cwiseInverse().asDiagonal() * along;
  const auto [s, right] = dense::singular_values(scaled);
  const double largest = s[0], smallest = s[s.size() - 1];
  result.condition = smallest > 0 && s.size() == along.cols() ? (largest / smallest) * (largest / smallest)
                                                              : std::numeric_limits<double>::infinity();
  const DenseMatrix V = along * right;
  VectorX inverse = VectorX::Zero(s.size());
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < s.size(); ++k) {
    if (!(s[k] > no_influence * largest)) {
      for (Eigen::Index i = 0; i < n; ++i)
        if (std::abs(V(i, k)) > 1e-4) result.is_determined[static_cast<std::size_t>(i)] = false;
      continue;
    }
    inverse[k] = 1 / (s[k] * s[k]);
    ++rank;
  }
  if (s.size() < along.cols()) result.is_determined.assign(static_cast<std::size_t>(n), false);
  const DenseMatrix unscaled = scale.cwiseInverse().asDiagonal() * V;
  result.covariance = variance * unscaled * inverse.asDiagonal() * unscaled.transpose();
  if (rank < s.size()) result.determined = scale.asDiagonal() * V.leftCols(rank);
  return result;
}

std::string combination_text(const VectorX& weights, const std::vector<std::string>& names) {
  std::string text;
  double first = 0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    if (first == 0) {
      first = weights[i];
      text = names[static_cast<std::size_t>(i)];
      continue;
    }
    const double part = weights[i] / first;
    text += part > 0 ? " + " : " - ";
    if (std::abs(std::abs(part) - 1) > 5e-3) text += two_digits(std::abs(part)) + " ";
    text += names[static_cast<std::size_t>(i)];
  }
  return text;
}

namespace {

/// Constants that the tests leave open, and what of them they do determine.
void tell_open_constants(const Uncertainty& uncertainty, const std::vector<std::string>& names,
                         const std::vector<double>& units, Estimates& fit) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!uncertainty.is_determined[i]) open.push_back(names[i]);
  if (open.empty()) {
    if (uncertainty.condition > large_condition)
      fit.warnings.push_back(
          "the constants are poorly determined by these tests: the normal matrix has a condition of " +
          format_short(uncertainty.condition) + "; other modes would tell them apart");
    return;
  }
  // The part of what is determined that lies among the open ones.
  std::string combinations;
  for (Eigen::Index k = 0; k < uncertainty.determined.cols(); ++k) {
    VectorX weights = VectorX::Zero(static_cast<Eigen::Index>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!uncertainty.is_determined[i])
        weights[static_cast<Eigen::Index>(i)] =
            uncertainty.determined(static_cast<Eigen::Index>(i), k) / units[i];
    const double largest = weights.cwiseAbs().maxCoeff();
    weights = (weights.array().abs() > 1e-3 * largest).select(weights, 0.0);
    if (largest > 0 && uncertainty.determined.cols() == 1) combinations = combination_text(weights, names);
  }
  fit.warnings.push_back(combinations.empty()
                             ? join(open) + ": not determined by these tests"
                             : "only " + combinations + " is determined by these tests; each alone is not");
}

}  // namespace

void tell_uncertainty(const Uncertainty& uncertainty, const std::vector<double>& units, double factor_95,
                      Estimates& fit) {
  std::vector<ConstantEstimate*> fitted;
  std::vector<std::string> names;
  for (ConstantEstimate& constant : fit.constants)
    if (constant.is_fitted()) {
      fitted.push_back(&constant);
      names.push_back(constant.name);
    }
  fit.condition = uncertainty.condition;
  const DenseMatrix& C = uncertainty.covariance;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    fitted[i]->is_determined = uncertainty.is_determined[i];
    if (!fitted[i]->is_determined) continue;
    const auto k = static_cast<Eigen::Index>(i);
    fitted[i]->standard_error = std::sqrt(std::max(0.0, C(k, k))) * units[i];
    fitted[i]->half_width_95 = factor_95 * fitted[i]->standard_error;
  }
  tell_open_constants(uncertainty, names, units, fit);
  for (std::size_t i = 0; i < fitted.size(); ++i)
    for (std::size_t j = 0; j < fitted.size(); ++j) {
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      const double size = std::sqrt(C(a, a) * C(b, b)), value = i == j ? 1 : size > 0 ? C(a, b) / size : 0;
      fit.correlation_matrix.push_back(value);
      if (j <= i || !(std::abs(value) > strong_correlation) || !fitted[i]->is_determined ||
          !fitted[j]->is_determined)
        continue;
      std::string text = names[i] + " and " + names[j] + " are correlated (" + format_short(value) + ")";
      if (fitted[i]->unit == fitted[j]->unit) {
        VectorX weights = VectorX::Zero(static_cast<Eigen::Index>(names.size()));
        weights[a] = 1 / fitted[i]->standard_error;
        weights[b] = (value > 0 ? -1 : 1) / fitted[j]->standard_error;
        text += ": " + combination_text(weights, names) + " is known better than each alone";
      }
      fit.correlations.push_back({names[i], names[j], value, text});
    }
  std::ranges::stable_sort(fit.correlations, [](const Correlation& a, const Correlation& b) {
    return std::abs(a.value) > std::abs(b.value);
  });
}

}  // namespace resilin
