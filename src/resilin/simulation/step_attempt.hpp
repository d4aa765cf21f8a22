#pragma once

#include <optional>
#include <string>

#include "resilin/integrator/stage_sequence.hpp"
#include "resilin/simulation/time_stepping.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A reason why a step that was tried is not good enough.
enum class Flaw {
  not_found,           ///< a search found no minimum
  cut_short,           ///< the same, only because newton.max_iterations is low on purpose
  out_of_balance,      ///< forces at a minimum do not balance
  unsettled_friction,  ///< forces do not balance the friction of where a search ended
  blocked,             ///< bodies block a moving collider
  leaves_domain,       ///< the scheme of the scene leads to where the energy is infinite
};

/// Ways that may lead to a step without a flaw.
struct Remedies {
  bool shorter_step = false;  ///< where steps adapt
  bool parts = false;         ///< the same length in parts, where steps are equal
  /// The same step by backward Euler. Near contact other schemes turn velocities around far from any
  /// collider; not on a way that began in flight.
  bool backward_euler = false;
};

/// A step in time that has been tried and not yet been made.
struct TimeStepper::Attempt {
  StepReport report{};
  const Integrator* scheme = nullptr;     ///< integrator of the step
  std::optional<StageSequence> stages{};  ///< once it has begun
  Remedies remedies{};                    ///< remedies of all its flaws
  Motion end{};
  VectorX gradient{};
  double collider_delay = 0;  ///< [s]
  Stage last_stage{};
  double friction_work = 0;         ///< [J]
  VectorX history{};                ///< internal variables at the end, as in State
  double history_heat = 0;          ///< heat of the terms with internal variables [J]
  bool touches = false;             ///< contact acts, or would if the step had been found
  VectorX contact_accelerations{};  ///< at the end, where they are wanted; empty: none [m/s^2]
  VectorX slowing{};                ///< slowing of the velocities, lest the step add energy; empty: none
  double energy_excess = 0, largest_kinetic_energy = 0;  ///< as in State

  /// Notes a flaw: from then on the step has not converged, for this reason.
  /// @param began_in_flight  the search that has it
  void add(Flaw flaw, std::string reason, bool began_in_flight = false);
  bool converged() const { return report.status == StepReport::Status::converged; }
  bool is_interrupted() const { return report.status == StepReport::Status::interrupted; }
  bool is_guarded() const { return report.by_backward_euler || report.removed_energy > 0; }
  /// Whether the step adds no energy; takes out of its velocities what it does, within bodies or, as the last
  /// resort, wherever it is.
  /// @param round_off  [J]
  bool keeps_energy(const World& world, const State& start, double time_step, double round_off,
                    bool is_last_resort);
  /// @param time  at the end [s]
  void move(const World& world, State& state, double time_step, double time) &&;
};

/// State at the start of a step.
History history_of(const State& state);

}  // namespace resilin
