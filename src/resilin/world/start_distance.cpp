#include "resilin/world/start_distance.hpp"

#include <algorithm>
#include <set>

#include "resilin/core/text.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/start_check.hpp"

namespace resilin {
namespace {

constexpr double share_in_motion = 0.95;   ///< of the gap: no force at the start
constexpr double share_in_statics = 1.05;  ///< of the gap: a body that contact alone holds feels it
constexpr double least_share = 0.01;       ///< of the default distance

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
  std::set<std::size_t> pushing;
  for (const PushedBody& each : pushed_bodies(world)) pushing.insert(each.terms.begin(), each.terms.end());
  bool is_any_shorter = false;
  for (const std::size_t t : pushing) {
    const TermOrigin& origin = world.origins[t];
    std::optional<double>& distance = distance_of(origin, wishes);
    if (distance) continue;
    const bool is_collider = origin.kind == TermOrigin::Kind::collider;
    const double present =
        is_collider ? default_activation_distance(world) : world.contact->activation_distance();
    const double gap = present * relative_gap(world, *world.terms[t]);
    const double wanted = gap * (world.is_dynamic ? share_in_motion : share_in_statics);
    const double shorter = std::max(wanted, least_share * present);
    if (!(shorter < present)) continue;
    distance = shorter;
    is_any_shorter = true;
    world.notes.push_back(world.place + ": activation distance of " +
                          (is_collider ? '"' + wishes.colliders[origin.number].name + '"' : "bodies") + ": " +
                          format_short(shorter) + " m, not " + format_short(present) +
                          " m, as bodies start " + format_short(gap) + " m apart");
  }
  return is_any_shorter;
}

}  // namespace resilin
