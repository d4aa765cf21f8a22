#pragma once

#include <string>
#include <vector>

#include "resilin/sensitivity/derivatives.hpp"

/// Numbers of a frame that depend on the parameters not only through positions and velocities.
namespace resilin {

/// A number and its slopes by all that it depends on.
struct MeasuredNumber {
  double value = 0;
  VectorX by_positions{},
      by_velocities{};  ///< derivatives by positions and velocities of all nodes; empty: by none
  std::vector<VectorX> by_parameters{};  ///< with places and velocities held

  /// First-order change with the frame and the parameters.
  double change(const FrameChange& frame, const std::vector<VectorX>& parameters) const;
};

/// "elastic" and "kinetic".
std::vector<std::string> energy_kinds();

/// An energy [J] of a body, or of all bodies together; null: of all.
/// @throws InputError  for an unknown kind, and for a kinetic energy at rest
MeasuredNumber energy_at(Derivatives& run, const std::string& kind, const Body* body, int frame);

/// A component (`stress_components`) of the Cauchy stress [Pa] at points of a body at rest.
/// @throws InputError  for a point outside the body or an unknown component
std::vector<MeasuredNumber> stresses_at(Derivatives& run, const Body& body, const std::vector<Vector3>& at,
                                        const std::string& component, int frame);

/// A section of the scene by its name. Throws InputError at `place`.
const Section& section_named(const World& world, const std::string& name, const std::string& place);
/// The force [N] through a section: dim numbers.
/// @throws InputError  for an unknown section
std::vector<MeasuredNumber> section_force_at(Derivatives& run, const std::string& section, int frame);
/// Its moment [N m] about the centroid of the cut: three numbers, of which a plane has the last alone.
std::vector<MeasuredNumber> section_moment_at(Derivatives& run, const std::string& section, int frame);

/// The volume of a body as it is deformed [m^3], in 2D [m^2].
MeasuredNumber volume_at(Derivatives& run, const Body& body, int frame);

/// The names of all colliders of a scene.
std::vector<std::string> collider_names(const World& world);
/// The force of a collider on the bodies [N]: three numbers.
/// @throws InputError  for an unknown one, and for one with friction
std::vector<MeasuredNumber> collider_force_at(Derivatives& run, const std::string& collider, int frame);

}  // namespace resilin
