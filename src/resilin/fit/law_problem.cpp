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
  for (Eigen::Index i = 0; i < num_linear(); ++i) {
    limits(choice.linear[static_cast<std::size_t>(i)], linear_lower_[i], linear_upper_[i]);
    linear_lower_[i] += smallest_positive;  // a limit that is not to be reached is not
  }
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    const int place = choice.nonlinear[static_cast<std::size_t>(i)];
    const ConstantText& constant = choice.law->constants[static_cast<std::size_t>(place)];
    double lower = 0, upper = 0;
    limits(place, lower, upper);
    const bool is_logarithm = must_be_positive(constant);
    const double most = is_logarithm ? largest_positive : constant.unit.empty() ? largest_exponent : infinity;
    transforms_.push_back(ParameterTransform::in_box(
        is_logarithm, std::max(lower, is_logarithm ? smallest_positive : -most), std::min(upper, most)));
    double start = std::numeric_limits<double>::quiet_NaN();
    for (const ConstantSetting& setting : settings)
      if (is_about(setting, choice, place) && setting.start) start = *setting.start / unit_of(place);
    start_.push_back(start);
  }
}

std::vector<ParameterTransform> LawProblem::all_transforms() const {
  std::vector<ParameterTransform> all;
  for (Eigen::Index i = 0; i < num_linear(); ++i)
    all.push_back(ParameterTransform::in_box(false, linear_lower_[i], linear_upper_[i]));
  all.insert(all.end(), transforms_.begin(), transforms_.end());
  return all;
}

double LawProblem::unit_of(int place) const {
  return choice_.law->constants[static_cast<std::size_t>(place)].unit.empty() ? 1 : stress_scale_;
}

std::vector<double> LawProblem::scaled_constants(const VectorX& c, const VectorX& v) const {
  std::vector<double> constants = choice_.constants;
  for (std::size_t p = 0; p < constants.size(); ++p) constants[p] /= unit_of(static_cast<int>(p));
  for (Eigen::Index i = 0; i < num_linear(); ++i)
    constants[static_cast<std::size_t>(choice_.linear[static_cast<std::size_t>(i)])] = c[i];
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i)
    constants[static_cast<std::size_t>(choice_.nonlinear[static_cast<std::size_t>(i)])] = v[i];
  return constants;
}

std::vector<double> LawProblem::constants(const VectorX& c, const VectorX& v) const {
  std::vector<double> constants = scaled_constants(c, v);
  for (std::size_t p = 0; p < constants.size(); ++p) constants[p] *= unit_of(static_cast<int>(p));
  return constants;
}

void LawProblem::unknowns(const std::vector<double>& constants, VectorX& c, VectorX& v) const {
  const auto scaled = [&](int place) { return constants[static_cast<std::size_t>(place)] / unit_of(place); };
  c.resize(num_linear());
  v.resize(num_nonlinear());
  for (Eigen::Index i = 0; i < num_linear(); ++i) c[i] = scaled(choice_.linear[static_cast<std::size_t>(i)]);
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    const ParameterTransform& transform = transforms_[static_cast<std::size_t>(i)];
    const double value = scaled(choice_.nonlinear[static_cast<std::size_t>(i)]);
    v[i] = std::isnan(transform.to(value)) ? transform.to(value)
                                           : std::clamp(value, transform.least(), transform.most());
  }
}

bool LawProblem::linear_part(const VectorX& v, DenseMatrix& A, VectorX& y) const {
  VectorX rest;
  const std::vector<double> constants = scaled_constants(VectorX::Zero(num_linear()), v);
  if (!predicted_.evaluate(constants, choice_.linear, &rest, &A)) return false;
  A = weights_.asDiagonal() * A;
  y = weights_.cwiseProduct(measured_ - rest);
  return true;
}

bool LawProblem::nonlinear_slopes(const VectorX& c, const VectorX& v, DenseMatrix& B) const {
  if (!predicted_.evaluate(scaled_constants(c, v), choice_.nonlinear, nullptr, &B)) return false;
  B = weights_.asDiagonal() * B;
  return true;
}

bool LawProblem::residuals(const VectorX& c, const VectorX& v, VectorX* r, DenseMatrix* slopes) const {
  std::vector<int> places = choice_.linear;
  places.insert(places.end(), choice_.nonlinear.begin(), choice_.nonlinear.end());
  if (!predicted_.evaluate(scaled_constants(c, v), places, r, slopes)) return false;
  if (r != nullptr) *r = weights_.cwiseProduct(*r - measured_);
  if (slopes != nullptr) *slopes = weights_.asDiagonal() * *slopes;
  return true;
}

bool LawProblem::slopes_by_constants(const VectorX& c, const VectorX& v, DenseMatrix& slopes) const {
  const std::vector<int> fitted = choice_.fitted();
  if (!predicted_.evaluate(scaled_constants(c, v), fitted, nullptr, &slopes)) return false;
  slopes = weights_.asDiagonal() * slopes;
  return true;
}

std::vector<VectorX> LawProblem::starts() const {
  std::vector<VectorX> all = {VectorX(num_nonlinear())};
  const auto between = [](const ParameterTransform& transform, double part) {
    return transform.from(transform.lower() + part * (transform.upper() - transform.lower()));
  };
  for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
    const ParameterTransform& transform = transforms_[static_cast<std::size_t>(i)];
    std::vector<double> values;
    if (transform.is_logarithm()) {
      const double first = std::log(first_positive_start), last = std::log(last_positive_start);
      for (int k = 0; k < num_positive_starts; ++k)
        values.push_back(std::exp(first + (last - first) * k / (num_positive_starts - 1)));
    } else {
      values.assign(exponent_starts.begin(), exponent_starts.end());
    }
    std::erase_if(values,
                  [&](double value) { return !(value >= transform.least() && value <= transform.most()); });
    if (values.empty())
      for (const double part : {0.1, 0.5, 0.9}) values.push_back(between(transform, part));
    std::vector<VectorX> next;
    for (const VectorX& start : all)
      for (const double value : values) {
        // Terms are exchangeable: each set of exponents once.
        const bool is_next_exponent = i > 0 && !transform.is_logarithm() &&
                                      !transforms_[static_cast<std::size_t>(i - 1)].is_logarithm();
        if (is_next_exponent && values.size() > 3 && value <= start[i - 1]) continue;
        next.push_back(start);
        next.back()[i] = value;
      }
    all = std::move(next);
  }
  VectorX given = Eigen::Map<const VectorX>(start_.data(), num_nonlinear());
  if (num_nonlinear() > 0 && !given.array().isNaN().all()) {
    for (Eigen::Index i = 0; i < num_nonlinear(); ++i) {
      const ParameterTransform& transform = transforms_[static_cast<std::size_t>(i)];
      if (std::isnan(given[i])) given[i] = all.empty() ? between(transform, 0.5) : all[all.size() / 2][i];
      given[i] = std::clamp(given[i], transform.least(), transform.most());
    }
    all.insert(all.begin(), given);
  }
  return all;
}

}  // namespace resilin
