#pragma once

#include <vector>

#include "resilin/fit/law_choice.hpp"
#include "resilin/fit/parameter_transform.hpp"
#include "resilin/fit/predicted_values.hpp"

namespace resilin {

/// The least-squares problem of one law, without dimensions: stresses and constants of a stress are in units
/// of `stress_scale`.
///
///   minimise |r|^2,  r = weights * (predicted(c, v) - measured) / stress_scale
///
/// c: constants in which the law is linear; v: the others.
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

  /// How v is sought, and its limits from the law, the settings and what numbers can hold: by the logarithm
  /// where it must be positive.
  const std::vector<ParameterTransform>& transforms() const { return transforms_; }
  /// The same of c and v. Limits of c may be infinite.
  std::vector<ParameterTransform> all_transforms() const;
  const VectorX& linear_lower() const { return linear_lower_; }
  const VectorX& linear_upper() const { return linear_upper_; }

  /// r = A c - y; false where the law says nothing.
  bool linear_part(const VectorX& v, DenseMatrix& A, VectorX& y) const;
  /// dr/dv.
  bool nonlinear_slopes(const VectorX& c, const VectorX& v, DenseMatrix& B) const;
  /// r, and dr/d(c, v), unless null.
  bool residuals(const VectorX& c, const VectorX& v, VectorX* r, DenseMatrix* slopes) const;

  /// Constants of the formula in units of the problem, and in SI.
  std::vector<double> scaled_constants(const VectorX& c, const VectorX& v) const;
  std::vector<double> constants(const VectorX& c, const VectorX& v) const;
  /// The reverse of `constants`, v within its limits; not a number where it has no logarithm.
  void unknowns(const std::vector<double>& constants, VectorX& c, VectorX& v) const;
  /// dr/d(constants of choice().fitted(), in units of the problem).
  bool slopes_by_constants(const VectorX& c, const VectorX& v, DenseMatrix& slopes) const;
  /// Factor from a constant in units of the problem to SI.
  double unit_of(int place) const;

  /// Starts of v for the search: a grid of each, all combinations; the settings' start comes first.
  std::vector<VectorX> starts() const;

 private:
  const LawChoice& choice_;
  const PredictedValues& predicted_;
  VectorX measured_, weights_;
  double stress_scale_;
  std::vector<ParameterTransform> transforms_;
  VectorX linear_lower_, linear_upper_;
  std::vector<double> start_;  ///< start of v; not a number where none was given
};

}  // namespace resilin
