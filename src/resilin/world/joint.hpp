#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/joint_damper.hpp"
#include "resilin/energy/joint_spring.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

class World;
struct State;

/// A joint in a world: linear equations between nodes, which are eliminated, and stiff energies of whatever
/// is not linear.
struct Joint {
  struct Arm {
    CarriedPoint place;
    double weight;
  };
  /// The weighted sum of the nodes' displacements is zero, in one direction or in all.
  struct Row {
    std::vector<Arm> arms;            ///< points of the first body on which its force acts
    std::vector<WeightedNode> nodes;  ///< those of the first body less those of the second one
    std::optional<Vector3> direction{};
  };
  /// Points that a body carries: `at` of the joint, and a length beside it along the axis and across.
  struct Frame {
    CarriedPoint at, axis, along, across;
  };

  std::string name;
  JointKind kind = JointKind::ball;
  std::vector<std::size_t> bodies{};  ///< numbers of one or two
  std::vector<Row> rows{};
  CarriedPoint at{};  ///< by the first body
  bool has_frames = false;
  double length = 1;  ///< length beside `at` in the frames [m]
  /// For the second body (the first, where the other one is the ground) and what it moves against.
  Frame moved{}, fixed{};
  Terms terms{};                        ///< all energies of the joint
  std::vector<JointCoordinate> gaps{};  ///< kept at zero by stiff ones of these [m]
  std::shared_ptr<const Cable> distance{};
  double rest_distance = 0;  ///< [m]
  std::shared_ptr<const JointDamper> damper{};
  std::vector<HeldDirection> held{};  ///< by the energies and by equations with a direction
};

/// Force and value of a joint in a state.
struct JointForce {
  std::string name;
  Vector3 force = Vector3::Zero();   ///< on the first body [N]
  Vector3 moment = Vector3::Zero();  ///< likewise, about the joint [N m]
  double value = 0;                  ///< angle [rad], way or distance [m]; 0 for a joint without
  std::optional<double> angle{};     ///< the second value of a joint with two [rad]
  double gap = 0;                    ///< by how much the joint is open [m]
};

/// @param gradient  of the whole potential, as `Potential::gradient` gives it [N]
std::vector<JointForce> joint_forces(const World& world, const Conditions& conditions,
                                     const VectorX& gradient, const State& state);

}  // namespace resilin
