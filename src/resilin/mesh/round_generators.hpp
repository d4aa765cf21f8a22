#pragma once

#include <array>
#include <string_view>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Round bodies that a scene can describe without a file.
enum class RoundKind { disc, ring, cylinder, tube, ball, spherical_shell };
constexpr std::array<std::string_view, 6> spellings(RoundKind) {
  return {"disc", "ring", "cylinder", "tube", "ball", "spherical_shell"};
}

/// A round body about the origin; cylinders and tubes stand on the plane z = 0.
struct RoundShape {
  RoundKind kind = RoundKind::disc;
  double radius = 1;          ///< the outer one [m]
  double inner_radius = 0;    ///< inner radius of a ring, a tube and a spherical shell [m]
  double height = 1;          ///< height of a cylinder and a tube [m]
  double degrees = 360;       ///< how much of a ring or tube there is, from the x axis on
  int radial_cells = 4;       ///< through the wall; of a disc, cylinder and ball along the radius
  int around_cells = 16;      ///< cells along a circle of a ring, tube and spherical shell
  int axial_cells = 4;        ///< along the height
  double grading = 1;         ///< thickness of the outermost cell by that of the innermost one
  bool is_cut = true;         ///< into tetrahedra or triangles, in place of hexahedra or quadrilaterals
  bool is_quadratic = false;  ///< cut cells get nodes in the middles of edges, on the true circle or sphere
};

/// Measures that a round body needs.
bool has_hole(RoundKind kind);  ///< needs an inner radius
bool has_height(RoundKind kind);
int dimension(RoundKind kind);

/// Groups: "body" (all cells), "outer", "inner" (of a hole), "bottom" and "top" (of a height), "start" and
/// "end" (of less than a full circle). Discs and balls have a core of squares and cubes.
Mesh make_round(const RoundShape& shape);

}  // namespace resilin
