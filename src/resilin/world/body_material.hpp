#pragma once

#include <memory>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// Makes the strain energy of `body`, whose cells are placed in `world`, and notes law and constants in it.
/// The energy is not bound to a pattern yet.
/// @param constants  of the law's formula: once, or for one cell after another
/// @throws InputError  for a law that does not suit the element or the motion
std::shared_ptr<ElasticEnergy> give_material(const World& world, const BodyDescription& description,
                                             const std::vector<double>& constants, Body& body);

/// Gives body number `index` of a world another material; all else stays. On an error the world is unchanged.
void change_material(World& world, std::size_t index, const BodyDescription& description);

}  // namespace resilin
