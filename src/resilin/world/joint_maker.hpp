#pragma once

#include <memory>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// In a world whose bodies are complete. Throws InputError for a joint that cannot be.
/// @param terms  to which its energies are added
Joint make_joint(const JointDescription& description, World& world,
                 std::vector<std::shared_ptr<Energy>>& terms);
/// The energy of a spring or a cable.
std::shared_ptr<Cable> make_cable(const CableDescription& description, World& world);

}  // namespace resilin
