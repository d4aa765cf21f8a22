#pragma once

namespace resilin {

/// Mullins softening of an isochoric energy W [J/m^3]: the stress of W times a factor that depends on W and
/// on the largest W that the point has had, W_max.
///
///   eta = 1 - erf((W_max - W) / (m + beta W_max)) / r,   1 where W >= W_max
///
/// Source: Ogden & Roxburgh 1999, in the form of Abaqus with beta. Theory: docs/theory/mullins.md.
struct Softening {
  double r = 2;     ///< > 1: at most 1/r of the stress is lost
  double m = 0;     ///< [J/m^3]
  double beta = 0;  ///< share of W_max

  double factor(double W, double most) const;        ///< eta
  double factor_slope(double W, double most) const;  ///< d eta / dW; 0 where eta is 1
  /// The energy whose derivative by W is eta; 0 at W = 0, and as exact relative to itself as W is.
  double energy(double W, double most) const;

 private:
  double width(double most) const { return m + beta * most; }
};

}  // namespace resilin
