#pragma once

#include <optional>

#include "resilin/world/world.hpp"

namespace resilin {

/// Volume of a body's cells by the volume that its skin encloses, both in the reference configuration; none
/// without a skin, with an open one, and where processes share the world. Mass and stiffness are off by it.
std::optional<double> mesh_volume_ratio(const World& world, const Body& body);

}  // namespace resilin
