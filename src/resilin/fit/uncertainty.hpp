#pragma once

#include <vector>

#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/predicted_values.hpp"

namespace resilin {

/// Student's t for an interval of 95 % with so many degrees of freedom.
double student_t_95(double degrees_of_freedom);
/// The same where the size of errors is known.
constexpr double normal_95 = 1.959963984540054;
/// 99 % quantile of the chi-squared distribution with so many degrees of freedom.
double chi_square_99(double degrees_of_freedom);

/// Uncertainty of the constants from the residuals around the optimum.
struct Uncertainty {
  DenseMatrix covariance;  ///< covariance of the constants in the units of `slopes`
  std::vector<bool> is_determined;
  double condition;  ///< condition of the normal matrix, its columns of length 1
  /// Combinations w^T p that the data determine where they leave others open: columns.
  DenseMatrix determined;
  int num_free = 0;  ///< directions that no limit holds
};

/// @param slopes    dr/dp
/// @param variance  of one residual
/// @param reached   rows of limits that hold the constants; the covariance is along them
Uncertainty uncertainty_of(const DenseMatrix& slopes, double variance, const DenseMatrix& reached);

/// "c10 + 2 c01": of the names whose weight is not zero, the first with weight 1.
std::string combination_text(const VectorX& weights, const std::vector<std::string>& names);

/// Fills standard errors, intervals, correlations and what is said about them.
/// @param units  of the constants in `slopes`, in SI
void tell_uncertainty(const Uncertainty& uncertainty, const std::vector<double>& units, double factor_95,
                      Estimates& fit);

}  // namespace resilin
