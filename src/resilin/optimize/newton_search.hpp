#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "resilin/core/stopwatch.hpp"
#include "resilin/linear/dependents.hpp"
#include "resilin/optimize/convergence.hpp"
#include "resilin/optimize/kept_factors.hpp"
#include "resilin/optimize/lag.hpp"
#include "resilin/optimize/led_motion.hpp"
#include "resilin/optimize/newton.hpp"
#include "resilin/optimize/residual.hpp"

/// The parts of a Newton search: directions and steps along them. For newton.cpp, which puts them together.
namespace resilin {

/// One call of `minimize`.
struct Newton::Search {
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();
  /// After so many halvings a step along which carried internal values led is given up for one at those of x:
  /// the globalisation of docs/theory/mean_volume.md.
  static constexpr int max_halvings_of_carried_values = 4;
  /// So many times may a step that is let pass raise the residual. Volumes that are off for a moment do so by
  /// the ratio of the moduli; from where stiffening fibres raise it by more there is no way back.
  static constexpr double most_growth_of_residual = 1e6;

  /// Shorter steps are corrected to second order, so many times.
  static constexpr double short_step = 0.3;
  static constexpr int most_corrections = 3;
  static constexpr double forcing_of_corrections = 1e-2;

  /// Parts of a way that are tried, and the longest of one of another.
  static constexpr int most_parts = 20;
  static constexpr double longest_part = 0.99;

  Newton& newton;
  Objective& objective;
  std::span<const std::uint8_t> is_fixed;
  const VectorX& targets;
  const NewtonSettings& settings;
  VectorX& x;
  LedMotion* led = dynamic_cast<LedMotion*>(&objective);  ///< null: nothing moves by itself

  const Dependents* const dependents{objective.dependents()};
  const ConnectedComponents& parts{newton.parts_};
  ConnectedComponents coupled{newton.parts_};  ///< parts in contact are one, and stay one for this search
  const ProcessGroup share{parts.share()};
  Convergence convergence{objective, is_fixed, parts, settings.tolerance};
  NewtonReport report{};
  ProjectionChooser chooser{settings.projection};
  Lag lag{objective, settings.lag_rounds};
  CoupledLag coupling{};
  VectorX gradient{}, step{}, trial{}, trial_gradient{}, right_side{};
  bool gradient_at_trial_is_known = false;
  VectorX internal{};  ///< where the Hessian is formed besides x ...
  struct Watchdog {
    VectorX x{}, gradient{};  ///< where the energy was lowest ...
    double residual = 0;      ///< ... with this weighted residual [N] ...
    int steps = 0;            ///< ... before so many steps
    bool is_strict = false;   ///< the next step must lower it
  } watchdog{};
  bool internal_is_old = false;  ///< ... carried along to first order, not of x itself
  VectorX diagonal{};            ///< |diagonal of the last Hessian| [N/m]
  VectorX coupled_weights{};     ///< coupled weights of `coupled`, in the last Hessian
  VectorX scaled_right_side{};   ///< right side of several parts, scaled so that an iterative solver sees all
                                 ///< alike
  double weighted_residual = 0;
  double last_residual = 0;  ///< the one before
  double last_ratio = 1;     ///< residual after the last step, relative to the one before
  double last_forcing = 0;
  KeptFactors factors{};
  double last_shift =
      0;  ///< last shift of a matrix that stayed indefinite though projected: the next one will, too
  bool has_potential = true;  ///< unless slow convergence asked and the objective said no
  bool potential_is_known = false;

  bool is_free(Eigen::Index i) const { return is_fixed[static_cast<std::size_t>(i)] == 0; }

  /// The last step moved nothing by more than rounding of the positions may: else it is not known that a
  /// large stiffness, as where surfaces were close for a moment, says what rounding leaves.
  bool was_step_rounding() const {
    constexpr double most = 1e4 * epsilon;
    return share.all(step.lpNorm<Eigen::Infinity>() <= most * x.lpNorm<Eigen::Infinity>());
  }

  /// Rest of the prescribed displacements at the fixed DOFs, zero at the free ones; empty where nothing is
  /// left.
  VectorX boundary_gap() const {
    VectorX gap = VectorX::Zero(x.size());
    if (dependents == nullptr) {
      for (Eigen::Index i = 0; i < x.size(); ++i)
        if (!is_free(i)) gap[i] = targets[i] - x[i];
    } else {
      VectorX placed = x;
      land_on_targets(placed);
      gap = placed - x;
    }
    return share.any((gap.array() != 0).any()) ? gap : VectorX();
  }

  /// Fixed unknowns come to their targets exactly, whatever the rounding, and dependent ones to where they
  /// follow; their targets are the constants.
  void land_on_targets(VectorX& positions) const {
    for (Eigen::Index i = 0; i < positions.size(); ++i) {
      if (!is_free(i)) positions[i] = targets[i];
    }
    if (dependents != nullptr) dependents->place(targets, positions);
  }

  /// Puts dependent unknowns to where they follow, so that no rounding errors add up, once the boundary
  /// stands.
  void keep_following(VectorX& positions) const {
    if (dependents != nullptr && boundary_gap().size() == 0) dependents->place(targets, positions);
  }

  /// Rest of the way of what moves by itself.
  double way_left() const { return led == nullptr ? 0 : led->way_left(); }

  void measure_residual() {
    convergence.measure(x, gradient);
    weighted_residual = convergence.weighted_residual();
    note_worst_part();
  }

  void note_worst_part() {
    report.residual = convergence.residual();
    report.force_scale = convergence.force_scale();
    report.worst_unknown = convergence.worst_unknown();
  }

  Convergence::Verdict verdict(bool look_closer = false) {
    const Convergence::Verdict verdict = convergence.verdict(diagonal, look_closer);
    report.rounding = convergence.rounding();
    if (verdict == Convergence::Verdict::yes) note_worst_part();
    return verdict;
  }

  /// How exactly the linear system is worth solving: Eisenstat & Walker 1996, choice 2, never finer than what
  /// the stopping rule asks for.
  double forcing_term() const {
    const double goal = 0.3 * settings.tolerance * convergence.weighted_scale() / weighted_residual;
    if (settings.is_quadratic) return std::min(goal, settings.tolerance);
    const double most = lag.rounds() > 0 ? Lag::forcing : 1e-2;
    if (lag.rounds() > 0 && last_residual == 0)
      return std::clamp(lag.first_forcing(last_ratio), std::min(goal, most), most);
    double forcing = most;
    if (last_residual > 0) {
      const double ratio = weighted_residual / last_residual;
      forcing = std::min(forcing, 0.9 * ratio * ratio);
      const double safeguard = 0.9 * last_forcing * last_forcing;
      if (safeguard > 0.1) forcing = std::max(forcing, safeguard);
    }
    return std::clamp(forcing, std::min(goal, most), most);
  }

  struct Direction {
    bool found = false;
    bool is_exact = true;
  };

  /// `shift` times the largest diagonal entry is added to the diagonal: 0, or a little where a projected
  /// matrix is still singular (Levenberg 1944).
  Direction solve_with(Projection projection, double shift, const VectorX& gap, bool boundary_moves) {
    Direction direction{.is_exact = projection == Projection::none && shift == 0};
    for (VectorX* left : {&trial, &trial_gradient}) left->resize(0);  // no memory held while it is solved
    {
      const Stopwatch watch(report.assembly_seconds);
      newton.hessian_.set_zero();
      objective.hessian_at(internal, x, projection, newton.hessian_);
      right_side = -gradient;
      if (boundary_moves && gap.size() > 0) {
        VectorX pull;
        multiply(newton.hessian_, gap, pull);
        share.add_copies(pull);
        if (dependents != nullptr) dependents->add_forces(pull);
        right_side -= pull;
      }
      if (boundary_moves && way_left() > 0) {
        BlockMatrix room(newton.hessian_.dim, newton.hessian_.pattern);
        VectorX pull = VectorX::Zero(x.size());
        led->add_pull(x, way_left(), projection, room, pull);
        if (dependents != nullptr) dependents->add_forces(pull);
        right_side -= pull;
      }
      if (dependents != nullptr) dependents->reduce(newton.hessian_);
      diagonal = free_diagonal(newton.hessian_, is_fixed, share);
      set_fixed_to_zero(is_fixed, right_side);
      if (shift > 0) add_to_diagonal(shift);
      eliminate(newton.hessian_, is_fixed);
      scale_system();
    }
    const Stopwatch watch(report.solve_seconds);
    ++report.linear_solves;
    if (!direction.is_exact) ++report.projected_solves;
    const std::optional<LinearReport> linear = solve_system(direction.is_exact);
    if (!linear) return direction;
    direction.found = linear->status != LinearReport::Status::indefinite && share.all(step.allFinite());
    if (dependents != nullptr) dependents->follow(step);
    if (direction.found && boundary_moves) {
      if (gap.size() > 0) step += gap;
    } else if (direction.found) {
      direction.found = share.dot(step, right_side) > 0;
    }
    return direction;
  }

  /// Makes `step` the solution of the linear system; none where the matrix has no factors.
  std::optional<LinearReport> solve_system(bool is_exact) {
    last_forcing = forcing_term();
    const auto solve = [&] {
      step.setZero(x.size());
      const VectorX& b = coupled.count() > 1 ? scaled_right_side : right_side;
      const LinearReport linear = newton.solver_->solve(newton.hessian_, b, step, last_forcing);
      report.linear_iterations += linear.iterations;
      return linear;
    };
    if (lag.rounds() > 0 && is_exact && factors.may_serve()) {
      const LinearReport linear = solve();
      const bool is_solved =
          linear.status == LinearReport::Status::ok && linear.relative_residual <= last_forcing;
      factors.tried(is_solved, linear.iterations, last_forcing);
      if (is_solved) return linear;
    }
    factors.leave();
    newton.solver_->analyze(newton.hessian_, x);  // quick on the same pattern; the rigid modes are those at x
    LinearReport linear = newton.solver_->factorize(newton.hessian_);
    require_memory(linear);
    if (linear.status != LinearReport::Status::ok) return std::nullopt;
    linear = solve();
    if (is_exact && !newton.solver_->is_direct()) factors.made(linear.iterations, last_forcing);
    return linear;
  }

  /// Forces without a potential: the step of the symmetric part is only the start of the one of the true
  /// tangent, which takes its place when GMRES finds it. @return whether it did
  bool use_true_tangent();

  /// A residual that falls slowly may come of forces without a potential: asked once, for it costs some
  /// gradients.
  void ask_for_potential() {
    if (potential_is_known || weighted_residual <= 0.2 * last_residual) return;
    potential_is_known = true;
    has_potential = objective.has_potential(x);
  }

  /// `shift` times the largest entry of the part.
  void add_to_diagonal(double shift) {
    BlockMatrix& H = newton.hessian_;
    const VectorX largest = parts.largest(diagonal);
    for (Index node = 0; node < H.num_nodes(); ++node)
      for (int k = 0; k < H.dim; ++k)
        if (share.owns(node)) H.add_to_diagonal(node, k, shift * largest[parts.of_node(node)]);
  }

  /// In a measure in which all parts that the matrix does not couple count alike.
  void scale_system() {
    if (coupled.count() > 1 && !newton.hessian_.extra.empty()) coupled = coupled.joined_by(newton.hessian_);
    if (coupled.count() == 1) return;
    coupled_weights = convergence.weights_of(coupled);
    scale_components(coupled, coupled_weights, newton.hessian_);
    scaled_right_side = scaled(right_side);
  }
  VectorX scaled(VectorX forces) const {
    if (coupled.count() > 1) scale_components(coupled, coupled_weights, forces);
    return forces;
  }

  /// A descent direction (towards the targets, too, when the boundary moves), or none.
  Direction find_direction(const VectorX& gap, bool boundary_moves, Projection first) {
    Projection projection = first;
    while (true) {
      Direction direction = solve_with(projection, 0, gap, boundary_moves);
      if (direction.found) {
        last_shift = 0;
        return direction;
      }
      if (projection == Projection::none) chooser.matrix_was_indefinite();
      const Projection stronger = chooser.next_choice(projection);
      if (stronger != projection && last_shift == 0) {
        projection = stronger;
        continue;
      }
      if (stronger == Projection::none) return direction;
      for (const double shift : {1e-6, 1e-3, 1.0}) {
        if (shift < std::min(last_shift, 1e-3)) continue;
        direction = solve_with(chooser.next_choice(stronger), shift, gap, boundary_moves);
        last_shift = shift;
        if (direction.found) return direction;
      }
      return direction;
    }
  }

  double longest_step(bool boundary_moves);

  struct LineSearch {
    bool accepted = false;
    double length = 0;
    double ratio = 1;  ///< actual over predicted decrease
  };

  /// A projected Hessian is too stiff along directions of negative curvature, where a body leaves a saddle:
  /// the step is doubled for as long as that lowers the energy.
  void go_further(double decrease, double& length) {
    VectorX further_gradient;
    while (true) {
      const VectorX twice = 2 * length * step;
      objective.prepare(x, twice);
      if (objective.max_step(x, twice) < 1) return;
      VectorX further = x + twice;
      keep_following(further);
      const double more = -objective.difference(x, further);
      if (!(more > decrease) || !std::isfinite(more)) return;
      objective.gradient(further, further_gradient);
      if (!std::isfinite(convergence.weighted_norm(further_gradient))) return;
      decrease = more;
      length *= 2;
      trial.swap(further);
      trial_gradient.swap(further_gradient);
    }
  }

  /// Without a potential a step may also be taken because it lowers the residual.
  bool lowers_residual(double length) {
    return knows_finite_forces() &&
           convergence.weighted_norm(trial_gradient) <= (1 - settings.armijo * length) * weighted_residual;
  }

  /// An energy may be finite where the forces, or their norm, are not numbers any more.
  bool knows_finite_forces() {
    if (!gradient_at_trial_is_known) objective.gradient(trial, trial_gradient);
    gradient_at_trial_is_known = true;
    return std::isfinite(convergence.weighted_norm(trial_gradient));
  }

  /// The whole step along carried internal values: taken when the energy falls below its lowest value, and as
  /// one of a few steps in a row that do not lower it (watchdog technique, Chamberlain et al. 1982).
  bool passes_whole(double slope, LineSearch& result) {
    if (internal.size() == 0 || settings.relaxed_steps == 0 || watchdog.is_strict) return false;
    trial = x + result.length * step;
    keep_following(trial);
    gradient_at_trial_is_known = false;
    const double decrease = -objective.difference(watchdog.steps > 0 ? watchdog.x : x, trial);
    if (!std::isfinite(decrease) || !knows_finite_forces()) return false;
    const bool is_lower = decrease >= -settings.armijo * result.length * slope;
    if (is_lower && watchdog.steps == 0) return false;  // for the line search to judge
    if (!is_lower && watchdog.steps >= settings.relaxed_steps) return false;
    const double lowest_residual = watchdog.steps > 0 ? watchdog.residual : weighted_residual;
    if (!(convergence.weighted_norm(trial_gradient) <= most_growth_of_residual * lowest_residual))
      return false;
    if (watchdog.steps == 0) {
      watchdog.x = x;
      watchdog.gradient = gradient;
      watchdog.residual = weighted_residual;
    }
    watchdog.steps = is_lower ? 0 : watchdog.steps + 1;
    result.accepted = true;
    return true;
  }

  /// Back to where the energy was lowest, to go on from there by steps that lower it.
  void go_back() {
    x = watchdog.x;
    gradient = watchdog.gradient;
    watchdog.steps = 0;
    watchdog.is_strict = true;
    measure_residual();
    renew_internal_values();
  }

  /// Armijo's rule on the sum of small differences; near round-off on the slope (Hager & Zhang 2005).
  LineSearch search_line(bool is_exact) {
    LineSearch result;
    double magnitude = -1;
    result.length = longest_step(/*boundary_moves=*/false);
    const double slope =
        -share.dot(step, right_side);  // right side is minus the gradient, zero at fixed unknowns
    right_side.resize(0);              // no memory held for it until the next system
    if (passes_whole(slope, result) || watchdog.steps > 0) return result;
    const int max_halvings = internal_is_old ? max_halvings_of_carried_values : settings.max_halvings;
    for (int halving = 0; halving <= max_halvings; ++halving) {
      trial = x + result.length * step;
      keep_following(trial);
      gradient_at_trial_is_known = false;
      const double decrease = -objective.difference(x, trial);
      const double t = result.length;
      if (!has_potential && std::isfinite(decrease) && lowers_residual(t)) {
        result.accepted = true;
        return result;
      }
      if (slope < 0 && decrease >= -settings.armijo * t * slope && std::isfinite(decrease) &&
          knows_finite_forces()) {
        result.accepted = true;
        result.ratio = decrease / (-slope * (t - 0.5 * t * t));
        if (!is_exact && t == 1 && result.ratio > 1) go_further(decrease, result.length);
        return result;
      }
      if (magnitude < 0) magnitude = objective.magnitude(x);
      if (-t * slope <= 1e3 * epsilon * magnitude && std::isfinite(decrease) && knows_finite_forces()) {
        const double trial_slope = slope_along_step(trial_gradient);
        if (std::abs(trial_slope) <= (1 - settings.armijo) * std::abs(slope)) {
          result.accepted = true;
          return result;
        }
      }
      result.length *= 0.5;
      ++report.line_search_halvings;
    }
    return result;
  }

  double slope_along_step(const VectorX& at_trial) const {
    const Eigen::Index dim = step.size() / parts.num_nodes();
    double slope = 0;
    for (Eigen::Index i = 0; i < step.size(); ++i)
      if (is_free(i) && share.owns(static_cast<Index>(i / dim))) slope += step[i] * at_trial[i];
    return share.sum(slope);
  }

  /// The longest part of the step that is free: on arcs and uneven ways a part is none of the chord.
  double free_part(double length) {
    for (int part = 0; part < most_parts && length < 1; ++part) {
      const VectorX part_of_step = length * step;
      const double way = length * way_left();
      led->prepare_along(x, part_of_step, way);
      const double free = led->max_step_along(x, part_of_step, way);
      if (free == 1) break;
      length *= std::min(free, longest_part);
    }
    return length;
  }

  /// While the boundary moves there is no energy to compare with: the step goes as far as the domain allows.
  LineSearch follow_boundary() {
    LineSearch result;
    result.length = longest_step(/*boundary_moves=*/true);
    const double way = way_left();
    if (way > 0) result.length = free_part(result.length);
    right_side.resize(0);
    for (int halving = 0; halving < 12; ++halving) {
      trial = x + result.length * step;
      gradient_at_trial_is_known = false;
      if (way > 0) led->set_way_left(way - result.length * way);
      const bool is_valid =
          way > 0 ? led->is_in_domain(trial) : std::isfinite(objective.difference(x, trial));
      if (is_valid && knows_finite_forces()) {
        result.accepted = true;
        return result;
      }
      result.length *= 0.5;
    }
    if (way > 0) led->set_way_left(way);
    return result;
  }

  /// The Hessian is formed at the internal values that belong to x.
  void renew_internal_values() {
    internal = objective.internal_values(x);
    internal_is_old = false;
  }

  void accept_trial(double length) {
    if (internal.size() > 0) {
      internal = objective.predicted_internal_values(x, step, length);
      internal_is_old = true;
    }
    knows_finite_forces();
    objective.follow(x, step, length);
    x.swap(trial);
    gradient.swap(trial_gradient);
    ++report.iterations;
    lag.leave();
    if (coupling.is_on()) objective.form_lag(x);
    last_residual = weighted_residual;
    measure_residual();
    last_ratio = weighted_residual / last_residual;
    if (length < 1) factors.leave();
  }

  NewtonReport finish(NewtonReport::Status status, std::string reason);
  NewtonReport finish_out_of_digits();
  enum class Outcome { moved, balanced, out_of_digits, singular, stalled };
  Outcome move(const VectorX& gap, bool boundary_moves, double& length);
  bool renew_lag(bool is_balanced);
  int most_iterations() const;
  void begin_round();
  void couple_lag();
  void uncouple_lag();
  NewtonReport run(const NewtonObserver& observer);
};

}  // namespace resilin
