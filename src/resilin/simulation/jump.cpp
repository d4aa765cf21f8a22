#include "resilin/simulation/jump.hpp"

#include <algorithm>
#include <cmath>

namespace resilin {
namespace {

constexpr double notable_share = 0.1;  ///< relative to the strain energy: a long step leaves less
constexpr double lasting_share =
    0.3;  ///< relative to the loss in the step: so much is lost in a part of it, too
constexpr int most_bisections = 5, least_bisections = 2;  ///< where one finds no equilibrium

double strain_energy(const World& world, const Equilibrium& at) {
  double energy = 0;
  for (const Body& body : world.bodies) energy += body.domains.value(at.positions);
  return world.share.sum(energy);
}

}  // namespace

double released_energy(const World& world, const Equilibrium& from, const Equilibrium& to) {
  const Conditions before = world.at_load(from.load), after = world.at_load(to.load);
  VectorX forces = VectorX::Zero(from.positions.size());  // in equilibrium they balance all others
  double change = 0;
  for (const Body& body : world.bodies) {
    for (const Domain& domain : body.domains) {
      domain.energy->add_gradient(from.positions, before, forces);
      domain.energy->add_gradient(to.positions, after, forces);
    }
    change += body.domains.difference(from.positions, to.positions);
  }
  world.share.add_copies(forces);
  const double work = 0.5 * world.share.dot(forces, to.positions - from.positions);
  return work - world.share.sum(change);
}

std::optional<Jump> find_jump(const World& world, const Equilibrium& from, const Equilibrium& to,
                              const FindEquilibrium& find) {
  const double whole = released_energy(world, from, to);
  const double most = std::max(strain_energy(world, from), strain_energy(world, to));
  if (!(whole > notable_share * most)) return std::nullopt;
  Equilibrium a = from, b = to;
  double released = whole;
  for (int k = 0; k < most_bisections; ++k) {
    const std::optional<Equilibrium> middle = find(a, 0.5 * (a.load + b.load));
    if (!middle && k < least_bisections) return std::nullopt;
    if (!middle) break;
    const double first = released_energy(world, a, *middle), second = released_energy(world, *middle, b);
    released = std::max(first, second);
    if (!(released > lasting_share * whole)) return std::nullopt;
    (first >= second ? b : a) = *middle;
  }
  Jump jump{.energy = released, .from = a.load, .to = b.load};
  // A search from nearer by may find another end than that from afar.
  if (const std::optional<Equilibrium> end = find(a, b.load))
    jump.is_avoidable = !(released_energy(world, a, *end) > lasting_share * whole);
  return jump;
}

}  // namespace resilin
