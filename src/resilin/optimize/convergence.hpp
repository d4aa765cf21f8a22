#pragma once

#include <cstdint>
#include <span>

#include "resilin/optimize/connected_components.hpp"
#include "resilin/optimize/objective.hpp"

namespace resilin {

/// Relative to the load: a larger residual is no balance, rounding or not.
constexpr double largest_rounding = 1e-4;

/// Judges whether forces balance, part by part: each in the forces that act on it and in its own round-off,
/// so that the verdict on one does not depend on what else is in the scene, or touches it.
/// docs/theory/stopping.md.
class Convergence {
 public:
  enum class Verdict {
    no,
    yes,
    out_of_digits,  ///< nothing but rounding is left of a part's residual, which is not small beside its load
    not_finite,
  };

  /// @param tolerance    of each part's residual, relative to its force scale
  /// @param least_scale  the force scale of a part on which less acts [N]
  Convergence(const Objective& objective, std::span<const std::uint8_t> is_fixed,
              const ConnectedComponents& parts, double tolerance, double least_scale = 0)
      : objective_(&objective),
        is_fixed_(is_fixed),
        parts_(&parts),
        tolerance_(tolerance),
        least_scale_(least_scale) {}

  /// Takes the forces at x, of which the other functions then speak.
  /// @param gradient  kept by reference until the next call
  void measure(const VectorX& x, const VectorX& gradient);

  /// @param diagonal  |diagonal of the Hessian| [N/m], by which the rounding of positions becomes forces;
  /// empty
  ///                  as long as it is unknown
  /// @param look_closer  at rounding, even where it is not expected to matter
  Verdict verdict(const VectorX& diagonal, bool look_closer = false);
  /// Bound of the rounding of each force, where `verdict` or `look_at_rounding` looked at it; else empty [N].
  const VectorX& rounding() const { return rounding_; }
  /// @param diagonal  as above
  void look_at_rounding(const VectorX& diagonal);
  bool is_finite() const { return residuals_.allFinite() && scales_.allFinite(); }

  /// Largest residual of a part relative to the forces that act there [N]. For a part of which
  /// only rounding is left, `verdict` leaves here what exceeds it: zero.
  double residual() const { return residuals_[worst_]; }
  double force_scale() const { return scales_[worst_]; }
  /// The free unknown of that part with the largest residual; -1: none, or one of another process.
  Index worst_unknown() const;

  /// The residual of all parts in a measure in which all count alike, and the force scale in it [N]. With one
  /// part these are the residual and the scale.
  double weighted_residual() const { return weighted_residual_; }
  double weighted_norm(const VectorX& gradient) const;
  double weighted_scale() const { return weighted_scale_; }
  /// The weights of a coarser division, `coarse`, for a system that couples some of these parts: what they
  /// are a part of counts by the one on which most acts.
  VectorX weights_of(const ConnectedComponents& coarse) const;

 private:
  void find_worst();

  const Objective* objective_;
  std::span<const std::uint8_t> is_fixed_;
  const ConnectedComponents* parts_;
  double tolerance_, least_scale_;

  const VectorX* x_ = nullptr;
  const VectorX* gradient_ = nullptr;
  VectorX residuals_, scales_, weights_;  ///< by part
  VectorX first_residuals_;
  VectorX rounding_;  ///< by unknown
  double weighted_residual_ = 0, weighted_scale_ = 0;
  Index worst_ = 0;
};

}  // namespace resilin
