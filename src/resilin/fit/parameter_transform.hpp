#pragma once

namespace resilin {

/// How a search varies one number: the variable z is the number w, its logarithm, or a logit of either.
class ParameterTransform {
 public:
  /// z = w or log w, between bounds that the search may reach.
  static ParameterTransform in_box(bool is_logarithm, double lower, double upper);
  /// z = log((w - l) / (h - w)) between two finite bounds, of w or log w; they are never reached, and z has
  /// no bounds. With fewer bounds z = w or log w.
  static ParameterTransform within(bool is_logarithm, double lower, double upper);

  double to(double value) const;           ///< z of a value
  double from(double z) const;             ///< value of z
  double slope(double z) const;            ///< d(value)/dz
  double lower() const;                    ///< bounds of z; infinite where there are none
  double upper() const;                    ///< likewise
  double least() const { return least_; }  ///< bounds of the value
  double most() const { return most_; }
  bool is_logarithm() const { return is_logarithm_; }
  /// Whether changes of z count by themselves; those of a plain number count beside its size.
  bool is_relative() const { return is_logarithm_ || is_logit_; }

 private:
  ParameterTransform(bool is_logarithm, bool is_logit, double least, double most);
  double scaled(double value) const;

  bool is_logarithm_, is_logit_;
  double least_, most_;  ///< bounds of the value
  double low_, high_;    ///< the same of the value or its logarithm
};

}  // namespace resilin
