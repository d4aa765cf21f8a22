#include "resilin/optimize/newton.hpp"

#include <utility>

#include "resilin/optimize/newton_search.hpp"

namespace resilin {
namespace {

constexpr const char* blocked_motion =
    "the prescribed motion would invert an element or lead surfaces through each other";

}  // namespace

NewtonReport Newton::Search::run(const NewtonObserver& observer) {
  using Status = NewtonReport::Status;
  using Verdict = Convergence::Verdict;
  newton.solver_->begin_search();
  newton.last_measure_.reset();  // there is no matrix yet
  int short_boundary_steps = 0;
  VectorX gap = boundary_gap();
  bool boundary_moves = (gap.array() != 0).any();
  objective.prepare(x, VectorX::Zero(x.size()));
  objective.gradient(x, gradient);
  measure_residual();
  renew_internal_values();
  while (true) {
    if (!convergence.is_finite()) return finish(Status::not_finite, "the forces are not finite numbers");
    if (!boundary_moves) {
      const Verdict now = verdict();
      if (now == Verdict::yes) return finish(Status::converged, "converged");
      if (now == Verdict::out_of_digits && last_residual > 0 && weighted_residual > 0.5 * last_residual)
        return finish_out_of_digits();
    }
    if (report.iterations >= settings.max_iterations) {
      return finish(Status::max_iterations, "the limit of Newton iterations was reached");
    }
    Projection projection = chooser.first_choice();
    LineSearch line;
    bool was_exact = true;
    while (!line.accepted) {
      Direction direction = find_direction(gap, boundary_moves, projection);
      newton.keep_measure(direction.found, parts, convergence.weights());
      if (!direction.found) {
        return finish(Status::singular,
                      settings.projection == ProjectionPolicy::none
                          ? "the stiffness matrix is indefinite; let newton.projection be \"auto\""
                          : "the stiffness matrix is singular: a part of the body can move freely");
      }
      // The Hessian tells what rounding of the positions leaves: with it the residual may already be small
      // enough.
      if (!boundary_moves && verdict() == Verdict::yes) return finish(Status::converged, "converged");
      if (!boundary_moves && !has_potential) use_true_tangent(direction);
      was_exact = direction.is_exact;
      line = boundary_moves ? follow_boundary() : search_line(direction.is_exact);
      if (line.accepted) break;
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
      const Projection used = was_exact ? Projection::none : projection;
      const Projection next = chooser.next_choice(used);
      if (next == used || next == projection) {
        const Verdict closer = boundary_moves ? Verdict::no : verdict(/*look_closer=*/true);
        if (closer == Verdict::yes) return finish(Status::converged, "converged");
        if (closer == Verdict::out_of_digits) return finish_out_of_digits();
        return finish(Status::stalled,
                      boundary_moves ? blocked_motion
                                     : "the line search found no lower energy along the Newton direction");
      }
      projection = next;
    }
    if (boundary_moves && line.length < 0.05 && ++short_boundary_steps > 5) {
      return finish(Status::stalled, blocked_motion);
    }
    accept_trial(line.length);
    if (watchdog.steps == 0) watchdog.is_strict = false;
    if (!boundary_moves) ask_for_potential();
    report.last_step_was_exact = was_exact && line.length == 1;
    chooser.step_was_taken(line.ratio, line.length);
    if (boundary_moves) {
      if (line.length == 1) {  // land on the targets exactly, whatever the rounding
        for (Eigen::Index i = 0; i < x.size(); ++i) {
          if (!is_free(i)) x[i] = targets[i];
        }
      }
      gap = boundary_gap();
      boundary_moves = (gap.array() != 0).any();
      if (!boundary_moves) last_residual = 0;
    }
    if (observer && !observer(report)) return finish(Status::interrupted, "interrupted");
  }
}

Newton::Newton(int dim, std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<LinearSolver> solver)
    : hessian_(dim, std::move(pattern)), parts_(*hessian_.pattern), solver_(std::move(solver)) {}

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

void Newton::keep_measure(bool has_matrix, const Parts& parts, const VectorX& weights) {
  last_measure_.reset();
  if (!has_matrix) return;
  last_measure_.emplace();
  if (parts.count() == 1) return;
  last_measure_->parts = parts;
  last_measure_->weights = weights;
}

void Newton::form_matrix(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                         const VectorX& x) {
  solver_->begin_search();
  hessian_.set_zero();
  objective.hessian(x, Projection::clamp, hessian_);
  eliminate(hessian_, is_fixed);
  solver_->analyze(hessian_, x);
  const LinearReport linear = solver_->factorize(hessian_);
  require_memory(linear);
  keep_measure(linear.status == LinearReport::Status::ok, parts_, VectorX::Ones(parts_.count()));
}

std::optional<VectorX> Newton::response(VectorX forces, std::span<const std::uint8_t> is_fixed,
                                        double tolerance) {
  if (!last_measure_) return std::nullopt;
  set_fixed_to_zero(is_fixed, forces);
  if (last_measure_->parts) scale_parts(*last_measure_->parts, last_measure_->weights, forces);
  VectorX way = VectorX::Zero(forces.size());
  const LinearReport linear = solver_->solve(hessian_, forces, way, tolerance);
  if (linear.status == LinearReport::Status::indefinite || !way.allFinite()) return std::nullopt;
  return way;
}

}  // namespace resilin
