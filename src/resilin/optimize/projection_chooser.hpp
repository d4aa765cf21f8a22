#pragma once

#include <algorithm>

#include "resilin/core/projection.hpp"

namespace resilin {

/// How indefinite elements are treated. Sources: Teran et al. 2005 (clamp), Chen et al. 2024, arXiv
/// 2406.05928 (absolute), arXiv 2410.10102 (switch by the trust-region ratio), Fernandez-Fernandez et al.
/// 2025, arXiv 2505.21013 (project only where needed).
enum class ProjectionPolicy {
  none,        ///< never project; fails on an indefinite matrix
  clamp,       ///< always
  absolute,    ///< always
  on_failure,  ///< exact first; after an indefinite matrix, project for some iterations. For motion
  adaptive,    ///< exact, clamp or absolute by how well the last step was predicted. For statics
};

/// Chooses the Hessian of the next Newton iteration by the previous ones (docs/theory/newton.md).
class ProjectionChooser {
 public:
  explicit ProjectionChooser(ProjectionPolicy policy) : policy_(policy) {}

  Projection first_choice() const {
    switch (policy_) {
      case ProjectionPolicy::none:
        return Projection::none;
      case ProjectionPolicy::clamp:
        return Projection::clamp;
      case ProjectionPolicy::absolute:
        return Projection::absolute;
      case ProjectionPolicy::on_failure:
        return cool_down_ > 0 ? Projection::clamp : Projection::none;
      case ProjectionPolicy::adaptive:
        break;
    }
    return adaptive_;
  }

  /// Projection to try after `failed` gave no direction; the same projection when there is nothing more to
  /// try.
  Projection next_choice(Projection failed) const {
    if (policy_ == ProjectionPolicy::none) return Projection::none;
    if (policy_ == ProjectionPolicy::clamp) return Projection::clamp;
    if (failed == Projection::none) return Projection::clamp;
    return Projection::absolute;
  }

  void matrix_was_indefinite() {
    cool_down_ = projected_iterations_after_failure;
    if (adaptive_ == Projection::none) adaptive_ = Projection::clamp;
  }

  /// `ratio` is the actual over the predicted decrease of the accepted step of length `step`.
  void step_was_taken(double ratio, double step) {
    cool_down_ = std::max(cool_down_ - 1, 0);
    const bool model_was_good = ratio >= 0.75 && step >= 1;
    const bool model_was_bad = ratio < 0.25 || step < 0.25;
    if (model_was_good) {
      adaptive_ = Projection::none;
    } else if (model_was_bad && adaptive_ != Projection::none) {
      adaptive_ = Projection::absolute;
    } else {
      adaptive_ = Projection::clamp;
    }
  }

 private:
  static constexpr int projected_iterations_after_failure = 4;

  ProjectionPolicy policy_;
  Projection adaptive_ = Projection::none;
  int cool_down_ = 0;
};

}  // namespace resilin
