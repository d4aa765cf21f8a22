#include "resilin/simulation/jump.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace resilin {
namespace {

constexpr double notable_share = 0.1;  ///< relative to the strain energy: a long step leaves less
/// The same for reactions that fall or change their signs, where the loss itself may vanish.
constexpr double notable_softening = 0.02;
/// Relative to the strain energy: what a part of a step that holds a jump loses at least.
constexpr double lasting_share = 0.03;
/// Losses of halves by those of wholes are 1/8 on a smooth path, distances 0.5, 0.7 at a limit point; 1 in a
/// jump.
constexpr double energy_ratio = 0.6, smooth_ratio = 0.55, distance_ratio = 0.85;
constexpr int most_bisections = 5, least_bisections = 2;  ///< where one finds no equilibrium

double strain_energy(const World& world, const Equilibrium& at) {
  double energy = 0;
  for (const Body& body : world.bodies) energy += body.domains.value(at.positions);
  return world.share.sum(energy);
}

/// Work of the forces at both ends of a way from one equilibrium to another [J].
struct Works {
  double before = 0, after = 0, released = 0;
};

Works works_between(const World& world, const Equilibrium& from, const Equilibrium& to) {
  const Conditions before = world.at_load(from.load), after = world.at_load(to.load);
  // In equilibrium the elastic forces balance all others.
  VectorX first = VectorX::Zero(from.positions.size()), last = first;
  double change = 0;
  for (const Body& body : world.bodies) {
    for (const Domain& domain : body.domains) {
      domain.energy->add_gradient(from.positions, before, first);
      domain.energy->add_gradient(to.positions, after, last);
    }
    change += body.domains.difference(from.positions, to.positions);
  }
  world.share.add_copies(first);
  world.share.add_copies(last);
  const VectorX way = to.positions - from.positions;
  Works works{.before = world.share.dot(first, way), .after = world.share.dot(last, way)};
  works.released = 0.5 * (works.before + works.after) - world.share.sum(change);
  return works;
}

/// A part of a step.
struct Part {
  double released = 0;  ///< energy [J]
  double distance = 0;  ///< between the positions of all nodes [m]
};

}  // namespace

double released_energy(const World& world, const Equilibrium& from, const Equilibrium& to) {
  return works_between(world, from, to).released;
}

std::optional<Jump> find_jump(const World& world, const Equilibrium& from, const Equilibrium& to,
                              const FindEquilibrium& find) {
  const Works works = works_between(world, from, to);
  const double most = std::max(strain_energy(world, from), strain_energy(world, to));
  // Between mirror images no energy is lost, but the reactions change their signs.
  const double softening = 0.5 * (works.before - works.after);
  if (!(works.released > notable_share * most) && !(softening > notable_softening * most))
    return std::nullopt;
  const auto part_between = [&](const Equilibrium& one, const Equilibrium& other) {
    return Part{.released = released_energy(world, one, other),
                .distance = world.share.norm(other.positions - one.positions)};
  };
  const double least = lasting_share * most;
  Equilibrium a = from, b = to;
  Part found{.released = works.released, .distance = world.share.norm(to.positions - from.positions)};
  Part before = found;
  for (int k = 0; k < most_bisections; ++k) {
    const std::optional<Equilibrium> middle = find(a, 0.5 * (a.load + b.load));
    if (!middle && k < least_bisections) return std::nullopt;
    if (!middle) break;
    const Part first = part_between(a, *middle), second = part_between(*middle, b);
    const bool by_energy = std::max(first.released, second.released) > least;
    const bool is_first = by_energy ? first.released >= second.released : first.distance >= second.distance;
    before = std::exchange(found, is_first ? first : second);
    if (!by_energy && k > 0 && !(found.distance > smooth_ratio * before.distance)) return std::nullopt;
    (is_first ? b : a) = *middle;
  }
  const bool loses_energy = found.released > std::max(least, energy_ratio * before.released);
  if (!loses_energy && !(found.distance > distance_ratio * before.distance)) return std::nullopt;
  Jump jump{.energy = loses_energy ? found.released : std::max(works.released, softening),
            .from = a.load,
            .to = b.load};
  // A search from nearer by may find another end than that from afar.
  if (const std::optional<Equilibrium> end = find(a, b.load)) {
    const Part again = part_between(a, *end);
    jump.is_avoidable = loses_energy ? !(again.released > energy_ratio * found.released)
                                     : !(again.distance > smooth_ratio * found.distance);
  }
  return jump;
}

}  // namespace resilin
