#include "resilin/simulation/support_stiffness.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resilin/mesh/facet.hpp"
#include "resilin/optimize/true_tangent.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/friction.hpp"

namespace resilin {
namespace {

constexpr double tangent_tolerance = 1e-8;  ///< tolerance of the solution with the tangent
constexpr double relative_motion = 1e-7;    ///< motion of a support for a difference, by the extent
constexpr double near_tolerance = 1e-10;    ///< tolerance of the solver that is near to the tangent

/// The tangent at an equilibrium.
class SupportTangent {
 public:
  explicit SupportTangent(Simulation& simulation)
      : simulation_(simulation),
        world_(simulation.world()),
        x_(simulation.state().positions),
        potential_(Potential::in_stage(world_, simulation.state(), world_.at_load(simulation.state().load),
                                       stage_of(world_, simulation.state()))) {
    potential_.form_lag(x_);
    if (world_.num_free_unknowns() > 0) simulation.newton().form_matrix(potential_, world_.is_fixed, x_);
  }

  /// The forces that hold a motion of fixed unknowns, others following; none where they cannot be found.
  std::optional<VectorX> forces_by(VectorX motion) {
    const NearSolve near = [this](const VectorX& b, VectorX& p) {
      std::optional<VectorX> found = simulation_.newton().response(b, world_.is_fixed, near_tolerance);
      if (found) p = std::move(*found);
      return found.has_value();
    };
    // Residuals of the differences are solved for once more.
    for (int round = 0; round < 3 && world_.num_free_unknowns() > 0; ++round) {
      VectorX left = -times(motion);
      for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
        if (world_.is_fixed[i] != 0) left[static_cast<Eigen::Index>(i)] = 0;
      VectorX following;
      const TangentReport report = solve_with_true_tangent(potential_, world_.is_fixed, world_.share, x_,
                                                           left, near, tangent_tolerance, following);
      if (!following.allFinite() || !(report.relative_residual < 1e-3)) return std::nullopt;
      motion += following;
    }
    return times(motion);
  }

 private:
  /// By a central difference.
  VectorX times(const VectorX& p) const {
    const double length = relative_motion * world_.largest_extent() / p.cwiseAbs().maxCoeff();
    VectorX after, before;
    potential_.gradient(x_ + length * p, after);
    potential_.gradient(x_ - length * p, before);
    return (after - before) / (2 * length);
  }

  Simulation& simulation_;
  const World& world_;
  const VectorX& x_;
  Potential potential_;
};

/// The motion of a support's own unknowns at a velocity of each of its nodes.
template <class Velocity>
VectorX motion_of_support(const World& world, std::int32_t support, const Velocity& velocity) {
  VectorX motion = VectorX::Zero(world.rest_positions.size());
  for (Eigen::Index i = 0; i < motion.size(); ++i)
    if (world.support_of[static_cast<std::size_t>(i)] == support)
      motion[i] = velocity(static_cast<Index>(i / world.dimension))[i % world.dimension];
  return motion;
}

std::optional<SupportStiffness> stiffness_of(const World& world, const VectorX& x, std::int32_t number,
                                             SupportTangent& tangent) {
  const Support& support = world.supports[static_cast<std::size_t>(number)];
  const int dim = world.dimension;
  const auto n = static_cast<std::size_t>(dim);
  SupportStiffness stiffness{.name = support.name, .by_displacement = std::vector<double>(n * n, 0.0)};
  for (int column = 0; column < dim; ++column) {
    const VectorX motion = motion_of_support(world, number, [&](Index) { return Vector3::Unit(column); });
    if (motion.isZero(0)) continue;
    const std::optional<VectorX> forces = tangent.forces_by(motion);
    if (!forces) return std::nullopt;
    for (int row = 0; row < dim; ++row)
      stiffness.by_displacement[static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column)] =
          motion_of_support(world, number, [&](Index) { return Vector3::Unit(row); }).dot(*forces);
  }
  if (!support.rotate) return stiffness;
  const VectorX turn = motion_of_support(world, number, [&](Index node) {
    return Vector3(
        support.rotate->axis.normalized().cross(node_position(dim, node, x) - support.rotate->center));
  });
  if (turn.isZero(0)) return stiffness;
  const std::optional<VectorX> forces = tangent.forces_by(turn);
  if (forces) stiffness.by_rotation = turn.dot(*forces);
  return stiffness;
}

}  // namespace

std::vector<SupportStiffness> support_stiffness(Simulation& simulation) {
  const World& world = simulation.world();
  const bool is_asked = std::ranges::any_of(world.supports, &Support::reports_stiffness);
  if (!is_asked || world.is_dynamic || world.modes || !world.share.is_whole() || world.constraints) return {};
  SupportTangent tangent(simulation);
  std::vector<SupportStiffness> all;
  for (std::size_t s = 0; s < world.supports.size(); ++s) {
    if (!world.supports[s].reports_stiffness || !world.supports[s].holds) continue;
    const auto found =
        stiffness_of(world, simulation.state().positions, static_cast<std::int32_t>(s), tangent);
    if (found) all.push_back(*found);
  }
  return all;
}

}  // namespace resilin
