#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "resilin/sensitivity/world_change.hpp"

namespace resilin {

/// A number, or an array of numbers, of a scene by which results may be differentiated.
struct Parameter {
  std::string name;                 ///< "body.beam.material.youngs_modulus"
  std::vector<Eigen::Index> shape;  ///< {}: one number; {num_cells}; {dim}; {num_vertices, dim}
  VectorX value;                    ///< as the scene has it, the last index the fastest

  /// Adds what a change of the numbers does to the world, which `ask` has made room for.
  std::function<void(const VectorX& change, WorldChange& world)> spread{};
  std::function<void(WorldChange& world)> ask{};
  /// The transpose of `spread`: adds to the slopes by the numbers.
  std::function<void(const WorldChange& world, VectorX& slopes)> gather{};
  /// Writes other numbers into a description of the same scene.
  std::function<void(const VectorX& value, Description& description)> set{};
};

/// Parameters of a scene, by the keys of a scene file with the names of bodies, loads and boundary
/// conditions:
///
///   body.NAME.material.CONSTANT        one number, or one for each cell where the scene has them
///   body.NAME.density, body.NAME.damping.KEY
///   body.NAME.region.REGION.material.CONSTANT, body.NAME.region.REGION.density
///   body.NAME.rest_positions           of the vertices, where they stand in the scene [m]
///   body.NAME.initial_positions, .initial_velocities    likewise
///   load.NAME.value, .stiffness, .displacement, .velocity
///   fix.NAME.displacement, .velocity, .gradient
///   collider.NAME.point (of a sphere or a box .center, of a mesh .translate), .velocity, .displacement
///   collider.NAME.friction, contact.friction, contact.pair.NUMBER.friction
///   simulation.gravity
///
/// Those by which this scene can be differentiated.
/// @param world  made of a description that it still has
std::vector<std::string> parameter_names(const World& world);

/// The parameter of this name. Throws InputError for an unknown one, which names the nearest, and for one by
/// which this scene cannot be differentiated.
Parameter find_parameter(const World& world, const std::string& name);

/// Names the elements that the world has chosen for "auto": with other numbers the choice may be another, and
/// results would jump.
/// @param world  made of this description
void keep_elements(Description& description, const World& world);

/// The parameter of this name, for so many numbers: as many as it has, or one for each cell in place of one.
/// Throws InputError as `find_parameter` does, and for another count.
Parameter find_parameter_of(const World& world, const std::string& name, Eigen::Index count);

/// The same scene with other numbers, by the names of their parameters.
Description with_values(const Description& description, const std::map<std::string, VectorX>& values);
/// Likewise. @param world  made of the description, which it still has
Description with_values(const World& world, const std::map<std::string, VectorX>& values);

}  // namespace resilin
