#include "resilin/fit/least_squares_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/fit/inequalities.hpp"

namespace resilin {
namespace {

constexpr double least_damping = 1e-12, most_damping = 1e12;
constexpr double least_factor = 0.1;   ///< least factor of the damping after a step that was better
constexpr double unseen_gain = 1e-24;  ///< part of the sum that steps lost in round-off promise
constexpr double round_off = 1e-15;    ///< a smaller part of what is minimised is none

/// How much lower |r + J change|^2 is than |r|^2, without cancellation.
double decrease(const VectorX& r, const DenseMatrix& J, const VectorX& change) {
  const VectorX moved = J * change;
  return -(2 * r + moved).dot(moved);
}

}  // namespace

LeastSquaresSearch::LeastSquaresSearch(Residuals& residuals, std::vector<ParameterTransform> transforms,
                                       SearchSettings settings, const InequalityConstraints* constraints,
                                       Prior* prior)
    : residuals_(residuals),
      transforms_(std::move(transforms)),
      settings_(std::move(settings)),
      constraints_(constraints),
      prior_(prior) {}

bool LeastSquaresSearch::run(const VectorX& z) {
  start_ = z_ = z;
  scale_ = VectorX::Zero(z.size());
  damping_ = settings_.first_damping;
  growth_ = 2;
  price_ = 0;
  evaluations_ = 0;
  if (!residuals_.evaluate(values(), r_) || !r_.allFinite()) return false;
  evaluations_ = 1;
  residuals_.accept();
  tell(z_, r_, true);
  ending_ = z.size() > 0 ? SearchEnding::no_better_step : SearchEnding::converged;
  while (z.size() > 0 && linearise() && step()) {
  }
  return true;
}

VectorX LeastSquaresSearch::values_at(const VectorX& z) const {
  VectorX values(z.size());
  for (Eigen::Index i = 0; i < z.size(); ++i) values[i] = transform(i).from(z[i]);
  return values;
}

VectorX LeastSquaresSearch::z_of(const VectorX& values) const {
  VectorX z(values.size());
  for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = transform(i).to(values[i]);
  return z;
}

bool LeastSquaresSearch::is_held(Eigen::Index i) const {
  const double slope = slopes_.col(i).dot(r_);
  return (z_[i] <= transform(i).lower() && slope > 0) || (z_[i] >= transform(i).upper() && slope < 0);
}

VectorX LeastSquaresSearch::within_bounds(VectorX z) const {
  for (Eigen::Index i = 0; i < z.size(); ++i)
    z[i] = std::clamp(z[i], transform(i).lower(), transform(i).upper());
  return z;
}

double LeastSquaresSearch::merit(const VectorX& z, const VectorX& r) const {
  double merit = r.squaredNorm();
  if (prior_ != nullptr) merit += prior_->value(z);
  if (constraints_ != nullptr) merit += 2 * price_ * constraints_->violation(values_at(z));
  return merit;
}

double LeastSquaresSearch::relative_size(const VectorX& change) const {
  double size = 0;
  for (Eigen::Index i = 0; i < z_.size(); ++i) {
    const double unit = transform(i).is_relative() ? 1 : std::max(std::abs(z_[i]), std::abs(start_[i]));
    if (change[i] != 0) size = std::max(size, unit > 0 ? std::abs(change[i]) / unit : 1);
  }
  return size;
}

/// The part of a change that is not too long.
double LeastSquaresSearch::cut_to_longest(const VectorX& change) const {
  double longest = 0;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    if (transform(i).is_relative()) longest = std::max(longest, std::abs(change[i]));
  return longest > settings_.longest_step ? settings_.longest_step / longest : 1;
}

bool LeastSquaresSearch::linearise() {
  if (!residuals_.linearise(slopes_) || !slopes_.allFinite()) return false;
  VectorX slopes(z_.size());
  for (Eigen::Index i = 0; i < z_.size(); ++i) slopes[i] = transform(i).slope(z_[i]);
  slopes_ = slopes_ * slopes.asDiagonal();
  if (prior_ != nullptr) {
    best_ = prior_->best_step(z_, r_, slopes_);
    return true;
  }
  scale_ = scale_.cwiseMax(VectorX(slopes_.colwise().norm()));
  if (constraints_ == nullptr) return true;
  if (!constraints_->linearise(values(), g_, g_slopes_)) return false;
  g_slopes_ = g_slopes_ * slopes.asDiagonal();
  return true;
}

/// The least |r + J change|^2 + damping |D change|^2 with the inequalities, in units of D, the largest
/// lengths of the columns so far.
bool LeastSquaresSearch::damped_step(SearchStep& step, VectorX& next) {
  const Eigen::Index n = z_.size(), m = r_.size(), k = g_.size();
  if (prior_ != nullptr) {
    const double share = std::min(1 / (1 + damping_), cut_to_longest(best_.change));
    step = {share * best_.change, share * (2 - share) * best_.gain};
    next = z_ + step.change;
    return step.change.allFinite();
  }
  const VectorX unit = scale_.unaryExpr([](double size) { return size > 0 ? 1 / size : 1; });
  DenseMatrix A = DenseMatrix::Zero(m + n, n), G = DenseMatrix::Zero(k + 2 * n, n);
  A.topRows(m) = slopes_ * unit.asDiagonal();
  A.bottomRows(n).diagonal().setConstant(std::sqrt(damping_));
  VectorX b = VectorX::Zero(m + n), h = VectorX::Zero(k + 2 * n);
  b.head(m) = -r_;
  if (k > 0) G.topRows(k) = g_slopes_ * unit.asDiagonal();
  h.head(k) = -g_;
  std::vector<std::pair<Eigen::Index, double>> bounds;
  for (Eigen::Index i = 0; i < n; ++i)
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0 ? transform(i).lower() : transform(i).upper();
      if (!std::isfinite(bound)) continue;
      const Eigen::Index row = k + static_cast<Eigen::Index>(bounds.size());
      G(row, i) = sign * unit[i];
      h[row] = sign * (bound - z_[i]);
      bounds.emplace_back(i, bound);
    }
  const Eigen::Index rows = k + static_cast<Eigen::Index>(bounds.size());
  BoundedStep found;
  if (!least_squares_with_inequalities(A, b, G.topRows(rows), h.head(rows), found)) return false;
  if (k > 0) price_ = std::max(price_, 2 * found.multipliers.head(k).maxCoeff());
  step.change = unit.cwiseProduct(found.x);
  const double share = cut_to_longest(step.change);
  next = within_bounds(z_ + share * step.change);
  if (share == 1)  // to the last bit
    for (Eigen::Index row = k; row < rows; ++row)
      if (const auto& [i, bound] = bounds[static_cast<std::size_t>(row - k)]; found.multipliers[row] > 0)
        next[i] = bound;
  step.change = next - z_;
  step.gain = decrease(r_, slopes_, step.change);
  if (k > 0) step.gain += 2 * price_ * constraints_->violation(values());
  return step.change.allFinite();
}

bool LeastSquaresSearch::evaluate(const VectorX& z, VectorX& r) {
  ++evaluations_;
  try {
    return residuals_.evaluate(values_at(z), r) && r.allFinite();
  } catch (const InputError& error) {  // a shorter step may have some
    problem_ = error.what();
    return false;
  }
}

void LeastSquaresSearch::tell(const VectorX& z, const VectorX& r, bool is_better) const {
  if (!settings_.on_trial) return;
  const bool has_residuals = r.size() > 0;
  const double sum = has_residuals ? r.squaredNorm() : std::numeric_limits<double>::infinity();
  settings_.on_trial({evaluations_, z, sum, is_better, has_residuals ? "" : problem_});
}

/// Goes on to a better place; false at the end of the search.
bool LeastSquaresSearch::step() {
  problem_.clear();
  const double sum = r_.squaredNorm(),
               negligible = std::max(settings_.negligible_gain ? settings_.negligible_gain(sum) : 0,
                                     unseen_gain * sum);
  SearchStep step;
  VectorX next, tried;
  for (; damping_ < most_damping;
       damping_ = std::max(settings_.damping_after_failure, growth_ * damping_), growth_ *= 2) {
    if (!damped_step(step, next)) continue;
    if (step.gain <= negligible || relative_size(step.change) <= settings_.tolerance) {
      // A step that much damping has made small says nothing about how near the end is.
      if (step.gain <= negligible || damping_ <= settings_.damping_after_failure)
        ending_ = SearchEnding::converged;
      return false;
    }
    if (tried.size() > 0 && tried == step.change) continue;  // bounds cut it to the same step
    tried = step.change;
    if (evaluations_ >= settings_.most_evaluations) {
      ending_ = SearchEnding::too_many_evaluations;
      return false;
    }
    const double now = merit(z_, r_);
    VectorX r;
    if (!evaluate(next, r)) {
      tell(next, {}, false);
      continue;
    }
    const double there = merit(next, r);
    tell(next, r, there < now);
    if (!(there < now)) continue;
    residuals_.accept();
    z_ = next;
    r_ = r;
    const double ratio = (now - there) / step.gain;
    damping_ = std::max(least_damping, damping_ * std::max(least_factor, 1 - std::pow(2 * ratio - 1, 3)));
    growth_ = 2;
    if (now - there > round_off * now) return true;
    ending_ = SearchEnding::converged;
    return false;
  }
  return false;
}

}  // namespace resilin
