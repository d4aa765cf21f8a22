#pragma once

#include <vector>

#include "resilin/fit/law_choice.hpp"
#include "resilin/fit/predicted_values.hpp"

namespace resilin {

/// The least-squares problem of one law, without dimensions: stresses and constants of a stress are in units
/// of `stress_scale`, and constants that must be positive are sought by their logarithm where the law is not
/// linear in them.
///
///   minimise |r|^2,  r = weights * (predicted(c, z) - measured) / stress_scale
///
/// c: constants in which the law is linear; z: the others, transformed.
class LawProblem {
 public:
  /// @param measured  [Pa]
  /// @param weights   of each residual, of measured / stress_scale
  LawProblem(const LawChoice& choice, const PredictedValues& predicted, const VectorX& measured,
             const VectorX& weights, double stress_scale, const std::vector<ConstantSetting>& settings);

  Eigen::Index num_rows() const { return measured_.size(); }
  Eigen::Index num_linear() const { return static_cast<Eigen::Index>(choice_.linear.size()); }
  Eigen::Index num_nonlinear() const { return static_cast<Eigen::Index>(choice_.nonlinear.size()); }
  const LawChoice& choice() const { return choice_; }
  double stress_scale() const { return stress_scale_; }

  /// Limits of z, from the law, the settings and what numbers can hold.
  const VectorX& lower() const { return lower_; }
  const VectorX& upper() const { return upper_; }
  /// Limits of c; infinite where there are none.
  const VectorX& linear_lower() const { return linear_lower_; }
  const VectorX& linear_upper() const { return linear_upper_; }

  /// r = A c - y; false where the law says nothing.
  bool linear_part(const VectorX& z, DenseMatrix& A, VectorX& y) const;
  /// dr/dz.
  bool nonlinear_slopes(const VectorX& c, const VectorX& z, DenseMatrix& B) const;
  /// r, and dr/d(c, z) unless null.
  bool residuals(const VectorX& c, const VectorX& z, VectorX& r, DenseMatrix* slopes) const;

  /// Constants of the formula in units of the problem, and in SI.
  std::vector<double> scaled_constants(const VectorX& c, const VectorX& z) const;
  std::vector<double> constants(const VectorX& c, const VectorX& z) const;
  /// The reverse of `constants`.
  void unknowns(const std::vector<double>& constants, VectorX& c, VectorX& z) const;
  /// dr/d(constants of choice().fitted(), in units of the problem).
  bool slopes_by_constants(const VectorX& c, const VectorX& z, DenseMatrix& slopes) const;
  /// Factor from a constant in units of the problem to SI.
  double unit_of(int place) const;
  bool is_logarithm(Eigen::Index i) const { return is_logarithm_[static_cast<std::size_t>(i)]; }

  /// A start of z for the search: a grid of each, all combinations; the settings' start comes first.
  std::vector<VectorX> starts() const;

 private:
  double slope_of_transform(Eigen::Index i, const VectorX& z) const;

  const LawChoice& choice_;
  const PredictedValues& predicted_;
  VectorX measured_, weights_;
  double stress_scale_;
  std::vector<bool> is_logarithm_;
  VectorX lower_, upper_, linear_lower_, linear_upper_;
  std::vector<double> start_;  ///< start of z; not a number where none was given
};

}  // namespace resilin
