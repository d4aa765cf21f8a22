#pragma once

#include <memory>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// In a world whose bodies are complete. Throws InputError for a joint that cannot be.
/// @param terms  to which its energies are added
Joint make_joint(const JointDescription& description, World& world,
                 std::vector<std::shared_ptr<Energy>>& terms);
/// The motor of a joint of the world, a hinge or a slider.
std::shared_ptr<Energy> make_motor(const MotorDescription& description, const Joint& joint,
                                   const World& world);
/// The energy of a spring or a cable.
std::shared_ptr<Cable> make_cable(const CableDescription& description, World& world);
/// The same through points that are known.
/// @param rest_length  used unless the description has one [m]
std::shared_ptr<Cable> make_cable(const CableDescription& description, int dim,
                                  std::vector<CarriedPoint> points, double rest_length);

}  // namespace resilin
