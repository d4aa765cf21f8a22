#include "resilin/simulation/frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resilin/core/dense.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/rigid_fit.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/support_phase.hpp"

namespace resilin {
namespace {

/// Moments and places from the world's coordinates into those of the scene. Potential energies stay: theirs
/// is an origin of choice, and a far one would cost their digits.
void move_to_scene_coordinates(const Vector3& origin, Frame& frame) {
  frame.angular_momentum += origin.cross(frame.linear_momentum);
  for (std::size_t i = 0; i < frame.reactions.size(); ++i)
    frame.reaction_torques[i] += origin.cross(frame.reactions[i].second);
  for (SectionForce& section : frame.sections) section.center += origin;
  for (Frame::RigidMotion& body : frame.rigid_bodies) body.position += origin;
}

/// To the force of a collider.
void add_to_reaction(const World& world, std::string_view name, const FrictionContacts::Entry& entry,
                     const Vector3& force, const VectorX& x, Frame& frame) {
  const auto found = std::ranges::find(frame.reactions, name, &std::pair<std::string, Vector3>::first);
  const auto number = static_cast<std::size_t>(found - frame.reactions.begin());
  for (const auto& [node, weight] : entry.nodes) {
    frame.reactions[number].second += weight * force;
    frame.reaction_torques[number] += node_position(world.dimension, node, x).cross(weight * force);
  }
}

/// To the force of one body on another.
void add_to_contact(const World& world, const FrictionContacts::Entry& entry, const Vector3& force,
                    Frame& frame) {
  std::map<const Body*, double> parts;
  for (const auto& [node, weight] : entry.nodes) parts[&world.body_of(node)] += weight;
  for (SurfaceContact::BodyContact& contact : frame.contacts) {
    const auto part = parts.find(&world.bodies[static_cast<std::size_t>(contact.other)]);
    const bool is_theirs = parts.contains(&world.bodies[static_cast<std::size_t>(contact.body)]);
    if (is_theirs && part != parts.end() && contact.body != contact.other)
      contact.force += part->second * force;
  }
}

void add_friction(const World& world, const LaggedFriction& friction, const VectorX& x, Frame& frame) {
  friction.for_each_force(x, [&](const FrictionContacts::Entry& entry, const Vector3& force) {
    const std::string_view name = world.friction->sources()[entry.source]->name_in_reports();
    name.empty() ? add_to_contact(world, entry, force, frame)
                 : add_to_reaction(world, name, entry, force, x, frame);
  });
}

/// The worst cell of all processes, by its number in the whole scene; the first of them where several are
/// alike.
void find_worst_of_all(const World& world, Frame& frame) {
  if (world.share.is_whole()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const bool is_number = !std::isnan(frame.min_volume_ratio);
  const bool are_numbers = world.share.all(is_number);
  const double least = world.share.smallest(is_number ? frame.min_volume_ratio : infinity);
  const bool has_worst =
      frame.worst_cell >= 0 && (are_numbers ? frame.min_volume_ratio == least : !is_number);
  frame.min_volume_ratio = are_numbers ? least : std::numeric_limits<double>::quiet_NaN();
  const double body = world.share.smallest(has_worst ? frame.worst_body : infinity);
  const bool is_here = has_worst && frame.worst_body == body;
  const double cell = world.share.smallest(
      is_here ? world.cell_number(static_cast<std::size_t>(frame.worst_body), frame.worst_cell) : infinity);
  frame.worst_body = static_cast<int>(body);
  frame.worst_cell = static_cast<Index>(cell);
}

Frame::RigidMotion rigid_motion(const World& world, const Body& body, const State& state) {
  const int dim = world.dimension;
  const RigidShape& shape = *body.rigid;
  const auto centre = [&](const VectorX& values) {
    Vector3 sum = Vector3::Zero();
    for (Eigen::Index a = 0; a < shape.centre_shares.size(); ++a)
      sum += shape.centre_shares[a] * node_position(dim, body.first_node + static_cast<Index>(a), values);
    return sum;
  };
  const auto edges = [&](const VectorX& values, double beyond) {
    Eigen::MatrixXd E = beyond * Eigen::MatrixXd::Identity(3, 3);
    const Vector3 first = node_position(dim, body.first_node, values);
    for (int k = 0; k < dim; ++k) E.col(k) = node_position(dim, body.first_node + k + 1, values) - first;
    return E;
  };
  const Eigen::MatrixXd inverse = dense::inverse(edges(world.rest_positions, 1));
  const Eigen::MatrixXd F = edges(state.positions, 1) * inverse;
  const Matrix<3> R = nearest_rotation(F);
  Frame::RigidMotion motion{.name = body.name, .position = centre(state.positions)};
  const Eigen::Quaterniond q(R);
  const double sign = q.w() < 0 ? -1 : 1;
  motion.rotation = {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
  if (!world.is_dynamic) return motion;
  motion.velocity = centre(state.velocities);
  const Eigen::MatrixXd W = edges(state.velocities, 0) * inverse * dense::inverse(F);
  motion.angular_velocity = 0.5 * Vector3(W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1));
  return motion;
}

}  // namespace

Frame measure_frame(const World& world, const State& state, const VectorX* step_gradient) {
  const int dim = world.dimension;
  const Conditions conditions = conditions_of(state);
  Frame frame;
  frame.step = state.step;
  frame.step_name = step_name_at(world, state.time);
  frame.time = state.time;
  frame.load = state.load;
  frame.dissipated_energy = state.dissipated_energy;
  frame.friction_work = state.friction_work;

  VectorX momentum;
  world.mass->multiply(state.velocities, momentum);
  frame.kinetic_energy = world.share.sum(0.5 * momentum.dot(state.velocities));
  for (Index i = 0; i < world.num_nodes(); ++i) {
    const Vector3 p = node_position(dim, i, momentum);
    frame.linear_momentum += p;
    frame.angular_momentum += node_position(dim, i, state.positions).cross(p);
  }
  frame.linear_momentum = world.share.sum(frame.linear_momentum);
  frame.angular_momentum = world.share.sum(frame.angular_momentum);
  const Potential potential = Potential::at(world, state);
  frame.elastic_energy = potential.energy(EnergyCategory::elastic, state.positions);
  frame.external_energy = potential.energy(EnergyCategory::external, state.positions);
  frame.contact_energy = potential.energy(EnergyCategory::contact, state.positions);

  for (const Body& body : world.bodies)
    for (const Domain& domain : body.domains)
      if (body.has_regions())
        frame.regions.push_back({.body = body.name,
                                 .region = domain.name,
                                 .elastic_energy = world.share.sum(domain.stored_energy(state.positions))});

  frame.min_volume_ratio = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const auto [ratio, cell] = world.bodies[b].domains.min_volume_ratio(state.positions);
    if (ratio < frame.min_volume_ratio) {
      frame.min_volume_ratio = ratio;
      frame.worst_cell = cell;
      frame.worst_body = static_cast<int>(b);
    }
  }
  find_worst_of_all(world, frame);
  for (const Probe& probe : world.probes) {
    const auto at_probe = [&](const VectorX& values) { return probe.value(dim, values); };
    frame.probes.push_back(
        {.name = probe.name,
         .displacement = world.share.sum(at_probe(state.positions) - at_probe(world.rest_positions)),
         .velocity = world.share.sum(at_probe(state.velocities))});
  }

  for (const Body& body : world.bodies)
    if (body.rigid) frame.rigid_bodies.push_back(rigid_motion(world, body, state));
  for (std::size_t k = 0; k < world.cables.size(); ++k) {
    const Cable& cable = *world.cables[k];
    frame.cables.push_back({.name = std::string(cable.name()),
                            .force = cable.force(state.positions, conditions),
                            .length = cable.length(state.positions)});
    if (cable.path().num_pieces() > 1) frame.cables.back().tensions = cable_tensions(world, state, k);
  }

  if (world.contact) frame.contacts = world.contact->body_contacts(state.positions, conditions);

  for (const Section& section : world.sections) frame.sections.push_back(section.measure(state.positions));

  const std::unique_ptr<const LaggedFriction> friction = friction_of(world, state);
  VectorX gradient;
  if (step_gradient == nullptr) {
    potential.gradient(state.positions, gradient);
    add_friction_forces(world, state, gradient);
    step_gradient = &gradient;
  }
  for (const Support& support : world.supports) frame.reactions.emplace_back(support.name, Vector3::Zero());
  frame.reaction_torques.assign(world.supports.size(), Vector3::Zero());
  const auto add_reactions = [&](const std::vector<std::int32_t>& support_of, const VectorX& forces) {
    for (std::size_t i = 0; i < support_of.size(); ++i) {
      if (support_of[i] < 0) continue;
      const auto support = static_cast<std::size_t>(support_of[i]);
      const auto node = static_cast<Index>(i / static_cast<std::size_t>(dim));
      if (!world.share.owns(node)) continue;
      Vector3 force = Vector3::Zero();
      force[static_cast<int>(i % static_cast<std::size_t>(dim))] = forces[static_cast<Eigen::Index>(i)];
      frame.reactions[support].second += force;
      frame.reaction_torques[support] += node_position(dim, node, state.positions).cross(force);
    }
  };
  add_reactions(world.support_of, *step_gradient);
  if (const auto release = world.find_term({TermOrigin::Kind::release})) {
    VectorX pull = VectorX::Zero(state.positions.size());
    world.terms[*release]->add_gradient(state.positions, conditions, pull);
    add_reactions(world.released_from, -pull);
  }
  for (std::size_t k = 0; k < frame.reactions.size() && !world.share.is_whole(); ++k) {
    frame.reactions[k].second = world.share.sum(frame.reactions[k].second);
    frame.reaction_torques[k] = world.share.sum(frame.reaction_torques[k]);
  }
  frame.joints = joint_forces(world, conditions, *step_gradient, state);
  if (world.constraints) {
    const std::vector<Reaction> held = world.constraints->reactions(dim, *step_gradient, state.positions);
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (world.constraints->names[i].empty()) continue;  // joints have their own place
      frame.reactions.emplace_back(world.constraints->names[i], held[i].force);
      frame.reaction_torques.push_back(held[i].torque);
    }
  }
  for (const auto& term : world.terms) {
    const std::optional<Reaction> reaction = term->reaction(state.positions, conditions);
    if (!reaction) continue;
    frame.reactions.emplace_back(term->name(), world.share.sum(reaction->force));
    frame.reaction_torques.push_back(world.share.sum(reaction->torque));
  }
  if (friction) add_friction(world, *friction, state.positions, frame);
  move_to_scene_coordinates(world.origin, frame);
  return frame;
}

}  // namespace resilin
