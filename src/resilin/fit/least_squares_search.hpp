#pragma once

#include <functional>
#include <string>
#include <vector>

#include "resilin/fit/parameter_transform.hpp"
#include "resilin/fit/predicted_values.hpp"

namespace resilin {

/// Residuals r of a model as a function of the values that are sought: what a fit has to state.
class Residuals {
 public:
  virtual ~Residuals() = default;
  /// r at these values; false, or InputError, where the model has none.
  virtual bool evaluate(const VectorX& values, VectorX& r) = 0;
  /// The search goes on from the values that were evaluated last.
  virtual void accept() {}
  /// dr/d(values) at the values that were accepted last; false where there is none.
  virtual bool linearise(DenseMatrix& slopes) = 0;
};

/// Conditions g(values) >= 0 beside the bounds.
class InequalityConstraints {
 public:
  virtual ~InequalityConstraints() = default;
  /// The sum of all -g > 0.
  virtual double violation(const VectorX& values) const = 0;
  /// g and dg/d(values); false where the model has no state.
  virtual bool linearise(const VectorX& values, VectorX& g, DenseMatrix& slopes) const = 0;
};

/// A change of z, and by how much it lowers what is minimised if the linear problem is right.
struct SearchStep {
  VectorX change;
  double gain = 0;
};

/// A quadratic term in z beside the sum of squares. Its weight may be chosen anew for each linear problem.
class Prior {
 public:
  virtual ~Prior() = default;
  virtual double value(const VectorX& z) const = 0;
  /// The step to the least |r + J change|^2 + value(z + change).
  virtual SearchStep best_step(const VectorX& z, const VectorX& r, const DenseMatrix& J) = 0;
};

/// One evaluation of the residuals.
struct SearchTrial {
  int number;  ///< from 1
  VectorX z;
  double sum_of_squares;  ///< infinite where there are no residuals
  bool is_better;         ///< the search goes on from there
  std::string problem;    ///< why there are no residuals
};

struct SearchSettings {
  double first_damping = 1e-6;              ///< suits residuals that are nearly linear: Gauss-Newton
  double damping_after_failure = 1e-3;      ///< at least so much after a step that was not better
  double longest_step = 2.302585092994046;  ///< longest change of logarithms and logits: a factor of 10
  double tolerance = 0;                     ///< a shorter step, relative to the numbers, ends the search
  int most_evaluations = 1000;
  /// Gain that does not count, by the sum of squares; none: a gain of 0.
  std::function<double(double)> negligible_gain{};
  std::function<void(const SearchTrial&)> on_trial{};
};

/// Why a search has ended.
enum class SearchEnding { converged, no_better_step, too_many_evaluations };

/// Levenberg and Marquardt's search for the least
///
///   |r(values(z))|^2 + prior(z),   lower <= z <= upper,   g(values(z)) >= 0
///
/// Each step solves the damped linear problem with its inequalities exactly (Lawson & Hanson 1974, ch. 23).
/// Conditions g that are violated enter with a price above their multipliers. The damping follows Nielsen
/// (1999). With a prior, which has no inequalities, the metric of the damping is the Hessian itself: the
/// damped step is the best step over 1 + damping.
class LeastSquaresSearch {
 public:
  /// @param residuals, constraints, prior  kept by reference; the latter two may be null, one has to
  LeastSquaresSearch(Residuals& residuals, std::vector<ParameterTransform> transforms,
                     SearchSettings settings, const InequalityConstraints* constraints = nullptr,
                     Prior* prior = nullptr);

  /// From these z. False where there are no residuals; throws what these throw there.
  bool run(const VectorX& z);

  const VectorX& z() const { return z_; }
  VectorX values() const { return values_at(z_); }
  VectorX values_at(const VectorX& z) const;
  VectorX z_of(const VectorX& values) const;
  const std::vector<ParameterTransform>& transforms() const { return transforms_; }
  const VectorX& residuals() const { return r_; }
  double sum_of_squares() const { return r_.squaredNorm(); }
  const DenseMatrix& slopes() const { return slopes_; }  ///< dr/dz
  /// Held by a bound against which the sum of squares falls.
  bool is_held(Eigen::Index i) const;
  int evaluations() const { return evaluations_; }
  SearchEnding ending() const { return ending_; }
  bool is_converged() const { return ending_ == SearchEnding::converged; }
  const std::string& problem() const { return problem_; }  ///< why there were no residuals, last

 private:
  const ParameterTransform& transform(Eigen::Index i) const {
    return transforms_[static_cast<std::size_t>(i)];
  }
  VectorX within_bounds(VectorX z) const;
  double merit(const VectorX& z, const VectorX& r) const;
  double relative_size(const VectorX& change) const;
  double cut_to_longest(const VectorX& change) const;
  bool linearise();
  bool damped_step(SearchStep& step, VectorX& next);
  bool evaluate(const VectorX& z, VectorX& r);
  void tell(const VectorX& z, const VectorX& r, bool is_better) const;
  bool step();

  Residuals& residuals_;
  std::vector<ParameterTransform> transforms_;
  SearchSettings settings_;
  const InequalityConstraints* constraints_;
  Prior* prior_;
  VectorX start_, z_, r_, scale_;
  DenseMatrix slopes_;
  VectorX g_;             ///< conditions at z
  DenseMatrix g_slopes_;  ///< dg/dz
  SearchStep best_;       ///< with the prior, without damping
  double damping_ = 0, growth_ = 2, price_ = 0;
  int evaluations_ = 0;
  SearchEnding ending_ = SearchEnding::converged;
  std::string problem_;
};

}  // namespace resilin
