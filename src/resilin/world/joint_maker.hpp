#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// In a world whose bodies are complete. Throws InputError for a joint that cannot be.
/// @param terms  to which its energies are added
Joint make_joint(const JointDescription& description, World& world,
                 std::vector<std::shared_ptr<Energy>>& terms);
/// The angle of a hinge, or the way of a slider.
JointCoordinate coordinate_of(const Joint& joint, int dim);
/// Motors whose joints the other joints and supports lock, one line each: no motion of the rigid bodies
/// changes their values. Deformable bodies lock nothing, nor do mechanisms of more than 50 bodies. The world
/// has its joints and supports.
std::vector<std::string> locked_motors(const Description& description, const World& world);
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
