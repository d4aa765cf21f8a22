#include "resilin/world/start_distance.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resilin/contact/barrier.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/start_check.hpp"

namespace resilin {
namespace {

constexpr double most_loads = 2;      ///< push at the start, relative to the load of the body
constexpr double least_share = 0.01;  ///< shortest distance, relative to the default

/// Share of the activation distance at which the barrier has `share` of the slope that it has at `from`.
double relative_gap_of_slope(double share, double from) {
  constexpr ClampedLogBarrier barrier{.activation_distance = 1};
  const double wanted = share * barrier.slope(from);
  double low = from, high = 1;
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high))
    (barrier.slope(middle) < wanted ? low : high) = middle;
  return high;
}

/// A power of 1.1 [m]: the nearest one, or the next one above. It does not change with the numbers of a scene
/// but by jumps: their derivatives need not know of it.
double rung(double distance, bool is_above) {
  constexpr double ratio = 1.1;
  const double exponent = std::log(distance) / std::log(ratio);
  return std::pow(ratio, is_above ? std::ceil(exponent) : std::round(exponent));
}

std::optional<double>& distance_of(const TermOrigin& origin, ContactWishes& wishes) {
  return origin.kind == TermOrigin::Kind::collider ? wishes.colliders[origin.number].activation_distance
                                                   : wishes.contact.activation_distance;
}

/// The smallest gap of a contact term at the start, as a share of its activation distance.
double relative_gap(const World& world, const Energy& term) {
  const VectorX& start = world.start_positions;
  for (const auto& collider : world.colliders)
    if (collider.get() == &term) return collider->relative_gap(start, {});
  for (const auto& collider : world.mesh_colliders)
    if (collider.get() == &term) return collider->relative_gap(start, {});
  return world.contact->relative_gap(start, {});
}

}  // namespace

bool shorten_activation_distances(ContactWishes& wishes, World& world) {
  std::map<std::size_t, double> wanted_shares;  // by number of the term: of its force
  for (const PushedBody& each : pushed_bodies(world, most_loads))
    for (const std::size_t t : each.terms) {
      double& share = wanted_shares.try_emplace(t, 1.0).first->second;
      share = std::min(share, each.load / each.push);
    }
  bool is_any_shorter = false;
  for (const auto& [t, share] : wanted_shares) {
    const TermOrigin& origin = world.origins[t];
    std::optional<double>& distance = distance_of(origin, wishes);
    if (distance) continue;
    const bool is_collider = origin.kind == TermOrigin::Kind::collider;
    const double present =
        is_collider ? default_activation_distance(world) : world.contact->activation_distance();
    const double relative = relative_gap(world, *world.terms[t]), gap = present * relative;
    const double wanted = gap / relative_gap_of_slope(share, relative);
    const double shorter = std::max(rung(wanted, !world.is_dynamic), least_share * present);
    if (!(shorter < present)) continue;
    distance = shorter;
    is_any_shorter = true;
    world.shorter_distances.emplace_back(origin, shorter);
    world.notes.push_back(world.place + ": activation distance of " +
                          (is_collider ? '"' + wishes.colliders[origin.number].name + '"' : "bodies") + ": " +
                          format_short(shorter) + " m, not " + format_short(present) +
                          " m, as bodies start " + format_short(gap) + " m apart");
  }
  return is_any_shorter;
}

}  // namespace resilin
