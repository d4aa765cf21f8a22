#pragma once

#include <vector>

#include "resilin/fit/field_prior.hpp"

namespace resilin {

/// min |d - J u|^2 + a u^T R u, for all weights a at once: solved in the space of the data, of which there
/// are fewer than unknowns.
///
/// With G of the prior, Q = J G J^T, B what R does not feel and F = J B: u = G J^T c + B b,
/// (Q + a I) c + F b = d, F^T c = 0 (universal kriging: Wahba 1990, ch. 1). Z spans what is orthogonal to F
/// and Z^T Q Z = U S U^T, so that c = Z U (S + a)^-1 U^T Z^T d, and misfit, roughness and the trace of what
/// the fit makes of the data are sums over S (Hansen 1998, ch. 4 and 7).
class RegularisedProblem {
 public:
  /// @param J      by all unknowns, weighed by the sigmas
  /// @throws InputError  where no datum feels what the prior leaves open
  RegularisedProblem(const DenseMatrix& J, const VectorX& d, const FieldPrior& prior);

  /// With a weight.
  struct Point {
    double strength = 0;
    double misfit = 0;     ///< |d - J u|^2
    double roughness = 0;  ///< u^T R u
    double freedom = 0;    ///< combinations of the unknowns that the data determine: the trace of d(J u)/dd
    double curvature = 0;  ///< curvature of log roughness over log misfit, positive in a corner of an L
  };
  Point at(double strength) const;
  VectorX solution(double strength) const;

  Eigen::Index num_values() const { return num_values_; }
  /// Between these weights the data matter less and less; outside nothing changes.
  double weakest() const;
  double strongest() const;

  /// Uncertainty of the unknowns, for a residual of variance 1: what prior and data leave open (Wahba 1983).
  struct Uncertainty {
    VectorX variance;
    VectorX resolution;   ///< diagonal of d(u found)/d(u true): 1 where a datum tells an unknown alone
    DenseMatrix of_open;  ///< covariance of what the prior does not feel
  };
  Uncertainty uncertainty(double strength) const;

 private:
  const FieldPrior& prior_;
  DenseMatrix slopes_;  ///< J of the data, compressed to at most as many as unknowns
  DenseMatrix spread_;  ///< G J^T
  VectorX d_;
  Eigen::Index num_values_;
  double left_ = 0;               ///< part of |d|^2 that no u changes
  DenseMatrix spread_of_values_;  ///< J G J^T
  DenseMatrix slopes_of_unfelt_;  ///< J B
  DenseMatrix basis_;             ///< Z U
  VectorX s_, b_;                 ///< S, and U^T Z^T d
};

/// The weights of a problem from the strongest to the weakest, and its corner: where the curve of the
/// logarithms of misfit and roughness is bent most (Hansen 2001); 0 where it has none.
struct LCurve {
  std::vector<RegularisedProblem::Point> points;
  double corner = 0;
};
LCurve l_curve(const RegularisedProblem& problem);

/// The largest weight whose misfit residuals of variance 1 may leave: n, of data that the fit does not
/// determine, and two standard deviations more, 2 sqrt(2 n) (Morozov's principle with Wahba's count); 0 where
/// no weight is weak enough.
double discrepancy_strength(const RegularisedProblem& problem);

/// Where a datum that was left out would be foretold best: generalised cross validation (Wahba 1990, ch. 4).
double cross_validated_strength(const RegularisedProblem& problem);

}  // namespace resilin
