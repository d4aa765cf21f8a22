#include "resilin/simulation/frame.hpp"

#include "resilin/mesh/facet.hpp"

namespace resilin {

Frame measure_frame(const World& world, const State& state, const VectorX* step_gradient) {
  const int dim = world.dimension;
  const Conditions conditions{.time = state.time, .load = state.load, .collider_delay = state.collider_delay};
  Frame frame;
  frame.step = state.step;
  frame.time = state.time;
  frame.load = state.load;

  VectorX momentum;
  world.mass.multiply(state.velocities, momentum);
  frame.kinetic_energy = 0.5 * momentum.dot(state.velocities);
  for (Index i = 0; i < world.num_nodes(); ++i) {
    const Vector3 p = node_position(dim, i, momentum);
    frame.linear_momentum += p;
    frame.angular_momentum += node_position(dim, i, state.positions).cross(p);
  }
  for (const auto& energy : world.elastic) frame.elastic_energy += energy->value(state.positions, conditions);
  for (const auto& energy : world.external)
    frame.external_energy += energy->value(state.positions, conditions);
  for (const auto& collider : world.colliders)
    frame.contact_energy += collider->value(state.positions, conditions);

  frame.min_volume_ratio = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const auto [ratio, cell] = world.bodies[b].elastic->min_volume_ratio(state.positions);
    if (ratio < frame.min_volume_ratio) {
      frame.min_volume_ratio = ratio;
      frame.worst_cell = cell;
      frame.worst_body = static_cast<int>(b);
    }
  }
  for (const Probe& probe : world.probes) {
    frame.probes.push_back({.name = probe.name,
                            .displacement = node_position(dim, probe.node, state.positions) -
                                            node_position(dim, probe.node, world.rest_positions),
                            .velocity = node_position(dim, probe.node, state.velocities)});
  }

  for (const Section& section : world.sections) frame.sections.push_back(section.measure(state.positions));

  VectorX gradient;
  if (step_gradient == nullptr) {
    gradient = VectorX::Zero(state.positions.size());
    for (const auto& energy : world.elastic) energy->add_gradient(state.positions, conditions, gradient);
    for (const auto& energy : world.external) energy->add_gradient(state.positions, conditions, gradient);
    for (const auto& collider : world.colliders)
      collider->add_gradient(state.positions, conditions, gradient);
    step_gradient = &gradient;
  }
  for (const Support& support : world.supports) frame.reactions.emplace_back(support.name, Vector3::Zero());
  frame.reaction_torques.assign(world.supports.size(), Vector3::Zero());
  for (std::size_t i = 0; i < world.support_of.size(); ++i) {
    if (world.support_of[i] < 0) continue;
    const auto support = static_cast<std::size_t>(world.support_of[i]);
    const auto node = static_cast<Index>(i / static_cast<std::size_t>(dim));
    Vector3 force = Vector3::Zero();
    force[static_cast<int>(i % static_cast<std::size_t>(dim))] =
        (*step_gradient)[static_cast<Eigen::Index>(i)];
    frame.reactions[support].second += force;
    frame.reaction_torques[support] += node_position(dim, node, state.positions).cross(force);
  }
  for (const auto& collider : world.colliders) {
    const auto [force, torque] = collider->reaction(state.positions, conditions);
    frame.reactions.emplace_back(collider->name(), force);
    frame.reaction_torques.push_back(torque);
  }
  return frame;
}

}  // namespace resilin
