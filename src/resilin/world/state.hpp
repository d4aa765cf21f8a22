#pragma once

#include <string>
#include <string_view>

#include "resilin/core/members.hpp"
#include "resilin/core/types.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// Everything that a step reads and changes. Equal states give equal steps, bit by bit. A new member belongs
/// into the list below, without which this does not compile; from the list follow checkpoints, their check
/// and the parts of a distributed state.
struct State {
  int step = 0;
  int mode = 0;        ///< mode of free vibrations: which one is shown, from 1; 0: none yet
  double time = 0;     ///< [s]
  double load = 0;     ///< load factor of a static run; 1 in motion
  VectorX positions;   ///< [m]
  VectorX velocities;  ///< [m/s]; zero in statics

  VectorX previous_positions;  ///< one step before; of free vibrations, the equilibrium [m]

  // Static load control: what the next increment is and where its guess is extrapolated from.
  double load_increment = 1;
  double previous_load = 0;
  double arc_length = 0;   ///< [m] of the next step along a path of equilibria
  double load_weight = 0;  ///< [m]: how far a unit of load counts in it; 0 before the first step

  int jumps = 0;                 ///< to other equilibria ...
  double largest_jump = 0;       ///< ... in which so much strain energy was lost at most [J] ...
  double largest_jump_load = 0;  ///< ... before this load factor

  double friction_work = 0;      ///< heat by friction, since the start [J]
  int unsettled_steps = 0;       ///< steps whose forces did not balance the friction of their end ...
  double friction_mismatch = 0;  ///< ... by so much at most, beside the forces that act

  // Motion: what integrators need besides.
  VectorX accelerations;              ///< but those by contact [m/s^2]; empty: not known yet
  VectorX previous_velocities;        ///< one step before [m/s]
  double previous_time_step = 0;      ///< length of that step [s]; 0: there was none
  double time_step = 0;               ///< length of the next step, where steps adapt [s]
  double dissipated_energy = 0;       ///< by damping, friction, viscoelasticity [J]
  double collider_delay = 0;          ///< how far moving colliders are behind; bodies were in their way [s]
  double energy_excess = 0;           ///< how far the energy, less work done, has risen: see TimeStepper [J]
  double largest_kinetic_energy = 0;  ///< so far [J]
  int guarded_steps = 0;              ///< steps that would have added energy, and were changed
  double removed_energy = 0;          ///< from the velocities of these [J]
  int divided_steps = 0;              ///< taken in parts, for none of the whole length was found

  int phase = 0;  ///< phase of supports (support_phase.hpp)
  VectorX
      released_forces{};  ///< statics: of supports, where a step has begun to release them; empty: none [N]
  VectorX support_places{};  ///< where supports move their nodes from; empty: rest positions [m]

  VectorX history{};  ///< internal variables of the terms, one term after another (HistoryTerm)
};
RESILIN_MEMBERS(State, step, mode, time, load, positions, velocities, previous_positions, load_increment,
                previous_load, arc_length, load_weight, jumps, largest_jump, largest_jump_load, friction_work,
                unsettled_steps, friction_mismatch, accelerations, previous_velocities, previous_time_step,
                time_step, dissipated_energy, collider_delay, energy_excess, largest_kinetic_energy,
                guarded_steps, removed_energy, divided_steps, phase, released_forces, support_places, history)

/// Under which its forces are taken.
inline Conditions conditions_of(const State& state) {
  return {.time = state.time, .load = state.load, .delay = state.collider_delay};
}

/// The same `duration` [s] later, in motion.
inline Conditions conditions_after(const State& state, double duration, double collider_delay = 0) {
  return {.time = state.time + duration, .load = state.load, .delay = collider_delay};
}

/// Exact binary image of a state, for checkpoints.
std::string serialize(const State& state);

/// The state of an image. Throws InputError naming `place` when it is damaged or of another version.
State deserialize_state(std::string_view image, const std::string& place);

/// Throws InputError naming `place` and the member unless a step can begin at the state: its vectors have
/// `num_unknowns` entries (or none, where that has a meaning), its history `num_history_values`, all numbers
/// are finite, times and counters are not negative.
void check_state(const State& state, Eigen::Index num_unknowns, Eigen::Index num_history_values,
                 const std::string& place);

}  // namespace resilin
