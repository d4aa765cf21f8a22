#include "resilin/simulation/energy_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "resilin/core/dense.hpp"
#include "resilin/core/rigid_motions.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/simulation/rigid_fit.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// Without what is prescribed; what follows other unknowns moves with them.
VectorX free_part(const World& world, VectorX values) {
  if (world.dependents() == nullptr) {
    set_fixed_to_zero(world.is_fixed, values);
    return values;
  }
  VectorX free = values;
  set_fixed_to_zero(world.is_fixed, free);
  for (const Dependents::Relation& relation : world.dependents()->relations())
    free[relation.unknown] = values[relation.unknown];
  return free;
}

/// Differences of the ways of dependent unknowns from what follows, where anything moves them.
VectorX way_of_constants(const World& world, const VectorX& way) {
  VectorX moved = VectorX::Zero(way.size());
  if (!world.constraints || world.constraints->functions.empty()) return moved;
  VectorX following = way;
  world.dependents()->follow(following);
  return way - following;
}

/// Adds the inertia of what follows others to the forces on what it follows.
void add_inertia_of_dependents(const World& world, const VectorX& accelerations, VectorX& reactions) {
  if (world.dependents() == nullptr || accelerations.size() == 0) return;
  VectorX pull, of_dependents = VectorX::Zero(reactions.size());
  world.mass->multiply(accelerations, pull);
  for (const Dependents::Relation& relation : world.dependents()->relations())
    of_dependents[relation.unknown] = pull[relation.unknown];
  world.dependents()->add_forces(of_dependents);
  reactions += of_dependents;
}

double product(const World& world, const VectorX& a, const VectorX& b) {
  VectorX momentum;
  world.mass->multiply(a, momentum);
  return world.share.sum(momentum.dot(b));  // each process multiplies by the mass of its own cells
}

/// 1/2 |v|^2_M of the free unknowns [J].
double kinetic_energy(const World& world, const VectorX& velocities) {
  const VectorX v = free_part(world, velocities);
  return 0.5 * product(world, v, v);
}

/// The largest that the supports' work on the bodies may be: reaction times way, with the reactions at the
/// one end or the other; and the inertia of what moves along with them. None where they stand still.
std::optional<double> work_of_supports(const World& world, const State& start, const Motion& end,
                                       const Potential& after) {
  VectorX way = end.positions - start.positions;
  VectorX free_way = free_part(world, way);
  way += way_of_constants(world, way) - free_way;
  if (world.share.all(way.isZero(0))) return std::nullopt;
  VectorX reactions;
  after.gradient(end.positions, reactions);
  add_inertia_of_dependents(world, end.accelerations, reactions);
  const double work_after = world.share.dot(reactions, way);
  Potential::at(world, start).gradient(start.positions, reactions);
  add_inertia_of_dependents(world, start.accelerations, reactions);
  const double work_before = world.share.dot(reactions, way);
  double work = std::max(work_before, work_after);
  if (!world.mass->is_lumped()) {
    const VectorX pull = end.accelerations - free_part(world, end.accelerations);
    work -= product(world, pull, free_way);
  }
  return work;
}

using Group = std::vector<const Body*>;

/// The velocities of the nodes of bodies, zero elsewhere, that move them as one rigid body by each of its
/// rigid motions about `center`.
std::vector<VectorX> motions_of_group(const World& world, const Group& group, const VectorX& positions,
                                      const Vector3& center) {
  const int dim = world.dimension;
  std::vector<VectorX> motions(dim == 3 ? 6 : 3, VectorX::Zero(positions.size()));
  for (const Body* body : group)
    for (Index node = body->first_node; node < body->first_node + body->num_nodes; ++node) {
      const RigidMotions of_node = rigid_motions(dim, node_position(dim, node, positions) - center);
      for (std::size_t k = 0; k < motions.size(); ++k)
        motions[k].segment(Eigen::Index{node} * dim, dim) = of_node.col(static_cast<Eigen::Index>(k));
    }
  return motions;
}

double num_owned_nodes(const World& world, const Body& body) {
  if (world.share.is_whole()) return body.num_nodes;
  double count = 0;
  for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
    count += world.share.owns(node) ? 1 : 0;
  return world.share.sum(count);
}

/// Bodies without supports, those together that ties and joints couple.
std::vector<Group> groups_without_supports(const World& world) {
  const std::size_t count = world.bodies.size();
  std::vector<std::size_t> group_of(count);
  for (std::size_t b = 0; b < count; ++b) group_of[b] = b;
  std::vector<std::uint8_t> is_held = world.is_fixed;
  const auto dim = static_cast<Index>(world.dimension);
  if (world.dependents() != nullptr)
    for (const Dependents::Relation& relation : world.dependents()->relations()) {
      is_held[static_cast<std::size_t>(relation.unknown)] = 0;
      const auto group_at = [&](Index unknown) {
        return group_of[static_cast<std::size_t>(&world.body_of(unknown / dim) - world.bodies.data())];
      };
      for (const Dependents::Weight& weight : relation.by) {
        const std::size_t from = group_at(weight.unknown), to = group_at(relation.unknown);
        std::ranges::replace(group_of, from, to);
      }
    }
  std::vector<Group> groups;
  for (std::size_t g = 0; g < count; ++g) {
    Group group;
    bool is_whole_free = true;
    for (std::size_t b = 0; b < count; ++b) {
      if (group_of[b] != g) continue;
      group.push_back(&world.bodies[b]);
      is_whole_free = is_whole_free && is_free(world, world.bodies[b], is_held);
    }
    if (is_whole_free && !group.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

/// Whether constraints let bodies move so: joints to the ground and periodic cells do not.
bool are_allowed(const World& world, const std::vector<VectorX>& motions) {
  constexpr double rounding = 1e-9;
  if (world.dependents() == nullptr) return true;
  return std::ranges::all_of(motions, [&](const VectorX& motion) {
    VectorX following = motion;
    world.dependents()->follow(following);
    return (following - motion).norm() <= rounding * motion.norm();
  });
}

/// Velocities without the rigid motions that have the momenta of bodies, or of those that are coupled.
/// Bodies with supports keep all.
VectorX without_rigid_motion(const World& world, const VectorX& positions, VectorX velocities) {
  for (const Group& group : groups_without_supports(world)) {
    const int dim = world.dimension;
    Vector3 center = Vector3::Zero();
    double num_nodes = 0;
    for (const Body* body : group) num_nodes += num_owned_nodes(world, *body);
    for (const Body* body : group)
      for (Index node = body->first_node; node < body->first_node + body->num_nodes; ++node)
        if (world.share.owns(node)) center += node_position(dim, node, positions) / num_nodes;
    center = world.share.sum(center);
    const std::vector<VectorX> motions = motions_of_group(world, group, positions, center);
    if (!are_allowed(world, motions)) continue;
    const auto count = static_cast<Eigen::Index>(motions.size());
    Eigen::MatrixXd masses(count, count);
    VectorX momenta(count), momentum;
    for (Eigen::Index i = 0; i < count; ++i) {
      world.mass->multiply(motions[static_cast<std::size_t>(i)], momentum);
      momenta[i] = world.share.sum(momentum.dot(velocities));
      for (Eigen::Index j = 0; j < count; ++j)
        masses(i, j) = world.share.sum(momentum.dot(motions[static_cast<std::size_t>(j)]));
    }
    const VectorX rates = dense::solve(masses, momenta);
    for (Eigen::Index i = 0; i < count; ++i) velocities -= rates[i] * motions[static_cast<std::size_t>(i)];
  }
  return velocities;
}

}  // namespace

EnergyChange energy_change(const World& world, const State& start, const Motion& end,
                           const Conditions& after) {
  const Conditions before = conditions_of(start);
  Potential potential = Potential::in_stage(world, start, after, static_stage(start.positions));
  potential.prepare(start.positions, end.positions - start.positions);
  EnergyChange change{.kinetic_before = kinetic_energy(world, start.velocities),
                      .kinetic_after = kinetic_energy(world, end.velocities)};
  const Potential::Gain gain = potential.gain(start.positions, before, end.positions);
  const std::optional<double> work = work_of_supports(world, start, end, potential);
  change.added = change.kinetic_after - change.kinetic_before + gain.beyond_work - work.value_or(0);
  change.is_driven = gain.is_driven || work.has_value();
  return change;
}

double strain_stiffness(const World& world) {
  constexpr double strain = 1e-6;
  Vector3 center = node_position(world.dimension, 0, world.rest_positions);
  if (!world.share.is_whole())
    center = world.share.sum(world.share.is_first() ? center : Vector3(Vector3::Zero()));
  const VectorX origin = center.head(world.dimension).replicate(world.num_nodes(), 1);
  const VectorX strained = world.rest_positions + strain * (world.rest_positions - origin);
  double energy = 0;
  for (const Body& body : world.bodies) energy += body.domains.value(strained);
  return world.share.sum(energy) / (strain * strain);
}

double round_off_energy(const World& world, double strain_stiffness, const VectorX& positions,
                        double time_step) {
  constexpr double strain = 1e-10, digits = 1e3 * std::numeric_limits<double>::epsilon();
  const double speed = digits * world.share.largest(positions.cwiseAbs().maxCoeff()) / time_step;
  return strain_stiffness * strain * strain + 0.5 * world.share.sum(world.mass->total()) * speed * speed;
}

// 1/2 |v - t d|^2_M = 1/2 |v|^2_M - t v.M d + t^2/2 |d|^2_M
bool slow_down(const World& world, const VectorX& positions, double excess, bool only_within,
               VectorX& velocities) {
  const VectorX v = free_part(world, velocities);
  VectorX d = only_within ? free_part(world, without_rigid_motion(world, positions, v)) : v;
  if (world.dependents() != nullptr) world.dependents()->follow(d);
  const double slope = product(world, v, d), curvature = product(world, d, d);
  const double discriminant = slope * slope - 2 * curvature * excess;
  if (!(discriminant >= 0) || !(slope > 0)) return false;
  velocities -= 2 * excess / (slope + std::sqrt(discriminant)) * d;
  return true;
}

}  // namespace resilin
