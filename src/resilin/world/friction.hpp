#pragma once

#include <memory>
#include <string>

#include "resilin/contact/friction.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Throws InputError at `place` for a coefficient of friction that is none; adds a warning for one that is
/// beyond all materials.
void check_friction(double coefficient, const std::string& place, World& world);

/// The friction of a cable at its guides; null without any.
std::shared_ptr<CableFriction> make_cable_friction(const CableDescription& description,
                                                   const std::shared_ptr<const Cable>& cable,
                                                   const ContactDescription& contact, World& world);

/// Below which contacts stick: a thousandth of the largest extent of the smallest body in a second [m/s].
double default_friction_speed(const World& world);

/// The friction of all colliders, and of the bodies on each other, that have some; null where none has.
/// Throws InputError where the path of equilibria is followed.
std::shared_ptr<const Friction> make_friction(const ContactDescription& description, World& world);

/// The stage that a state is the end of: its velocities, or in statics the way from the equilibrium before,
/// are what lets things slip there.
Stage stage_of(const World& world, const State& state);

/// The friction of a state, by its own normal forces; null where there is none, and for a static state that
/// does not know the one before. It must not outlive the world.
std::unique_ptr<const LaggedFriction> friction_of(const World& world, const State& state);

/// Adds dE/dx of all friction of a state, likewise [N].
void add_friction_forces(const World& world, const State& state, VectorX& gradient);

/// Tension of each piece of a cable in a state, by its number [N].
std::vector<double> cable_tensions(const World& world, const State& state, std::size_t cable);

}  // namespace resilin
