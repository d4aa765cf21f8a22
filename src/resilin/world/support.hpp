#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/energy.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// Nodes whose displacement is prescribed, whole or by component.
struct Support {
  std::string place;
  std::string name;          ///< reactions are reported under it
  std::vector<Index> nodes;  ///< nodes of the world
  std::array<bool, 3> components = {true, true, true};
  Vector3 displacement = Vector3::Zero();
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  std::optional<Rotation> rotate;
  Vector3 velocity = Vector3::Zero();
  std::optional<double> until;
  TimeFunction
      time_function;  ///< time function of displacement, gradient and rotate; in place of the load factor
  std::vector<double> switches;  ///< see FixDescription [s]
  bool reports_stiffness = false;
  bool holds = true;  ///< in the present phase (support_phase.hpp)

  /// Whether it holds right after a time, by its `switches`.
  bool holds_after(double time) const;
  /// Whether anything leads it elsewhere.
  bool moves() const;

  /// Prescribed position of a node with reference position X [m].
  Vector3 target(const Vector3& X, const Conditions& c) const;
  /// The angle that it turns by between these conditions, up and down [degrees].
  double turn_between(const Conditions& from, const Conditions& to) const;
  /// Its velocity [m/s] and acceleration [m/s^2], from before a jump.
  Vector3 velocity_at(const Vector3& X, double time) const;
  Vector3 acceleration_at(const Vector3& X, double time) const;
};

/// Prescribed DOFs and their boundary conditions, of those that hold: dim numbers per node, -1 where free.
std::vector<std::int32_t> supports_of_unknowns(int dim, Index num_nodes,
                                               const std::vector<Support>& supports);

/// Throws InputError when two supports ask for different places of one unknown; names the vertex and both.
void check_support_conflicts(int dim, const std::vector<Support>& supports, const VectorX& rest_positions);

/// No step turns a support by more [degrees]: beyond half a turn the straight way to its end would be the way
/// back, and long before it leads through the axis.
constexpr double largest_turn_of_step = 60;

/// Number of equal rotation steps for an angle [degrees]; at least 1.
int num_steps_of_turn(double degrees);

/// A turn without a time function that is too far for one step.
bool turns_at_once(const FixDescription& fix);

/// The largest angle that any of them turns by between these conditions [degrees].
double largest_turn(const std::vector<Support>& supports, const Conditions& from, const Conditions& to);

/// Writes the prescribed places into `x`.
/// @param places  from which supports move their nodes
void place_supports(int dim, const std::vector<Support>& supports, const VectorX& places, const Conditions& c,
                    VectorX& x);

/// The same with the velocities [m/s] and accelerations [m/s^2] of the prescribed motion.
void place_supports(int dim, const std::vector<Support>& supports, const VectorX& places, double time,
                    Motion& motion);

}  // namespace resilin
