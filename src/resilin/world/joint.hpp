#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/energy/cable.hpp"
#include "resilin/energy/motor.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

class World;

/// A joint in a world: points of two bodies that stay together, as sums over nodes that stay what they are.
struct Joint {
  struct Point {
    CarriedPoint place;               ///< by the first body
    std::vector<WeightedNode> nodes;  ///< those of the first body less those of the second one
  };

  std::string name;
  JointKind kind = JointKind::ball;
  std::vector<Point> points{};
  CarriedPoint at{};  ///< by the first body
  /// Where the joint has an angle: for the second body (the first, where the other one is the ground) and
  /// what it turns against, `at` and points beside it along the axis and across.
  struct Frame {
    CarriedPoint at, axis, along, across;
  };
  bool has_angle = false;
  double radius = 1;  ///< distance of these points [m]
  Frame turned{}, fixed{};
  std::shared_ptr<const Cable> distance{};
  std::shared_ptr<const Motor> motor{};
};

/// Force and value of a joint in a state.
struct JointForce {
  std::string name;
  Vector3 force = Vector3::Zero();   ///< on the first body [N]
  Vector3 moment = Vector3::Zero();  ///< likewise, about the joint, with that of its motor [N m]
  double value = 0;                  ///< angle [rad] or distance [m]; 0 for a joint without
};

/// @param gradient  of the whole potential, as `Potential::gradient` gives it [N]
std::vector<JointForce> joint_forces(const World& world, const Conditions& conditions,
                                     const VectorX& gradient, const VectorX& positions);

}  // namespace resilin
