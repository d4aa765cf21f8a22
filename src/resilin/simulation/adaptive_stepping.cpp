#include <algorithm>
#include <cmath>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/step_attempt.hpp"
#include "resilin/simulation/turning_step.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/linear_constraints.hpp"

// Steps as long as an estimate of their error allows: the part of TimeStepper that chooses them.

namespace resilin {
namespace {

/// To which solvers filter an estimate, relative to it.
constexpr double filter_tolerance = 1e-8;

struct PlannedStep {
  double length;  ///< [s]
  double end;     ///< [s]; an event exactly where the step meets one
  bool is_cut;    ///< it would be longer if there were no event
};

/// A step of the length `wanted`, or of what is left until the next event or the end: all of it when it is no
/// longer, half of it when it is less than twice as long, so that no sliver is left over.
PlannedStep plan_step(const World& world, const State& state, double wanted) {
  const double meaningful = 1e-9 * std::max(world.end_time, world.time_step);
  double event = world.end_time;
  for (const double time : world.event_times) {
    if (time > state.time + meaningful && time < event - meaningful) event = time;
  }
  const double left = event - state.time;
  if (wanted >= left * (1 - 1e-9)) return {left, event, true};
  if (2 * wanted > left) return {left / 2, state.time + left / 2, true};
  return {wanted, state.time + wanted, false};
}

/// The longest vector of a node in `vectors`, its fixed components left out.
double largest_free_distance(const World& world, const VectorX& vectors) {
  double largest = 0;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    double square = 0;
    for (int k = 0; k < world.dimension; ++k) {
      const Eigen::Index i = Eigen::Index{node} * world.dimension + k;
      const bool follows = world.constraints && world.dependents()->is_dependent(static_cast<Index>(i));
      if (world.is_fixed[static_cast<std::size_t>(i)] == 0 || follows) square += vectors[i] * vectors[i];
    }
    largest = square > largest || std::isnan(square) ? square : largest;
  }
  return std::sqrt(world.share.is_whole() || std::isnan(largest) ? largest : world.share.largest(largest));
}

VectorX contact_accelerations(const World& world, const State& state) {
  const VectorX& x = state.positions;
  VectorX gradient = Potential::at(world, state).impulses(x);
  add_friction_forces(world, state, gradient);
  return accelerations_by(world, -gradient);
}

/// By how much the next length should differ from the one tried.
class LengthChoice {
 public:
  explicit LengthChoice(int order) : order_(order + 1.0) {}

  /// The error of a step grows with its length to the power order + 1; where contact begins, by less: what an
  /// attempt before has shown decides.
  /// @param error  over the tolerance
  double factor(double length, double error) {
    if (!std::isfinite(error)) return 0.5;
    if (error > 0 && last_error_ > error)
      order_ = std::clamp(std::log(last_error_ / error) / std::log(last_length_ / length), 1.0, order_);
    last_error_ = error;
    last_length_ = length;
    return on_ladder(std::clamp(0.9 * std::pow(error, -1 / order_), 0.1, 2.0));
  }

 private:
  /// Rounded down to five binary digits, so that lengths have the same bits whatever rounding, and solvers
  /// that stop somewhere within a tolerance, leave in an estimate.
  static double on_ladder(double factor) {
    int exponent = 0;
    const double mantissa = std::frexp(factor, &exponent);
    return std::ldexp(std::floor(32 * mantissa), exponent - 5);
  }

  double order_, last_error_ = 0, last_length_ = 0;
};

}  // namespace

double TimeStepper::step_error(const World& world, Newton& newton, const State& state, const Attempt& found,
                               double time_step) const {
  History start = start_of_step(world, state, time_step);
  const bool is_new = world.share.any(start.now.accelerations != state.accelerations);
  if (is_new) start.previous_time_step = 0;  // the step before an event says nothing about the next one
  VectorX by_contact = contact_accelerations(world, state) / 3;
  if (found.contact_accelerations.size() > 0) by_contact += found.contact_accelerations / 6;
  const VectorX error =
      found.scheme->local_error(start, found.end, time_step) - time_step * time_step * by_contact;
  // Bodies in contact may part within the step: contact holds no error back.
  const bool touches = world.share.any(!by_contact.isZero(0));
  const Conditions end = conditions_after(state, time_step);
  const Terms terms = terms_without(EnergyCategory::contact, world.terms);
  newton.form_matrix(
      Potential(terms, world.is_fixed, end, found.last_stage, world.share, state.history, world.dependents()),
      world.is_fixed, found.end.positions, touches ? Newton::Factors::anew : Newton::Factors::of_search);
  // (M/c^2 + K)^-1 M/c^2 e, (I.8)
  const auto filtered_distance = [&](const VectorX& way) {
    VectorX forces;
    world.mass->multiply(way / found.last_stage.scale(), forces);
    world.share.add_copies(forces);
    if (world.constraints) world.dependents()->add_forces(forces);
    std::optional<VectorX> filtered = newton.response(std::move(forces), world.is_fixed, filter_tolerance);
    if (filtered && world.constraints) world.dependents()->follow(*filtered);
    return largest_free_distance(world, filtered ? *filtered : way);
  };
  const double distance = filtered_distance(error);
  return found.slowing.size() == 0 ? distance : distance + filtered_distance(time_step * found.slowing);
}

StepReport TimeStepper::adaptive_step(const World& world, const AdaptiveSteps& options, Newton& newton,
                                      State& state, VectorX& gradient, const NewtonObserver& observer) const {
  const double tolerance = options.tolerance * world.largest_extent();
  const double shortest = options.min_step.value_or(1e-6 * world.time_step);
  const double longest = std::max(shortest, options.max_step.value_or(world.end_time));
  double wanted = std::clamp(state.time_step, shortest, longest);
  NewtonReport spent;
  LengthChoice choice(integrator_->order());
  for (int failed_attempts = 0;; ++failed_attempts) {
    PlannedStep planned = plan_step(world, state, wanted);
    int num_parts = num_steps_of_turn(turn_of_step(world, state, planned.length));
    while (num_parts > 1 && planned.length > shortest * (1 + 1e-9) &&
           turns_evenly(world, state, planned.length / num_parts, num_parts)) {
      wanted = std::max(shortest, planned.length / num_parts);
      planned = plan_step(world, state, wanted);
      num_parts = num_steps_of_turn(turn_of_step(world, state, planned.length));
    }
    if (num_parts > 1) {  // a turn at once, or nearly so
      State next;
      StepReport report = step_in_parts(world, newton, state, next, gradient, planned.length, num_parts,
                                        WhenLost::go_on, observer);
      if (report.status == StepReport::Status::interrupted) return report;
      state = std::move(next);
      state.time = planned.end;
      return report;
    }
    Attempt found = safe_attempt(world, newton, state, planned.length, observer);
    StepReport& report = found.report;
    std::swap(spent, report.newton);
    add_to(report.newton, spent);
    spent = report.newton;
    report.failed_attempts = failed_attempts;
    if (found.is_interrupted()) return report;
    report.time_step = planned.length;
    report.time_error = step_error(world, newton, state, found, planned.length);
    const double error = report.time_error / tolerance;
    const double fitting = found.remedies.shorter_step ? 0.5 : choice.factor(planned.length, error);
    const bool is_accepted = !found.remedies.shorter_step && error <= 1;
    if (!is_accepted && planned.length > shortest * (1 + 1e-9)) {
      wanted = std::max(shortest, std::min(0.9, fitting) * planned.length);
      continue;
    }
    if (!(error <= 1)) {
      report.status = StepReport::Status::not_converged;
      if (report.reason.empty()) {
        report.reason = "the shortest step has an error of about " + format_number(report.time_error) +
                        " m at a vertex, above the tolerance of " + format_number(tolerance) + " m";
      }
    }
    gradient = std::move(found.gradient);
    StepReport done = report;
    std::move(found).move(world, state, planned.length, planned.end);
    // A step cut short at an event says nothing against longer ones.
    const double next = (failed_attempts > 0 ? std::min(1.0, fitting) : fitting) * planned.length;
    state.time_step = std::clamp(planned.is_cut ? std::max(next, wanted) : next, shortest, longest);
    return done;
  }
}

}  // namespace resilin
