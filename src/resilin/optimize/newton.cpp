#include "resilin/optimize/newton.hpp"

#include <utility>

#include "resilin/core/memory.hpp"
#include "resilin/optimize/newton_search.hpp"
#include "resilin/optimize/true_tangent.hpp"

namespace resilin {
namespace {

constexpr const char* blocked_motion =
    "the prescribed motion would invert an element or make surfaces penetrate";
/// A step towards the targets that the domain cut to less than this is followed by some at rest, in which
/// what is in the way gives way.
constexpr double short_boundary_step = 0.5;
constexpr int iterations_to_give_way = 3;
/// So many steps may be cut to less than a twentieth in one search.
constexpr int most_blocked_steps = 20;
/// Iterations after which lagged quantities may be updated.
constexpr int iterations_of_round = 8;

/// Throws OutOfMemory where a search with this pattern and solver does not fit.
std::shared_ptr<const BlockPattern> foreseen(int dim, std::shared_ptr<const BlockPattern> pattern,
                                             const LinearSolver& solver) {
  constexpr double vectors = 15;  // positions, steps, forces
  const double unknowns = static_cast<double>(pattern->num_nodes()) * dim;
  const double matrix = static_cast<double>(pattern->num_slots()) * dim * dim * sizeof(double);
  const double bytes = matrix + vectors * unknowns * sizeof(double) + solver.expected_bytes(*pattern, dim);
  if (!fits(bytes))
    foresee_memory(bytes,
                   "the equilibrium of " + std::to_string(pattern->num_nodes() * dim) + " DOFs with " +
                       std::string(solver.name()),
                   what_would_fit(unknowns, bytes, "DOFs") + ": take fewer cells, or raise the limit");
  return pattern;
}

}  // namespace

NewtonReport Newton::Search::finish(NewtonReport::Status status, std::string reason) {
  if (status != NewtonReport::Status::converged && watchdog.steps > 0) go_back();
  if (coupling.is_on()) {
    coupling.end();
    objective.couple_lag(false);
    objective.form_lag(x);
  }
  report.status = status;
  report.reason = std::move(reason);
  return report;
}

NewtonReport Newton::Search::finish_out_of_digits() {
  return finish(NewtonReport::Status::out_of_digits,
                "the residual is round-off, but too large: the positions have too few digits for a body this "
                "far from the origin, this stiff for its loads or moved in steps this short");
}

/// How far the step may go. Where that is not far, because surfaces turn on the way, the step is corrected
/// to second order first.
double Newton::Search::longest_step(bool boundary_moves) {
  const double way = boundary_moves ? way_left() : 0;
  const auto room_for = [&](const VectorX& p) {
    way > 0 ? led->prepare_along(x, p, way) : objective.prepare(x, p);
    return way > 0 ? led->max_step_along(x, p, way) : objective.max_step(x, p);
  };
  double length = room_for(step);
  VectorX forces, correction;
  for (int k = 0; k < most_corrections && length < short_step; ++k) {
    forces.setZero(x.size());
    if (way > 0 ? !led->add_second_order_forces_along(x, step, way, forces)
                : !objective.add_second_order_forces(x, step, forces))
      break;
    set_fixed_to_zero(is_fixed, forces);
    correction.setZero(x.size());
    LinearReport linear;
    {
      const Stopwatch watch(report.solve_seconds);
      linear = newton.solver_->solve(newton.hessian_, scaled(forces), correction, forcing_of_corrections);
    }
    report.linear_iterations += linear.iterations;
    if (linear.status == LinearReport::Status::indefinite || !share.all(correction.allFinite())) break;
    if (dependents != nullptr) dependents->follow(correction);
    correction += step;
    const double longer = room_for(correction);
    if (!(longer > 2 * length) || !(boundary_moves || share.dot(correction, right_side) > 0)) break;
    step.swap(correction);
    length = longer;
  }
  return length;
}

bool Newton::Search::use_true_tangent() {
  const Stopwatch watch(report.solve_seconds);
  const NearSolve near = [&](const VectorX& b, VectorX& p) {
    p.setZero(b.size());
    const LinearReport linear = newton.solver_->solve(newton.hessian_, scaled(b), p, 1e-3);
    report.linear_iterations += linear.iterations;
    if (dependents != nullptr) dependents->follow(p);
    return linear.status != LinearReport::Status::indefinite && share.all(p.allFinite());
  };
  VectorX p;
  const double tolerance = std::clamp(0.01 * weighted_residual / convergence.weighted_scale(), 1e-3, 0.01);
  const TangentReport tangent =
      solve_with_true_tangent(objective, is_fixed, share, x, right_side, near, tolerance, p);
  report.tangent_iterations += tangent.iterations;
  if (!(tangent.relative_residual < 0.3)) return false;
  step.swap(p);
  return true;
}

/// One step, over whatever projections it takes.
/// @param gap     what is missing at the boundary
/// @param length  of the step, relative to Newton's
Newton::Search::Outcome Newton::Search::move(const VectorX& gap, bool boundary_moves, double& length) {
  using Verdict = Convergence::Verdict;
  Projection projection = chooser.first_choice();
  while (true) {
    const Direction direction = find_direction(gap, boundary_moves, projection);
    newton.keep_measure(direction.found, coupled, coupled_weights);
    if (!direction.found) return Outcome::singular;
    // The Hessian tells what rounding of the positions leaves: with it the residual may already be small
    // enough.
    if (!boundary_moves && verdict() == Verdict::yes) return Outcome::balanced;
    bool is_exact = direction.is_exact;
    if (!boundary_moves && !has_potential) is_exact |= use_true_tangent();
    const LineSearch line = boundary_moves ? follow_boundary() : search_line(is_exact);
    if (line.accepted) {
      accept_trial(line.length);
      if (watchdog.steps == 0) watchdog.is_strict = false;
      report.last_step_was_exact = is_exact && line.length == 1;
      chooser.step_was_taken(line.ratio, line.length);
      length = line.length;
      return Outcome::moved;
    }
    if (watchdog.steps > 0) {
      go_back();
      projection = chooser.next_choice(Projection::none);
      continue;
    }
    if (internal_is_old) {
      renew_internal_values();
      projection = chooser.next_choice(Projection::none);
      continue;
    }
    const Projection used = is_exact ? Projection::none : projection;
    const Projection next = chooser.next_choice(used);
    if (next == used || next == projection) {
      const Verdict closer = boundary_moves ? Verdict::no : verdict(/*look_closer=*/true);
      if (closer == Verdict::yes) return Outcome::balanced;
      return closer == Verdict::out_of_digits && was_step_rounding() ? Outcome::out_of_digits
                                                                     : Outcome::stalled;
    }
    projection = next;
  }
}

/// Updates lagged quantities to x, where it is time. @return whether the search has to go on with it
bool Newton::Search::renew_lag(bool is_balanced) {
  if (coupling.is_on()) return false;
  const double relative = weighted_residual / convergence.weighted_scale();
  if (watchdog.steps > 0 || !(is_balanced || lag.is_due(weighted_residual, relative))) return false;
  VectorX change = gradient;
  if (!lag.form(x, gradient)) return false;
  change -= gradient;
  measure_residual();
  if (weighted_residual > 0) lag.set_share_of_change(convergence.weighted_norm(change) / weighted_residual);
  last_residual = 0;
  if (verdict() == Convergence::Verdict::yes) return false;
  if (lag.is_over()) {
    report.lag_mismatch = report.relative_residual();
    return false;
  }
  if (coupling.is_due(lag.rounds(), weighted_residual / convergence.weighted_scale())) {
    couple_lag();
    return true;
  }
  begin_round();
  return true;
}

/// Rounds need some of their own, but where a small limit cuts steps short on purpose.
int Newton::Search::most_iterations() const {
  const bool cuts_on_purpose = settings.max_iterations < NewtonSettings{}.max_iterations;
  const int of_rounds = cuts_on_purpose ? 0 : iterations_of_round * lag.rounds();
  return settings.max_iterations + of_rounds + coupling.lost_steps();
}

void Newton::Search::begin_round() {
  if (lag.begin_round(x, gradient)) measure_residual();
  lag.set_first_residual(weighted_residual);
  report.lag_rounds = lag.rounds();
}

/// From a place where what lags has been formed.
void Newton::Search::couple_lag() {
  coupling.begin(x, weighted_residual, has_potential, lag.rounds());
  has_potential = false;
  objective.couple_lag(true);
  objective.form_lag(x);
}

/// Back to where it began, to go on with rounds.
void Newton::Search::uncouple_lag() {
  coupling.give_up();
  has_potential = coupling.had_potential();
  objective.couple_lag(false);
  x = coupling.start();
  lag.come_back();
  objective.gradient(x, gradient);
  measure_residual();
  renew_internal_values();
  last_residual = 0;
  begin_round();
}

NewtonReport Newton::Search::run(const NewtonObserver& observer) {
  using Status = NewtonReport::Status;
  using Verdict = Convergence::Verdict;
  newton.solver_->begin_search();
  newton.last_measure_.reset();  // there is no matrix yet
  int blocked_steps = 0, giving_way = 0;
  const auto is_late = [&] { return 2 * report.iterations > settings.max_iterations; };
  VectorX gap = boundary_gap();
  bool boundary_moves = gap.size() > 0 || way_left() > 0;
  objective.prepare(x, VectorX::Zero(x.size()));
  objective.gradient(x, gradient);
  measure_residual();
  renew_internal_values();
  while (true) {
    if (!convergence.is_finite()) return finish(Status::not_finite, "the forces are not finite numbers");
    if (!boundary_moves) {
      renew_lag(/*is_balanced=*/false);
      Verdict now = verdict();
      if (now == Verdict::yes) {
        if (!renew_lag(/*is_balanced=*/true)) return finish(Status::converged, "converged");
        now = verdict();
      }
      if (now == Verdict::out_of_digits && last_residual > 0 && weighted_residual > 0.5 * last_residual &&
          was_step_rounding())
        return finish_out_of_digits();
    }
    if (report.iterations >= most_iterations()) {
      return finish(Status::max_iterations, "the limit of Newton iterations was reached");
    }
    double length = 0;
    const bool leads = way_left() > 0;
    const bool pushes = boundary_moves && giving_way == 0 && (!leads || led->has_room(x));
    const Outcome outcome = move(gap, pushes, length);
    if (boundary_moves && !pushes) {
      giving_way = outcome == Outcome::moved ? std::max(giving_way - 1, 0) : 0;
      // Pushed on, bodies that cannot give way would lose what distance is left.
      const bool is_stuck = outcome == Outcome::balanced ? leads && !led->find_room_in_balance(x)
                                                         : outcome != Outcome::moved || is_late();
      if (leads && is_stuck) {
        led->leave_way();
        boundary_moves = gap.size() > 0;
        continue;
      }
    }
    if (coupling.is_on() && outcome != Outcome::balanced &&
        (outcome != Outcome::moved || coupling.fails(length, weighted_residual)) &&
        verdict() != Verdict::yes) {
      uncouple_lag();
      continue;
    }
    switch (outcome) {
      case Outcome::moved:
        break;
      case Outcome::balanced:
        if (boundary_moves) continue;
        if (renew_lag(/*is_balanced=*/true)) continue;
        return finish(Status::converged, "converged");
      case Outcome::out_of_digits:
        if (boundary_moves) continue;
        return finish_out_of_digits();
      case Outcome::singular:
        return finish(Status::singular,
                      settings.projection == ProjectionPolicy::none
                          ? "the stiffness matrix is indefinite; let newton.projection be \"auto\""
                          : "the stiffness matrix is singular: a part of the body can move freely");
      case Outcome::stalled:
        if (boundary_moves && !pushes) continue;
        if (pushes && way_left() > 0) {
          led->leave_way();
          boundary_moves = gap.size() > 0;
          continue;
        }
        return finish(Status::stalled,
                      boundary_moves ? blocked_motion
                                     : "the line search found no lower energy along the Newton direction");
    }
    if (pushes) {
      const bool is_blocked = length < 0.05 && ++blocked_steps > most_blocked_steps;
      if (is_blocked && !(way_left() > 0)) return finish(Status::stalled, blocked_motion);
      // The rest of its iterations the search needs for the bodies.
      if (way_left() > 0 && (is_blocked || is_late())) {
        led->leave_way();
        blocked_steps = 0;
      }
      if (length < short_boundary_step) giving_way = iterations_to_give_way;
      if (length == 1) land_on_targets(x);
      gap = boundary_gap();
      boundary_moves = gap.size() > 0 || way_left() > 0;
      if (!boundary_moves) {
        last_residual = 0;
        giving_way = 0;
      }
    } else {
      ask_for_potential();
    }
    if (observer && !observer(report)) return finish(Status::interrupted, "interrupted");
  }
}

Newton::Newton(int dim, std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<LinearSolver> solver,
               const ProcessGroup& share)
    : hessian_(dim, foreseen(dim, std::move(pattern), *solver)),
      parts_(*hessian_.pattern, share),
      solver_(std::move(solver)) {}

NewtonReport Newton::minimize(Objective& objective, std::span<const std::uint8_t> is_fixed,
                              const VectorX& targets, const NewtonSettings& settings, VectorX& x,
                              const NewtonObserver& observer) {
  Search search{.newton = *this,
                .objective = objective,
                .is_fixed = is_fixed,
                .targets = targets,
                .settings = settings,
                .x = x};
  return search.run(observer);
}

}  // namespace resilin
