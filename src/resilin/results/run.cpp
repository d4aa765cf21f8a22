#include "resilin/results/run.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "resilin/core/log.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/narrow_contact.hpp"
#include "resilin/simulation/oddities.hpp"
#include "resilin/simulation/space_error.hpp"

namespace resilin {

std::string reached(const Simulation& simulation) {
  const State& state = simulation.state();
  if (simulation.world().is_dynamic)
    return "t = " + format_short(state.time) + " s (step " + std::to_string(state.step) + ")";
  if (const std::optional<Frame::ModeValues>& mode = simulation.frame().mode; mode && state.mode > 0)
    return "mode " + std::to_string(mode->number) + " (" + format_short(mode->frequency) + " Hz)";
  return "load factor " + format_short(state.load) + " (step " + std::to_string(state.step) + ")";
}

namespace {

/// Remarks on how far a run got and how it went. Unphysical results have their own lines
/// (oddities.hpp); of that only the number of cells inside out is named.
std::string remarks(const Simulation& simulation) {
  std::string text;
  const World& world = simulation.world();
  if (is_linear(world)) text += "; the problem is linear";
  if (const std::optional<Inversion>& inversion = simulation.frame().inversion)
    text += "; " + describe(world, *inversion);
  if (const Index inverted = num_inverted_cells(world, simulation.state()); inverted > 0)
    text += "; " + std::to_string(inverted) + (inverted == 1 ? " inverted element" : " inverted elements");
  if (const int jumps = simulation.state().jumps; jumps > 0)
    text += "; bodies jumped to another equilibrium" +
            (jumps == 1 ? std::string() : " " + std::to_string(jumps) + " times");
  if (world.follows_path && simulation.state().load < 1)
    text += "; the path ends there because of simulation.max_steps";
  if (const Index count = simulation.frame().unstable_modes.value_or(0); count > 0) {
    text += "; the equilibrium is unstable: " + std::to_string(count) +
            (count == 1 ? " unstable mode" : " unstable modes");
  }
  return text;
}

/// Remark on corrections that keep steps from adding energy.
std::string guarding_remark(const State& state) {
  if (state.guarded_steps == 0) return "";
  return "; " + std::to_string(state.guarded_steps) + (state.guarded_steps == 1 ? " step" : " steps") +
         " would have added energy, or stopped early in contact: they were repeated with backward_euler, "
         "or " +
         format_short(state.removed_energy) +
         " J in all were removed from the velocities; a shorter time_step is more accurate";
}

/// Remark on steps that were divided because no whole one was found.
std::string division_remark(const State& state) {
  if (state.divided_steps == 0) return "";
  return "; " + std::to_string(state.divided_steps) +
         (state.divided_steps == 1 ? " step was" : " steps were") +
         " divided into shorter ones (time-step cutback)";
}

/// Remark on friction that did not converge.
std::string friction_remark(const State& state) {
  if (state.unsettled_steps == 0) return "";
  return "; friction did not converge in " + std::to_string(state.unsettled_steps) +
         (state.unsettled_steps == 1 ? " step" : " steps") + ", where at most " +
         format_short(state.friction_mismatch) + " of the forces were unbalanced";
}

/// On a run that has reached its end.
RunOutcome verdict(const Simulation& simulation) {
  const FailedSteps& failed = simulation.failed_steps();
  if (failed.count == 0)
    return {RunStatus::done, "reached " + reached(simulation) + ", every step converged" +
                                 remarks(simulation) + friction_remark(simulation.state()) +
                                 division_remark(simulation.state()) + guarding_remark(simulation.state())};
  return {RunStatus::not_converged,
          std::to_string(failed.count) + " of " + std::to_string(simulation.state().step) +
              " steps did not converge; the first at t = " + format_short(failed.first_time) + " s (step " +
              std::to_string(failed.first_step) + "): " + failed.first_reason +
              friction_remark(simulation.state()) + division_remark(simulation.state()) +
              guarding_remark(simulation.state())};
}

/// Steps that find no solution one after the other will not find one later: a body has burst or collapsed.
bool gives_up(const Simulation& simulation) {
  const int most = simulation.world().newton.max_failures;
  return most > 0 && simulation.failed_steps().in_a_row >= most && !simulation.is_finished();
}

std::string describe_giving_up(const Simulation& simulation, const StepReport& last) {
  const FailedSteps& failed = simulation.failed_steps();
  return "ended at " + reached(simulation) + ": for " + std::to_string(failed.in_a_row) +
         " steps in a row did not converge, the last " + format_short(last.time_step) +
         " s long: " + last.reason + "; unless a body bursts or collapses, a smaller " +
         (simulation.world().adaptive ? "simulation.adaptive.min_step" : "simulation.time_step") +
         " helps; newton.max_failures = 0 continues regardless";
}

/// The state that tells how much the cells' size matters: in statics the last one, in motion that of the most
/// strain energy, or that at rest where nothing was strained.
const VectorX& telling_positions(const Simulation& simulation) {
  if (!simulation.world().is_dynamic) return simulation.state().positions;
  const VectorX& positions = simulation.most_strained().positions;
  return positions.size() == 0 ? simulation.world().rest_positions : positions;
}

/// Whether boundary conditions prescribe every node of a body.
bool is_wholly_prescribed(const World& world, const Body& body) {
  const auto first = world.is_fixed.begin() + static_cast<std::ptrdiff_t>(body.first_node) * world.dimension;
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(body.num_nodes) * world.dimension;
  return std::all_of(first, first + count, [](std::uint8_t is_fixed) { return is_fixed != 0; });
}

/// Estimates by a step into a richer space, where there is one, else by recovered stress.
DiscretisationErrors estimated_errors(const Simulation& simulation, const std::optional<SpaceError>& space) {
  const World& world = simulation.world();
  const VectorX& x = telling_positions(simulation);
  DiscretisationErrors errors;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const std::optional<SpaceError::Change> more = space ? space->changes[b] : std::nullopt;
    const std::optional<double> norm = more ? squared_solution_norm(body, x) : std::nullopt;
    std::optional<double> share =
        !more  ? error_by_recovered_stress(world, body, x)
        : norm ? std::optional(share_missing(more->total() / *norm, space->is_driven_by_displacements))
               : std::nullopt;
    // The further functions of one cell are too few for a twist: a small number there would be a false one. A
    // strain that does not vary has no error at all.
    constexpr double least_error = 1e-6;
    if (more && share && *share > least_error && *share <= large_discretisation_error &&
        is_wholly_prescribed(world, body) && is_one_cell_across(body))
      share = cannot_tell;
    const ErrorEstimate estimate = more ? ErrorEstimate::richer_space : ErrorEstimate::recovered_stress;
    errors.push_back(share ? std::optional(DiscretisationError{*share, estimate}) : std::nullopt);
  }
  return errors;
}

/// Estimate of a run and the time that it took.
struct TimedEstimate {
  std::optional<SpaceError> space{};
  double seconds = 0;
  std::vector<SupportStiffness> stiffness{};

  /// Calls `estimate` and adds its time.
  void measure(const auto& estimate) {
    const auto start = std::chrono::steady_clock::now();
    estimate();
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
};

/// @param timed  made where a static run reaches its end
RunOutcome step_to_end(Simulation& simulation, const RunHooks& hooks, TimedEstimate& timed) {
  const auto is_stopped = [&hooks] { return hooks.is_stopped && hooks.is_stopped(); };
  const auto stopped = [&]() -> RunOutcome {
    return {RunStatus::budget, "stopped by " + (hooks.stopper ? hooks.stopper() : std::string("the user")) +
                                   " at " + reached(simulation)};
  };
  const NewtonObserver observer = [&](const NewtonReport& so_far) {
    if (hooks.after_iteration) hooks.after_iteration(so_far);
    return !is_stopped();
  };
  const bool had_ended = simulation.is_finished();
  for (int steps = 0; !simulation.is_finished(); ++steps) {
    if (is_stopped()) return stopped();
    if (hooks.max_steps > 0 && steps == hooks.max_steps) {
      return {RunStatus::budget,
              "stopped after " + std::to_string(steps) + " steps as asked, at " + reached(simulation)};
    }
    const int step_before = simulation.state().step;
    const StepReport report = simulation.step(observer);
    if (report.status == StepReport::Status::interrupted) return stopped();
    for (const std::string& warning : report.warnings) log_warning(warning);
    if (report.status == StepReport::Status::not_converged) {
      log_warning(reached(simulation) + ": " + report.reason);
      if (!simulation.world().is_dynamic || simulation.state().step == step_before)
        return {RunStatus::not_converged, report.reason};
    }
    if (simulation.is_finished()) {
      timed.measure([&] { timed.space = space_error(simulation); });
      timed.stiffness = support_stiffness(simulation);
      simulation.release_solver();  // fields of the frame take as much memory
    }
    if (hooks.after_step) hooks.after_step(report);
    if (gives_up(simulation)) return {RunStatus::not_converged, describe_giving_up(simulation, report)};
  }
  RunOutcome outcome = verdict(simulation);
  if (had_ended) {
    outcome.reason += "; the run had ended before";
    timed.measure([&] { timed.space = space_error(simulation); });
    timed.stiffness = support_stiffness(simulation);
  }
  return outcome;
}

/// Tells of bodies that have left the equilibrium in which the loads had led them; empty where none has.
std::string jumps_on_the_way(const State& state) {
  if (state.jumps == 0) return {};
  return "bodies jumped to another equilibrium" +
         (state.jumps == 1 ? std::string() : " " + std::to_string(state.jumps) + " times, most") +
         " before load factor " + format_short(state.largest_jump_load) + ", and lost " +
         format_short(state.largest_jump) +
         " J of strain energy that no load took up: the final state may not be the intended one; "
         "simulation.on_jump = \"stop\" ends before it";
}

/// Tells of cells that were inside out at the end of a step and are not any more; empty where there were
/// none.
std::string inversion_on_the_way(const Simulation& simulation) {
  const World& world = simulation.world();
  const SmallestVolume& smallest = simulation.most_strained().smallest_volume;
  if (!(smallest.ratio <= 0) || num_inverted_cells(world, simulation.state()) > 0) return {};
  const Body& body = world.bodies[static_cast<std::size_t>(smallest.body)];
  return "elements were inverted during the run, cell " + std::to_string(smallest.cell) + " of \"" +
         body.name + "\" most, with volume ratio " + format_short(smallest.ratio) + " at " +
         (world.is_dynamic ? "t = " + format_short(smallest.time) + " s"
                           : "load factor " + format_short(smallest.load)) +
         ": this is unphysical, but " +
         (world.share.is_whole() ? body.domains.of_cell(smallest.cell).law : body.domains.laws()) +
         " permits it; use a law that needs J > 0, such as neo_hookean, or shorter steps";
}

}  // namespace

RunOutcome run_to_end(Simulation& simulation, const RunHooks& hooks) {
  const World& world = simulation.world();
  TimedEstimate timed;
  RunOutcome outcome = step_to_end(simulation, hooks, timed);
  outcome.stiffness = std::move(timed.stiffness);
  outcome.warnings = oddities(world, simulation.state());
  if (std::string text = jumps_on_the_way(simulation.state()); !text.empty())
    outcome.warnings.push_back(world.place + ": " + std::move(text));
  if (std::string text = inversion_on_the_way(simulation); !text.empty())
    outcome.warnings.push_back(world.place + ": " + std::move(text));
  if (world.modes || !world.share.is_whole()) return outcome;  // the estimate needs whole bodies
  simulation.release_solver();                                 // so does the estimate below
  timed.measure([&] { outcome.discretisation_errors = estimated_errors(simulation, timed.space); });
  outcome.estimate_seconds = timed.seconds;
  for (const std::string& text : coarseness_texts(world, outcome.discretisation_errors))
    outcome.warnings.push_back(world.place + ": " + text);
  if (!world.is_dynamic)
    for (const std::string& text : narrow_contact_texts(world, simulation.state()))
      outcome.warnings.push_back(world.place + ": " + text);
  return outcome;
}

}  // namespace resilin
