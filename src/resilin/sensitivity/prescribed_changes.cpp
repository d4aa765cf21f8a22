#include "resilin/sensitivity/prescribed_changes.hpp"

#include <array>

#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// A support's place, velocity or acceleration of a node: linear in its displacement d, velocity v and
/// gradient G, and in the rest position X.
struct SupportSlopes {
  double by_displacement = 0;  ///< also by G (X + origin)
  double by_velocity = 0;
  Eigen::Matrix3d by_rest = Eigen::Matrix3d::Zero();
};

/// Slopes of all three, read off the support's own functions.
std::array<SupportSlopes, 3> slopes_of(const Support& support, const Conditions& c) {
  const std::array<Vector3 (*)(const Support&, const Vector3&, const Conditions&), 3> functions = {
      [](const Support& s, const Vector3& X, const Conditions& at) { return s.target(X, at); },
      [](const Support& s, const Vector3& X, const Conditions& at) { return s.velocity_at(X, at.time); },
      [](const Support& s, const Vector3& X, const Conditions& at) { return s.acceleration_at(X, at.time); }};
  const Vector3 zero = Vector3::Zero();
  Support still = support;
  still.displacement = still.velocity = zero;
  still.gradient.setZero();
  Support displaced = still, moving = still;
  displaced.displacement = moving.velocity = Vector3::UnitX();
  std::array<SupportSlopes, 3> all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto value = [&](const Support& s, const Vector3& X) { return functions[k](s, X, c); };
    all[k].by_displacement = (value(displaced, zero) - value(still, zero)).x();
    all[k].by_velocity = (value(moving, zero) - value(still, zero)).x();
    for (int i = 0; i < 3; ++i)
      all[k].by_rest.col(i) = value(support, Vector3::Unit(i)) - value(support, zero);
  }
  return all;
}

/// Calls `body(support, its slopes, node, unknown, component)` for each unknown that a support prescribes.
template <class Body>
void for_each_prescribed(const World& world, const Conditions& c, const Body& body) {
  std::vector<std::array<SupportSlopes, 3>> slopes;
  for (const Support& support : world.supports) slopes.push_back(slopes_of(support, c));
  for (std::size_t i = 0; i < world.support_of.size(); ++i) {
    if (world.support_of[i] < 0) continue;
    const auto s = static_cast<std::size_t>(world.support_of[i]);
    const int dim = world.dimension;
    body(s, slopes[s], static_cast<Index>(i / static_cast<std::size_t>(dim)), static_cast<Eigen::Index>(i),
         static_cast<int>(i % static_cast<std::size_t>(dim)));
  }
}

}  // namespace

void place_prescribed_changes(const World& world, const WorldChange& change, const Conditions& conditions,
                              Motion& motion) {
  for (Eigen::Index i = 0; i < motion.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.positions[i] = change.start_positions.size() > 0 ? change.start_positions[i] : 0;
    motion.velocities[i] = motion.accelerations[i] = 0;
  }
  VectorX* const parts[] = {&motion.positions, &motion.velocities, &motion.accelerations};
  for_each_prescribed(
      world, conditions,
      [&](std::size_t s, const std::array<SupportSlopes, 3>& slopes, Index node, Eigen::Index i, int k) {
        const WorldChange::OfSupport& of = change.supports[s];
        const Vector3 X = world.place_of(node, world.rest_positions);
        const Vector3 dX = change.rest_positions.size() > 0
                               ? node_position(world.dimension, node, change.rest_positions)
                               : Vector3(Vector3::Zero());
        const Vector3 end = of.displacement + of.gradient * X;
        for (std::size_t part = 0; part < 3; ++part)
          (*parts[part])[i] = slopes[part].by_displacement * end[k] +
                              slopes[part].by_velocity * of.velocity[k] + slopes[part].by_rest.row(k).dot(dX);
      });
  follow(world, motion);
}

void follow(const World& world, Motion& change) {
  if (!world.constraints) return;
  for (VectorX* part : {&change.positions, &change.velocities, &change.accelerations})
    if (part->size() > 0) world.dependents()->follow(*part);
}

void follow_transposed(const World& world, VectorX& slopes) {
  if (!world.constraints || slopes.size() == 0) return;
  world.dependents()->add_forces(slopes);
  for (const Dependents::Relation& relation : world.dependents()->relations()) slopes[relation.unknown] = 0;
}

void follow_transposed(const World& world, Motion& slopes) {
  for (VectorX* part : {&slopes.positions, &slopes.velocities, &slopes.accelerations})
    follow_transposed(world, *part);
}

void add_prescribed_slopes(const World& world, const Motion& by_motion, const Conditions& conditions,
                           WorldChange& slopes) {
  if (slopes.start_positions.size() > 0)
    for (std::size_t i = 0; i < world.support_of.size(); ++i)
      if (world.is_fixed[i] != 0 && world.support_of[i] < 0)
        slopes.start_positions[static_cast<Eigen::Index>(i)] +=
            by_motion.positions[static_cast<Eigen::Index>(i)];
  const VectorX* const parts[] = {&by_motion.positions, &by_motion.velocities, &by_motion.accelerations};
  for_each_prescribed(
      world, conditions,
      [&](std::size_t s, const std::array<SupportSlopes, 3>& of_support, Index node, Eigen::Index i, int k) {
        WorldChange::OfSupport& of = slopes.supports[s];
        const Vector3 X = world.place_of(node, world.rest_positions);
        for (std::size_t part = 0; part < 3; ++part) {
          if (parts[part]->size() == 0) continue;
          const double by = (*parts[part])[i];
          of.displacement[k] += of_support[part].by_displacement * by;
          of.gradient.row(k) += of_support[part].by_displacement * by * X.transpose();
          of.velocity[k] += of_support[part].by_velocity * by;
          if (slopes.rest_positions.size() > 0)
            slopes.rest_positions.segment(Eigen::Index{node} * world.dimension, world.dimension) +=
                by * of_support[part].by_rest.row(k).head(world.dimension).transpose();
        }
      });
}

}  // namespace resilin
