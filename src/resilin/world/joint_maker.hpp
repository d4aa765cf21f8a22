#pragma once

#include <memory>

#include "resilin/world/world.hpp"

namespace resilin {

/// In a world whose bodies are complete. Throws InputError for a joint that cannot be.
Joint make_joint(const JointDescription& description, World& world);
/// The energy of a distance or a motor, which the joint takes note of; null: it has none.
std::shared_ptr<Energy> make_joint_term(const JointDescription& description, World& world, Joint& joint);
/// The energy of a spring or a cable.
std::shared_ptr<Cable> make_cable(const CableDescription& description, World& world);

}  // namespace resilin
