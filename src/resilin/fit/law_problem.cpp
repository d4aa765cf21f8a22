#include "resilin/fit/law_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace resilin {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Beyond these a constant has no influence that can be told from none.
constexpr double smallest_positive = 1e-9, largest_positive = 1e9, largest_exponent = 60;
// Exponents of rubber lie between; those of opposite sign belong to tension and compression.
constexpr std::array exponent_starts = {-8.0, -5.0, -3.0, -2.0, -1.0, -0.4, 0.6,
                                        1.2,  2.0,  3.0,  4.5,  6.5,  9.0,  13.0};
constexpr int num_positive_starts = 40;
constexpr double first_positive_start = 0.03, last_positive_start = 1e5;

bool must_be_positive(const ConstantText& constant) { return constant.above == 0 || constant.at_least == 0; }

}  // namespace

LawProblem::LawProblem(const LawChoice& choice, const PredictedValues& predicted, const VectorX& measured,
                       const VectorX& weights, double stress_scale,
                       const std::vector<ConstantSetting>& settings)
    : choice_(choice),
      predicted_(predicted),
      measured_(measured / stress_scale),
      weights_(weights),
      stress_scale_(stress_scale) {
  const auto limits = [&](int place, double& lower, double& upper) {
    const ConstantText& constant = choice.law->constants[static_cast<std::size_t>(place)];
    lower = std::max(constant.above, constant.at_least);
    upper = constant.at_most;
    for (const ConstantSetting& setting : settings)
      if (is_about(setting, choice, place)) {
        lower = std::max(lower, setting.lower / unit_of(place));
        upper = std::min(upper, setting.upper / unit_of(place));
      }
  };
  linear_lower_.resize(num_linear());
  linear_upper_.resize(num_linear());
  lower_.resize(num_nonlinear());
  upper_.resize(num_nonlinear());
  for (Eigen::Index i = 0; i < num_linear(); ++i) {
    limits(choice.linear[static_cast<std::size_t>(i)], linear_lower_[i], linear_upper_[i]);
    linear_lower_[i] += smallest_positive;  // a limit that is not to be reached is not
  }
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    const int place = choice.nonlinear[static_cast<std::size_t>(i)];
    const ConstantText& constant = choice.law->constants[static_cast<std::size_t>(place)];
    double lower = 0, upper = 0;
    limits(place, lower, upper);
    is_logarithm_.push_back(must_be_positive(constant));
    const double most = constant.unit.empty() ? largest_exponent : infinity;
    lower_[i] = is_logarithm_.back() ? std::log(std::max(lower, smallest_positive)) : std::max(lower, -most);
    upper_[i] = is_logarithm_.back() ? std::log(std::min(upper, largest_positive)) : std::min(upper, most);
    double start = std::numeric_limits<double>::quiet_NaN();
    for (const ConstantSetting& setting : settings)
      if (is_about(setting, choice, place) && setting.start) start = *setting.start / unit_of(place);
    start_.push_back(is_logarithm_.back() ? std::log(start) : start);
  }
}

double LawProblem::unit_of(int place) const {
  return choice_.law->constants[static_cast<std::size_t>(place)].unit.empty() ? 1 : stress_scale_;
}

std::vector<double> LawProblem::scaled_constants(const VectorX& c, const VectorX& z) const {
  std::vector<double> constants = choice_.constants;
  for (std::size_t p = 0; p < constants.size(); ++p) constants[p] /= unit_of(static_cast<int>(p));
  for (Eigen::Index i = 0; i < num_linear(); ++i)
    constants[static_cast<std::size_t>(choice_.linear[static_cast<std::size_t>(i)])] = c[i];
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i)
    constants[static_cast<std::size_t>(choice_.nonlinear[static_cast<std::size_t>(i)])] =
        is_logarithm(i) ? std::exp(z[i]) : z[i];
  return constants;
}

std::vector<double> LawProblem::constants(const VectorX& c, const VectorX& z) const {
  std::vector<double> constants = scaled_constants(c, z);
  for (std::size_t p = 0; p < constants.size(); ++p) constants[p] *= unit_of(static_cast<int>(p));
  return constants;
}

void LawProblem::unknowns(const std::vector<double>& constants, VectorX& c, VectorX& z) const {
  const auto scaled = [&](int place) { return constants[static_cast<std::size_t>(place)] / unit_of(place); };
  c.resize(num_linear());
  z.resize(num_nonlinear());
  for (Eigen::Index i = 0; i < num_linear(); ++i) c[i] = scaled(choice_.linear[static_cast<std::size_t>(i)]);
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    const double value = scaled(choice_.nonlinear[static_cast<std::size_t>(i)]);
    z[i] = std::clamp(is_logarithm(i) ? std::log(value) : value, lower_[i], upper_[i]);
  }
}

double LawProblem::slope_of_transform(Eigen::Index i, const VectorX& z) const {
  return is_logarithm(i) ? std::exp(z[i]) : 1;
}

bool LawProblem::linear_part(const VectorX& z, DenseMatrix& A, VectorX& y) const {
  VectorX rest;
  const std::vector<double> constants = scaled_constants(VectorX::Zero(num_linear()), z);
  if (!predicted_.evaluate(constants, choice_.linear, &rest, &A)) return false;
  A = weights_.asDiagonal() * A;
  y = weights_.cwiseProduct(measured_ - rest);
  return true;
}

bool LawProblem::nonlinear_slopes(const VectorX& c, const VectorX& z, DenseMatrix& B) const {
  if (!predicted_.evaluate(scaled_constants(c, z), choice_.nonlinear, nullptr, &B)) return false;
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i)
    B.col(i) = slope_of_transform(i, z) * weights_.cwiseProduct(B.col(i));
  return true;
}

bool LawProblem::residuals(const VectorX& c, const VectorX& z, VectorX& r, DenseMatrix* slopes) const {
  std::vector<int> places = choice_.linear;
  places.insert(places.end(), choice_.nonlinear.begin(), choice_.nonlinear.end());
  if (!predicted_.evaluate(scaled_constants(c, z), places, &r, slopes)) return false;
  r = weights_.cwiseProduct(r - measured_);
  if (slopes == nullptr) return true;
  for (Eigen::Index i = 0; i < num_linear() + num_nonlinear(); ++i) {
    const double factor = i < num_linear() ? 1 : slope_of_transform(i - num_linear(), z);
    slopes->col(i) = factor * weights_.cwiseProduct(slopes->col(i));
  }
  return true;
}

bool LawProblem::slopes_by_constants(const VectorX& c, const VectorX& z, DenseMatrix& slopes) const {
  const std::vector<int> fitted = choice_.fitted();
  if (!predicted_.evaluate(scaled_constants(c, z), fitted, nullptr, &slopes)) return false;
  slopes = weights_.asDiagonal() * slopes;
  return true;
}

std::vector<VectorX> LawProblem::starts() const {
  std::vector<VectorX> all = {VectorX(num_nonlinear())};
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    std::vector<double> values;
    if (is_logarithm(i)) {
      const double first = std::log(first_positive_start), last = std::log(last_positive_start);
      for (int k = 0; k < num_positive_starts; ++k)
        values.push_back(first + (last - first) * k / (num_positive_starts - 1));
    } else {
      values.assign(exponent_starts.begin(), exponent_starts.end());
    }
    std::erase_if(values, [&](double value) { return !(value >= lower_[i] && value <= upper_[i]); });
    if (values.empty())
      for (const double part : {0.1, 0.5, 0.9}) values.push_back(lower_[i] + part * (upper_[i] - lower_[i]));
    std::vector<VectorX> next;
    for (const VectorX& start : all)
      for (const double value : values) {
        // Terms are exchangeable: each set of exponents once.
        if (i > 0 && !is_logarithm(i) && !is_logarithm(i - 1) && values.size() > 3 && value <= start[i - 1])
          continue;
        next.push_back(start);
        next.back()[i] = value;
      }
    all = std::move(next);
  }
  VectorX given = Eigen::Map<const VectorX>(start_.data(), num_nonlinear());
  if (num_nonlinear() > 0 && !given.array().isNaN().all()) {
    for (Eigen::Index i = 0; i < num_nonlinear(); ++i)
      if (std::isnan(given[i]))
        given[i] = all.empty() ? 0.5 * (lower_[i] + upper_[i]) : all[all.size() / 2][i];
    all.insert(all.begin(), given.cwiseMax(lower_).cwiseMin(upper_));
  }
  return all;
}

}  // namespace resilin
