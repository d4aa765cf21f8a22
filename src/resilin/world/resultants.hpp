#pragma once

#include <optional>
#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// Selection of a load or a boundary condition, and the resultant of a load.
struct Resultant {
  std::string name;
  std::string kind;     ///< "fix", or the kind of the load: "traction", "gravity", ...
  Index num_nodes = 0;  ///< number of selected nodes
  Index num_facets = 0;
  double area = 0;         ///< area of the facets at rest [m^2]; in 2D [m] on unit thickness
  bool has_depth = false;  ///< whether the area is one of a thickness or of a full turn: [m^2] in 2D, too
  Vector3 center =
      Vector3::Zero();             ///< centroid of the area, or the mean of the nodes; the scene's frame [m]
  std::optional<Vector3> force{};  ///< force of a load at factor 1 on the rest shape [N]; none of a spring
  Vector3 moment = Vector3::Zero();  ///< about the centre [N m]
};

/// Resultants of all loads and of gravity, in the order of the terms.
std::vector<Resultant> load_resultants(const World& world);

/// Selection of each boundary condition.
std::vector<Resultant> fixed_selections(const World& world);

/// "traction on 12 facets (20 nodes, 0.0002 m^2) about (0, 0, 0.1): force (0, 0, -50) N, moment ..."
std::string describe(const Resultant& resultant, int dim);

/// One line for each load on opposite sides of a body, but for pressures.
std::vector<std::string> opposite_side_warnings(const World& world);

}  // namespace resilin
