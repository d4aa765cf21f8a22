#pragma once

#include <optional>

#include "resilin/optimize/newton.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Where a load leads bodies that only friction holds.
struct FrictionHold {
  /// A body that slides.
  struct Slide {
    std::size_t body;         ///< its number
    double missing, applied;  ///< force that its balance lacks; load on it [N]
  };
  std::optional<Slide> slide;  ///< the body for which most is missing
  VectorX positions;           ///< without a slide: close to an equilibrium [m]
};

/// Whether supports hold a body along each axis, at any of its nodes.
bool is_held_along_every_axis(const World& world, const Body& body);

/// Springs hold the bodies that supports let go along some axis, and are moved after them until bodies stay
/// or slide on: what the springs then bear is missing in their balance.
/// @param load  factor of the load that the equilibrium `state` does not bear
/// @param counts  takes the counts of searches
/// @return none where that does not tell, or where no friction acts
std::optional<FrictionHold> hold_by_friction(const World& world, Newton& newton, const State& state,
                                             double load, const NewtonObserver& observer,
                                             NewtonReport& counts);

}  // namespace resilin
