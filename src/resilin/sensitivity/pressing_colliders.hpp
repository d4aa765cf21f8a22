#pragma once

#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// A collider that presses on bodies.
struct PressingCollider {
  std::string name;
  double force = 0;                ///< [N]
  double gap = 0;                  ///< how far away it is [m]
  double activation_distance = 0;  ///< from where on it is felt [m]
};

/// Those that press where the bodies are, at the full load.
std::vector<PressingCollider> pressing_colliders(const World& world, const VectorX& positions);

/// "the collider "floor" presses with 1.8e+03 N, 12 times the weight, from 0.003 m away, ...".
std::string in_words(const PressingCollider& collider, const World& world);

/// "0.003 m inside of the collider "floor"": the first that places of bodies are in or through; empty: none
/// that is an exact shape.
std::string collider_around(const World& world, const VectorX& positions);

}  // namespace resilin
