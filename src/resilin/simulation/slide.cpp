#include "resilin/simulation/slide.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/energy/handle_spring.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/stage_plan.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

/// Part of its extent by which the load moves a body against its springs.
constexpr double give_of_springs = 0.01;
constexpr int most_moves_of_springs = 6;
/// A body slides where at least this part of its load is missing, and no longer changes by a tenth.
constexpr double least_missing = 1e-4;
constexpr double steady_change = 0.1;

/// Springs that hold a body.
struct Held {
  std::size_t body;
  std::vector<Index> nodes;
  double stiffness;  ///< spring constant of each node [N/m]
  double applied;    ///< load on the body [N]
};

/// Bodies that supports let go along some axis, and what acts on them from outside.
std::vector<Held> bodies_to_hold(const World& world, const Potential& potential, const VectorX& x) {
  const VectorX loads = potential.gradient_of(EnergyCategory::external, x);
  std::vector<Held> all;
  double largest = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    Vector3 sum = Vector3::Zero();
    Held held{.body = b, .nodes = {}, .stiffness = 0, .applied = 0};
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      sum += node_position(world.dimension, node, loads);
      held.nodes.push_back(node);
    }
    held.applied = sum.norm();
    largest = std::max(largest, held.applied);
    if (!is_held_along_every_axis(world, body)) all.push_back(std::move(held));
  }
  for (Held& held : all) {
    // A body without a load of its own bears that of others.
    if (held.applied == 0) held.applied = largest;
    held.stiffness = held.applied / (give_of_springs * world.largest_extent(world.bodies[held.body]) *
                                     static_cast<double>(held.nodes.size()));
  }
  std::erase_if(all, [](const Held& held) { return !(held.stiffness > 0); });
  return all;
}

/// Force that the springs of a body bear at x [N].
double borne(const World& world, const Held& held, const VectorX& anchors, const VectorX& x) {
  Vector3 sum = Vector3::Zero();
  for (const Index node : held.nodes)
    sum += node_position(world.dimension, node, x) - node_position(world.dimension, node, anchors);
  return held.stiffness * sum.norm();
}

}  // namespace

bool is_held_along_every_axis(const World& world, const Body& body) {
  for (int k = 0; k < world.dimension; ++k) {
    bool is_held = false;
    for (Index node = body.first_node; node < body.first_node + body.num_nodes && !is_held; ++node)
      is_held = world.is_fixed[static_cast<std::size_t>(Eigen::Index{node} * world.dimension + k)] != 0;
    if (!is_held) return false;
  }
  return true;
}

std::optional<FrictionHold> hold_by_friction(const World& world, Newton& newton, const State& state,
                                             double load, const NewtonObserver& observer,
                                             NewtonReport& counts) {
  if (!world.friction || !world.share.is_whole() || world.constraints) return std::nullopt;
  const StagePlan plan = plan_increment(world, state.positions, state.load, load);
  const std::vector<Held> all =
      bodies_to_hold(world, Potential::in_stage(world, state, plan.conditions, plan.stage), state.positions);
  if (all.empty()) return std::nullopt;
  VectorX x = state.positions, anchors = state.positions;
  std::vector<double> before(all.size(), 0);
  for (int move = 0; move < most_moves_of_springs; ++move) {
    Terms terms = world.terms;
    for (const Held& held : all)
      terms.push_back(std::make_shared<HandleSpring>("hold", world.dimension, held.nodes, held.stiffness,
                                                     HandleSpring::Motion{}, anchors));
    Potential potential(terms, world.is_fixed, plan.conditions, plan.stage, world.share, state.history,
                        nullptr);
    const StageReport found =
        solve_stage(potential, world.is_fixed, plan.targets, {}, newton_settings(world),
                    {.friction_rounds = world.friction_iterations}, newton, x, observer);
    add_counts(counts, found.newton);
    if (!found.newton.converged() || found.friction_mismatch > largest_balance_error ||
        potential.conditions().delay > 0)
      return std::nullopt;
    bool is_steady = move > 0, is_any_missing = false;
    FrictionHold hold;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double missing = borne(world, all[i], anchors, x);
      const bool slides = missing > least_missing * all[i].applied;
      is_any_missing |= slides;
      is_steady &= !slides || std::abs(missing - before[i]) < steady_change * missing;
      before[i] = missing;
      if (slides && (!hold.slide || missing > hold.slide->missing))
        hold.slide = {.body = all[i].body, .missing = missing, .applied = all[i].applied};
    }
    if (!is_any_missing) {
      hold.positions = std::move(x);
      return hold;
    }
    if (is_steady) return hold;
    anchors = x;
  }
  return std::nullopt;
}

}  // namespace resilin
