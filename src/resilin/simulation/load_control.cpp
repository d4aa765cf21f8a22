#include "resilin/simulation/load_control.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/simulation/contact_patches.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/jump.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/slide.hpp"
#include "resilin/simulation/stage_plan.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/world/friction.hpp"

namespace resilin {
namespace {

constexpr double smallest_load_increment = 1e-4;
constexpr double load_growth = 1.5;
constexpr int quick_convergence = 5;  ///< Newton iterations below which the load increment grows
/// Iterations of a step that has been shortened and can be once more: two halves take fewer.
constexpr int most_iterations_of_a_shortened_step = 40;
/// Up to this number of unknowns a factorisation for each equilibrium costs a fraction of a second.
constexpr Index most_unknowns_counted = 10000;

/// Tighter tolerance for a load that seems to have no equilibrium: of forces that large ones elsewhere in
/// the body hide, less is then left.
constexpr double tight_tolerance = 1e-12;
constexpr double smallest_share_of_path =
    1.0 / 64;  ///< least part of the path in a load step: shorter ones jump where these do
constexpr int most_attempts_without_digits = 4;
constexpr double smallest_tight_share = 0.25;  ///< least load step at the tight tolerance

double turn_between(const World& world, double load, double next) {
  return largest_turn(world, world.at_load(load), world.at_load(next));
}

/// Equal increments that a scene asks for between two load factors.
struct Increments {
  double from = 0, to = 1;
  int count = 1;
  double share = 1;  ///< one over the number of steps of the scene
  double length() const { return (to - from) / count; }
};

/// Those of the whole run, or of the step in which a load factor lies where steps differ in duration.
Increments increments_at(const World& world, double load) {
  const Increments all{.count = world.load_steps};
  const std::size_t num_steps = world.steps.size();
  const auto begin_of = [&](std::size_t i) { return i == 0 ? 0 : world.steps[i - 1].end / world.path_time; };
  const auto end_of = [&](std::size_t i) { return i + 1 == num_steps ? 1 : begin_of(i + 1); };
  constexpr double rounding = 1e-9;
  bool differ = false;
  for (std::size_t i = 0; i < num_steps && world.path_time > 0; ++i)
    differ = differ || std::abs(end_of(i) - begin_of(i) - 1.0 / static_cast<double>(num_steps)) > rounding;
  if (!differ) return all;
  std::size_t in = 0;
  while (in + 1 < num_steps && end_of(in) <= load + rounding * (end_of(in) - begin_of(in))) ++in;
  return {.from = begin_of(in),
          .to = end_of(in),
          .count = world.load_steps / static_cast<int>(num_steps),
          .share = 1.0 / static_cast<double>(num_steps)};
}

/// Length of the increments that a scene asks for at a load factor.
double asked_increment(const World& world, double load) { return increments_at(world, load).length(); }

/// The smallest increment, so much shorter where a step of the scene is short.
double smallest_increment(const World& world, double load) {
  const Increments increments = increments_at(world, load);
  return smallest_load_increment * (increments.to - increments.from) / increments.share;
}

/// The next load factor that a step has to meet: the end of an increment, so that a scene gets the frames
/// that it asked for, or one where something that follows time begins, ends or has a kink.
double next_stop(const World& world, double load) {
  const Increments increments = increments_at(world, load);
  const double length = increments.to - increments.from;
  const double asked = std::floor((load - increments.from) / length * increments.count + 1e-9) + 1;
  double stop =
      asked >= increments.count ? increments.to : increments.from + asked / increments.count * length;
  if (world.path_time == 0) return stop;
  for (const double time : world.event_times) {
    const double event = time / world.path_time;
    if (event > load + 1e-12 && event < stop - 1e-12) stop = event;
  }
  return stop;
}

/// An increment that has been learnt in the step of the scene before counts beside those asked for.
void enter_step(const World& world, State& state) {
  const Increments now = increments_at(world, state.load);
  if (state.load == 0 || now.from != state.load) return;
  const Increments before = increments_at(world, 0.5 * (state.load + state.previous_load));
  if (before.to == now.from) state.load_increment *= now.length() / before.length();
}

/// The load factor of the next attempt. What is left up to the next stop is shared equally when it takes
/// several steps; none turns a support too far.
double next_load(const World& world, const State& state) {
  double next = next_stop(world, state.load);
  const double num_steps = std::ceil((next - state.load) / state.load_increment - 1e-9);
  if (num_steps > 1) next = state.load + (next - state.load) / num_steps;
  while (true) {
    const double num_turns = std::ceil(turn_between(world, state.load, next) / largest_turn_of_step - 1e-9);
    const double nearer = state.load + (next - state.load) / num_turns;
    if (num_turns <= 1 || !(nearer > state.load)) return next;
    next = nearer;
  }
}

/// Whether contact at `candidate` still holds the bodies that it alone holds at x, about as hard. Where a
/// light one lies on a block that yields, the energy of the block would choose a start at which it has lost
/// its hold.
bool keeps_hold(const World& world, const Potential& potential, const VectorX& touch,
                const VectorX& candidate) {
  constexpr double most_change = 10;
  const VectorX there = potential.gradient_of(EnergyCategory::contact, candidate);
  return std::ranges::all_of(world.bodies, [&](const Body& body) {
    if (is_held_along_every_axis(world, body)) return true;
    const Eigen::Index first = Eigen::Index{body.first_node} * world.dimension,
                       count = Eigen::Index{body.num_nodes} * world.dimension;
    const double before = touch.segment(first, count).norm(), after = there.segment(first, count).norm();
    return before == 0 || (after * most_change >= before && after <= most_change * before);
  });
}

/// Where the search for the equilibrium at `load` starts: the secant through the last two equilibria or the
/// last one, whichever has the lower energy. The secant is left out where bodies touch and would lose their
/// hold, or have failed to find an equilibrium in this step.
VectorX predicted_positions(const World& world, Potential& potential, const VectorX& targets,
                            const State& state, double load, bool has_failed) {
  VectorX x = state.positions;
  if (state.load > state.previous_load) {
    const double ratio = (load - state.load) / (state.load - state.previous_load);
    const VectorX secant = x + ratio * (x - state.previous_positions);
    if (world.share.is_whole()) {
      const VectorX touch = potential.gradient_of(EnergyCategory::contact, x);
      const bool is_touched = !touch.isZero(0);
      if (is_touched && (has_failed || !keeps_hold(world, potential, touch, secant))) return x;
    }
    choose_lower_start(potential, world.is_fixed, targets, secant, x);
  }
  return x;
}

/// The jump in a step that has led to x at `load`, if there is one.
/// @param searched  takes the counts of searches
std::optional<Jump> jump_of_step(const World& world, Newton& newton, const State& state, const VectorX& x,
                                 double load, const NewtonObserver& observer, NewtonReport& searched) {
  // The first step starts from no equilibrium, or from one without load, where bodies may stiffen at once.
  // Where bodies creep, they lose strain energy without a jump.
  if (is_linear(world) || state.step == 0 || world.keeps_history()) return std::nullopt;
  const auto find = [&](const Equilibrium& from, double at) -> std::optional<Equilibrium> {
    const StagePlan plan = plan_increment(world, from.positions, from.load, at);
    Potential potential = Potential::in_stage(world, state, plan.conditions, plan.stage);
    Equilibrium found{.load = at, .positions = from.positions};
    const StageReport report =
        solve_stage(potential, world.is_fixed, plan.targets, {}, newton_settings(world),
                    {.friction_rounds = world.friction_iterations}, newton, found.positions, observer);
    add_counts(searched, report.newton);
    if (!report.newton.converged() || potential.conditions().delay > 0) return std::nullopt;
    return found;
  };
  return find_jump(world, {.load = state.load, .positions = state.positions}, {.load = load, .positions = x},
                   find);
}

std::string describe(const World& world, const FrictionHold::Slide& slide, double load) {
  return "friction cannot hold \"" + world.bodies[slide.body].name + "\": at load factor " +
         format_short(load) + " it slides, out of balance by " + format_short(slide.missing) + " N of the " +
         format_short(slide.applied) +
         " N that act on it; hold it, raise friction, or use a dynamic analysis " +
         "(simulation.kind = \"dynamic\")";
}

std::string describe(const Jump& jump) {
  return "between load factors " + format_short(jump.from) + " and " + format_short(jump.to) +
         " bodies jump to another equilibrium: they lose " + format_short(jump.energy) +
         " J of strain energy that no load takes up";
}

void move_to(State& state, VectorX positions, double load) {
  state.previous_positions = std::move(state.positions);
  state.previous_load = state.load;
  state.positions = std::move(positions);
  state.load = load;
  ++state.step;
}

}  // namespace

LoadControl::LoadControl(const World& world) {
  if (world.follows_path) follower_.emplace(world.dimension, world.pattern);
}

void LoadControl::prepare(const World& world, State& state) const {
  state.load_increment = asked_increment(world, 0);
  state.previous_positions = state.positions;
}

bool LoadControl::is_finished(const World& world, const State& state) {
  return state.load >= 1 || (world.follows_path && state.step >= world.max_steps);
}

int LoadControl::expected_steps(const World& world, const State& state) {
  const double num_turns = turn_between(world, state.load, 1) / largest_turn_of_step;
  const double steps_left = std::max((1 - state.load) / state.load_increment, num_turns);
  const int left = static_cast<int>(std::clamp(std::ceil(steps_left - 1e-9), 0.0, 1e9));
  return world.follows_path ? std::min(state.step + left, world.max_steps) : state.step + left;
}

StepReport LoadControl::step(const World& world, Newton& newton, State& state,
                             const NewtonObserver& observer) {
  StepReport report = follower_ ? step_along_path(world, newton, state, observer)
                                : step_in_load(world, newton, state, observer);
  if (report.status != StepReport::Status::converged) return report;
  count_unstable_modes(world, newton, state, report);
  find_inversion(world, state, report);
  return report;
}

StepReport LoadControl::step_in_load(const World& world, Newton& newton, State& state,
                                     const NewtonObserver& observer) {
  StepReport report;
  const double whole = asked_increment(world, state.load),
               smallest_any = smallest_increment(world, state.load);
  bool is_tight = false, was_held = false;
  Equilibrium near;  // from where springs have led bodies that friction holds
  while (true) {
    const double load = next_load(world, state);
    StagePlan plan = plan_increment(world, state.positions, state.load, load);
    const double load_time = plan.stage.load_time;
    // The potential has what it needs of the stage, whose vectors are given back.
    Potential potential =
        Potential::in_stage(world, state, plan.conditions, std::exchange(plan.stage, Stage{}));
    VectorX x = was_held && load == near.load ? near.positions
                                              : predicted_positions(world, potential, plan.targets, state,
                                                                    load, report.failed_attempts > 0);
    NewtonSettings settings = newton_settings(world);
    if (is_tight) settings.tolerance = std::min(settings.tolerance, tight_tolerance);
    const double length = load - state.load;
    if (length < 0.99 * whole && 0.5 * length >= smallest_any)
      settings.max_iterations = std::min(settings.max_iterations, most_iterations_of_a_shortened_step);
    StageReport searched = solve_stage(potential, world.is_fixed, plan.targets, {}, settings,
                                       {.friction_rounds = world.friction_iterations}, newton, x, observer);
    settle_patches(world, potential, plan.targets, settings, newton, x, searched, observer);
    const NewtonReport& search = searched.newton;
    add_to(report.newton, search);
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    VectorX gradient;
    potential.gradient(x, gradient);
    std::string imbalance;
    if (search.converged())
      imbalance = searched.friction_mismatch > largest_balance_error
                      ? describe_unsettled_friction(searched)
                      : describe_imbalance(world, potential, x, gradient, search, x - world.rest_positions);
    const double delay = potential.conditions().delay;
    if (search.converged() && imbalance.empty() && delay == 0) {
      const std::optional<Jump> jump = jump_of_step(world, newton, state, x, load, observer, report.newton);
      if (jump && jump->is_avoidable && 0.5 * length >= smallest_share_of_path * whole) {
        ++report.failed_attempts;  // smaller steps stay on the path that this one has left
        state.load_increment = 0.5 * length;
        continue;
      }
      if (jump && world.on_jump == OnJump::stop) {
        report.status = StepReport::Status::not_converged;
        report.reason = describe(*jump) + "; simulation.on_jump = \"follow\" goes on from there";
        return report;
      }
      if (jump) {
        report.jump_energy = jump->energy;
        report.warnings.push_back(world.place + ": " + describe(*jump));
        ++state.jumps;
        if (jump->energy > state.largest_jump) state.largest_jump_load = jump->to;
        state.largest_jump = std::max(state.largest_jump, jump->energy);
      }
      const double heat = potential.heat_of_friction(state.positions, x, load_time);
      state.friction_work += heat;
      state.dissipated_energy += heat;
      state.dissipated_energy +=
          world.share.sum(advance_history(world.terms, state.positions, x, load_time, state.history));
      report.friction.add(searched);
      move_to(state, std::move(x), load);
      state.time = plan.conditions.time;
      if (search.iterations < quick_convergence)
        state.load_increment = std::min(load_growth * state.load_increment, whole);
      enter_step(world, state);
      return report;
    }
    ++report.failed_attempts;
    state.load_increment = 0.5 * (load - state.load);
    // Smaller steps give no digits, unless surfaces that came too near on the way have taken them.
    const bool is_out_of_digits = search.status == NewtonReport::Status::out_of_digits &&
                                  report.failed_attempts > most_attempts_without_digits;
    const bool has_path = !world.friction && world.path_time == 0;  // arc length can follow it
    if (state.load_increment < smallest_any && !is_tight && !is_out_of_digits &&
        settings.tolerance > tight_tolerance) {
      is_tight = true;
      state.load_increment = whole;
      continue;
    }
    const double smallest = is_tight ? smallest_tight_share * whole : smallest_any;
    if (state.load_increment < smallest || is_out_of_digits) {
      const double stop = next_stop(world, state.load);
      const std::optional<FrictionHold> hold =
          was_held ? std::nullopt : hold_by_friction(world, newton, state, stop, observer, report.newton);
      if (hold && !hold->slide) {
        near = {.load = stop, .positions = hold->positions};
        was_held = true;
        is_tight = false;
        state.load_increment = stop - state.load;
        continue;
      }
      report.status = StepReport::Status::not_converged;
      if (hold) {
        report.reason = "no equilibrium was found beyond load factor " + format_number(state.load) + ": " +
                        describe(world, *hold->slide, stop);
        return report;
      }
      report.reason =
          "no equilibrium was found beyond load factor " + format_number(state.load) + ": " +
          (delay > 0 ? "bodies block a moving collider; " : "") +
          (imbalance.empty() ? describe_failure(world, search, x) : imbalance) +
          (is_out_of_digits ? ""
           : has_path       ? "; if the body snaps through here, use simulation.load_control = \"arc_length\""
                      : "; if bodies snap through here, use a damped dynamic analysis (simulation.kind = "
                        "\"dynamic\")");
      return report;
    }
  }
}

void LoadControl::find_inversion(const World& world, const State& state, StepReport& report) {
  if (!is_linear(world)) return;
  report.inversion = first_inversion(world, state.positions, state.load);
  const bool is_first_frame = state.previous_load == 0;
  if (!report.inversion || report.inversion->load > 1 || !is_first_frame) return;
  report.warnings.push_back(
      describe(world, *report.inversion) +
      ", within the load asked for: linear elasticity is meant for small displacements; "
      "choose a law for large ones, such as \"neo_hookean\"");
}

void LoadControl::count_unstable_modes(const World& world, const Newton& newton, const State& state,
                                       StepReport& report) {
  Potential potential = Potential::in_stage(world, state, world.at_load(state.load), stage_of(world, state));
  potential.form_lag(state.positions);
  // Without a potential the eigenvalues of the symmetric part say nothing of stability.
  // A factorisation of the whole scene is none that several processes share.
  if (world.unstable_modes == UnstableModes::skip || !world.share.is_whole() ||
      !potential.has_potential(state.positions))
    return;
  if (world.unstable_modes == UnstableModes::automatic && world.num_free_unknowns() > most_unknowns_counted &&
      !follower_) {
    // A Cholesky factorisation of the last step's exact matrix has shown that there are none.
    if (newton.solver_is_direct() && report.newton.last_step_was_exact) report.unstable_modes = 0;
  } else {
    if (!stiffness_) stiffness_.emplace(world.dimension, world.pattern);
    const LinearReport linear = stiffness_->factorize(potential, world.is_fixed, state.positions);
    if (linear.status == LinearReport::Status::ok) report.unstable_modes = linear.negative_pivots;
    // The equilibrium stands without the count, unless it was asked for.
    if (world.unstable_modes == UnstableModes::count) require_memory(linear);
    if (linear.status == LinearReport::Status::out_of_memory && !std::exchange(has_warned_of_memory_, true))
      report.warnings.push_back("unstable modes are not counted: " + linear.shortage);
  }
  const Index count = report.unstable_modes.value_or(0);
  if (count > 0 && count != last_count_.value_or(0)) {
    report.warnings.push_back("at load factor " + format_short(state.load) +
                              " the equilibrium is unstable: " + std::to_string(count) + " unstable mode" +
                              (count == 1 ? "" : "s") + " (buckling)");
  }
  last_count_ = report.unstable_modes;
}

}  // namespace resilin
