#include "resilin/optimize/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double surely_small = 1e-6;  ///< relative to the load: rounding is then looked at
}  // namespace

void Convergence::measure(const VectorX& x, const VectorX& gradient) {
  rounding_.resize(0);
  x_ = &x;
  gradient_ = &gradient;
  residuals_ = parts_->norms(gradient, is_fixed_, Unknowns::free);
  scales_ = objective_->force_scales(x, gradient, *parts_).cwiseMax(least_scale_);
  if (first_residuals_.size() == 0) first_residuals_ = residuals_;
  // A part on which nothing acts is measured by what was out of balance at first.
  VectorX measures = scales_;
  for (Index part = 0; part < parts_->count(); ++part)
    if (measures[part] == 0) measures[part] = first_residuals_[part];
  weighted_scale_ = measures.maxCoeff();
  weights_ = VectorX::Ones(parts_->count());
  if (parts_->count() > 1)
    for (Index part = 0; part < parts_->count(); ++part)
      if (measures[part] > 0) weights_[part] = weighted_scale_ / measures[part];
  weighted_residual_ = residuals_.cwiseProduct(weights_).norm();
  find_worst();
}

void Convergence::find_worst() {
  const auto share = [this](Index part) {
    if (residuals_[part] == 0) return 0.0;
    const double ratio = residuals_[part] / scales_[part];
    return std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio;
  };
  worst_ = 0;
  for (Index part = 1; part < parts_->count(); ++part)
    if (share(part) > share(worst_)) worst_ = part;
}

double Convergence::weighted_norm(const VectorX& gradient) const {
  return parts_->norms(gradient, is_fixed_, Unknowns::free).cwiseProduct(weights_).norm();
}

VectorX Convergence::weights_of(const ConnectedComponents& coarse) const {
  if (coarse.count() == parts_->count()) return weights_;
  VectorX weights = VectorX::Constant(coarse.count(), std::numeric_limits<double>::infinity());
  for (Index node = 0; node < parts_->num_nodes(); ++node) {
    double& weight = weights[coarse.of_node(node)];
    weight = std::min(weight, weights_[parts_->of_node(node)]);
  }
  // A part without a node here is one of other processes.
  return weights.unaryExpr([](double weight) { return std::isfinite(weight) ? weight : 1; });
}

Index Convergence::worst_unknown() const {
  const Eigen::Index dim = gradient_->size() / parts_->num_nodes();
  constexpr std::size_t numbers_per_chunk = 1 << 14;
  struct Worst {  // the first that is none, else the first of the largest
    Index unknown = -1;
    double size = -1;
    void operator+=(const Worst& other) {
      if (!std::isnan(size) && (other.size > size || std::isnan(other.size))) *this = other;
    }
  };
  const auto [worst, largest] =
      parallel_sum<Worst>(static_cast<std::size_t>(gradient_->size()), numbers_per_chunk,
                          [&](std::size_t begin, std::size_t end) {
                            Worst part;
                            for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end); ++i)
                              if (is_fixed_[static_cast<std::size_t>(i)] == 0 &&
                                  parts_->of_node(static_cast<Index>(i / dim)) == worst_)
                                part += {i, std::abs((*gradient_)[i])};
                            return part;
                          });
  const ProcessGroup& share = parts_->share();
  if (share.is_whole()) return worst;
  // One process knows it: nan is the largest, and the first process goes before others.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double size = std::isnan(largest) ? infinity : largest;
  const bool has_largest = worst >= 0 && size == share.largest(size);
  const double rank = share.exchange().rank();
  return share.smallest(has_largest ? rank : infinity) == rank ? worst : -1;
}

void Convergence::look_at_rounding(const VectorX& diagonal) {
  objective_->gradient_magnitude(*x_, rounding_);
  const Eigen::Index dim = x_->size() / parts_->num_nodes();
  if (diagonal.size() == x_->size()) {
    const VectorX reach = parts_->largest(*x_);
    for (Eigen::Index i = 0; i < rounding_.size(); ++i)
      rounding_[i] += diagonal[i] * reach[parts_->of_node(static_cast<Index>(i / dim))];
  }
  rounding_ *= 10 * epsilon;
}

Convergence::Verdict Convergence::verdict(const VectorX& diagonal, bool look_closer) {
  if (!is_finite()) return Verdict::not_finite;
  std::vector<Index> doubtful;
  for (Index part = 0; part < parts_->count(); ++part)
    if (!(residuals_[part] <= tolerance_ * scales_[part])) doubtful.push_back(part);
  if (doubtful.empty()) return Verdict::yes;

  // Round-off is asked for only when it can matter: it costs one evaluation.
  const bool knows_diagonal = diagonal.size() == x_->size();
  const VectorX reach = parts_->largest(*x_);
  const VectorX stiffness = knows_diagonal ? parts_->norms(diagonal, is_fixed_, Unknowns::free) : VectorX();
  for (const Index part : doubtful) {
    const double small = surely_small * std::max(scales_[part], first_residuals_[part]);
    const double of_positions = knows_diagonal ? 1e3 * epsilon * stiffness[part] * reach[part] : 0;
    if (!look_closer && !(residuals_[part] <= std::max(small, of_positions))) return Verdict::no;
  }
  look_at_rounding(diagonal);
  const VectorX roundings = parts_->norms(rounding_, is_fixed_, Unknowns::free);
  const VectorX excess = (gradient_->cwiseAbs() - rounding_).cwiseMax(0.0);
  const VectorX beyond_rounding = parts_->norms(excess, is_fixed_, Unknowns::free);
  for (const Index part : doubtful)
    if (!(beyond_rounding[part] <= tolerance_ * scales_[part])) return Verdict::no;
  const VectorX acting = objective_->distinct_acting_scales(*x_, roundings, *parts_);
  for (const Index part : doubtful)
    if (acting[part] > 0 && !(residuals_[part] <= largest_rounding * acting[part]))
      return Verdict::out_of_digits;
  for (const Index part : doubtful) residuals_[part] = beyond_rounding[part];
  find_worst();
  return Verdict::yes;
}

}  // namespace resilin
