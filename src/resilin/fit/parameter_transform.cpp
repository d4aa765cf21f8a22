#include "resilin/fit/parameter_transform.hpp"

#include <cmath>
#include <limits>

namespace resilin {

ParameterTransform::ParameterTransform(bool is_logarithm, bool is_logit, double least, double most)
    : is_logarithm_(is_logarithm),
      is_logit_(is_logit),
      least_(least),
      most_(most),
      low_(scaled(least)),
      high_(scaled(most)) {}

ParameterTransform ParameterTransform::in_box(bool is_logarithm, double lower, double upper) {
  return {is_logarithm, false, lower, upper};
}

ParameterTransform ParameterTransform::within(bool is_logarithm, double lower, double upper) {
  ParameterTransform transform(is_logarithm, false, lower, upper);
  transform.is_logit_ = std::isfinite(transform.low_) && std::isfinite(transform.high_);
  return transform;
}

double ParameterTransform::scaled(double value) const { return is_logarithm_ ? std::log(value) : value; }

double ParameterTransform::to(double value) const {
  const double w = scaled(value);
  return is_logit_ ? std::log((w - low_) / (high_ - w)) : w;
}

double ParameterTransform::from(double z) const {
  if (!is_logit_ && z <= low_) return least_;  // to the last bit
  if (!is_logit_ && z >= high_) return most_;
  const double w = is_logit_ ? low_ + (high_ - low_) / (1 + std::exp(-z)) : z;
  return is_logarithm_ ? std::exp(w) : w;
}

double ParameterTransform::slope(double z) const {
  const double share = 1 / (1 + std::exp(-z));
  return (is_logit_ ? (high_ - low_) * share * (1 - share) : 1) * (is_logarithm_ ? from(z) : 1);
}

double ParameterTransform::lower() const {
  return is_logit_ ? -std::numeric_limits<double>::infinity() : low_;
}

double ParameterTransform::upper() const {
  return is_logit_ ? std::numeric_limits<double>::infinity() : high_;
}

}  // namespace resilin
