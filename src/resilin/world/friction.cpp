#include "resilin/world/friction.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

constexpr double friction_speed_share = 1e-3;  ///< [1/s]
constexpr double largest_plausible_friction = 10;

}  // namespace

void check_friction(double coefficient, const std::string& place, World& world) {
  if (!(coefficient >= 0 && std::isfinite(coefficient)))
    throw InputError(place, "a finite number >= 0", format_number(coefficient));
  if (coefficient > largest_plausible_friction)
    world.warnings.push_back(place + ": a coefficient of " + format_short(coefficient) +
                             " is larger than for any real materials; rubber on concrete has about 1");
}

std::shared_ptr<const Friction> make_friction(const ContactDescription& description, World& world) {
  std::vector<std::shared_ptr<const FrictionSource>> sources;
  std::vector<TimeFunction> factors;
  for (const auto& collider : world.colliders)
    if (collider->friction() > 0) sources.push_back(collider);
  for (const auto& collider : world.mesh_colliders)
    if (collider->has_friction()) sources.push_back(collider);
  if (world.contact && world.contact->has_friction()) sources.push_back(world.contact);
  const double speed = description.friction_speed.value_or(default_friction_speed(world));
  require_positive(speed, description.place + ".friction_speed");
  if (description.friction_iterations < 0)
    throw InputError(description.place + ".friction_iterations", "a whole number >= 0",
                     std::to_string(description.friction_iterations));
  world.friction_iterations = description.friction_iterations;
  if (sources.empty()) return nullptr;
  if (world.follows_path)
    throw InputError(world.place + ": simulation.load_control", "\"load\" where there is friction",
                     "\"arc_length\"",
                     "friction depends on the history of the bodies, which arc length does not have");
  for (const auto& source : sources) {
    const auto found = world.friction_factors.find(std::string(source->name_in_reports()));
    factors.push_back(found == world.friction_factors.end() ? TimeFunction{} : found->second);
  }
  return std::make_shared<Friction>(world.dimension, std::move(sources), speed, std::move(factors));
}

std::shared_ptr<CableFriction> make_cable_friction(const CableDescription& description,
                                                   const std::shared_ptr<const Cable>& cable,
                                                   const ContactDescription& contact, World& world) {
  check_friction(description.friction, description.place + ".friction", world);
  if (description.friction == 0) return nullptr;
  if (description.points.size() < 3)
    throw InputError(description.place + ".friction", "a cable with guides between its ends", "two points",
                     "name points between them, or leave friction out");
  const double speed = contact.friction_speed.value_or(default_friction_speed(world));
  require_positive(speed, contact.place + ".friction_speed");
  return std::make_shared<CableFriction>(cable, description.friction, speed);
}

double default_friction_speed(const World& world) { return friction_speed_share * smallest_extent(world); }

Stage stage_of(const World& world, const State& state) {
  if (world.is_dynamic) {  // v = (x - x_0) / c for any c
    return {.base_positions = state.positions - state.velocities,
            .base_velocities = state.velocities,
            .duration = 1,
            .shape = state.positions};
  }
  const bool knows_way = state.previous_positions.size() == state.positions.size();
  Stage stage = static_stage(knows_way ? state.previous_positions : state.positions);
  if (knows_way) stage.load_time = world.end_time * std::max(0.0, state.load - state.previous_load);
  stage.shape = state.positions;
  return stage;
}

std::unique_ptr<const LaggedFriction> friction_of(const World& world, const State& state) {
  const Stage stage = stage_of(world, state);
  if (!world.friction || !(stage.time_of_slip() > 0)) return nullptr;
  auto friction = std::make_unique<LaggedFriction>(*world.friction, stage);
  friction->form_lag(state.positions, conditions_of(state));
  return friction;
}

void add_friction_forces(const World& world, const State& state, VectorX& gradient) {
  const Conditions c = conditions_of(state);
  if (const auto friction = friction_of(world, state)) friction->add_gradient(state.positions, c, gradient);
  for (const auto& cable : world.cable_frictions) {
    const std::unique_ptr<Energy> friction = cable ? cable->begin_stage(stage_of(world, state)) : nullptr;
    if (!friction) continue;
    friction->lagged_term()->form_lag(state.positions, c);
    friction->add_gradient(state.positions, c, gradient);
  }
}

std::vector<double> cable_tensions(const World& world, const State& state, std::size_t cable) {
  const Conditions c = conditions_of(state);
  const Stage stage = stage_of(world, state);
  if (world.cable_frictions[cable] && stage.time_of_slip() > 0)
    return LaggedCableFriction(*world.cable_frictions[cable], stage).tensions(state.positions, c);
  const Cable& of = *world.cables[cable];
  return std::vector<double>(of.path().num_pieces(), of.force(state.positions, c));
}

}  // namespace resilin
