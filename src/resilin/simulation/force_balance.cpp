#include "resilin/simulation/force_balance.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

std::vector<ForceBalance> measure_balance(const World& world, const Potential& potential, const VectorX& x,
                                          const VectorX& gradient) {
  std::vector<ForceBalance> balances;
  const std::vector<VectorX> acting = potential.gradients_without(EnergyCategory::elastic, x);
  for (const Body& body : world.bodies) {
    ForceBalance balance;
    double held = 0;  // supports may press against each other: their forces then cancel in the sum
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      for (int k = 0; k < world.dimension; ++k) {
        const Eigen::Index i = Eigen::Index{node} * world.dimension + k;
        if (world.support_of[static_cast<std::size_t>(i)] < 0) continue;
        balance.reaction[k] += gradient[i];
        held += gradient[i] * gradient[i];
      }
    }
    balance.scale = std::max(balance.reaction.norm(), std::sqrt(held));
    for (const VectorX& forces : acting) {
      Vector3 sum = Vector3::Zero();
      double size = 0;
      for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
        const Vector3 force = node_position(world.dimension, node, forces);
        sum -= force;
        size += force.squaredNorm();
      }
      balance.load += sum;
      balance.scale = std::max({balance.scale, sum.norm(), std::sqrt(size)});
    }
    balances.push_back(balance);
  }
  return balances;
}

std::string describe_imbalance(const World& world, const Potential& potential, const VectorX& x,
                               const VectorX& gradient, const NewtonReport& report) {
  const std::vector<ForceBalance> balances = measure_balance(world, potential, x, gradient);
  const double rounding = report.rounding * std::sqrt(static_cast<double>(x.size()));
  for (std::size_t b = 0; b < balances.size(); ++b) {
    const ForceBalance& balance = balances[b];
    if (balance.gap() <= std::max(largest_balance_error * balance.scale, rounding)) continue;
    return "the forces on \"" + world.bodies[b].name + "\" do not balance: its supports exert " +
           format_short(balance.reaction.norm()) + " N, all else " + format_short(balance.load.norm()) +
           " N, and " + format_short(balance.gap()) + " N are missing";
  }
  return {};
}

}  // namespace resilin
