#pragma once

#include <array>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Division of a cube of the box into tetrahedra.
enum class TetPattern {
  kuhn6,  ///< six around the diagonal from corner 0 to corner 7: (0,1,3,7), (0,1,7,5), (0,5,7,4), (0,3,2,7),
          ///< (0,2,6,7), (0,6,4,7)
  five    ///< five, one of them in the middle; mirrored from cube to cube so that neighbours fit
};

/// Division of a cell of the rectangle into triangles.
enum class TrianglePattern {
  uniform,     ///< quad (a,b,c,d), counter-clockwise from the lower left: (a,b,c), (a,c,d)
  alternating  ///< every other quad, as on a chessboard, has the other diagonal: (a,b,d), (b,c,d)
};

/// A box of tetrahedra with node number i + (nx+1) (j + (ny+1) k) and cube corner c = i + 2j + 4k. Its groups
/// are "body" (all cells) and the sides "x_min", "x_max", "y_min", ... (outward facets).
///
/// @param size   edge lengths [m], positive
/// @param cells  number of cubes along x, y, z, at least 1
/// @param origin corner with the smallest coordinates [m]
Mesh make_box(const Vector3& size, const std::array<int, 3>& cells, const Vector3& origin = Vector3::Zero(),
              TetPattern pattern = TetPattern::kuhn6);

/// A rectangle of triangles in the plane z = 0 with node number i + (nx+1) j; groups "body", "x_min",
/// "x_max", "y_min", "y_max" (lines with the rectangle on their left).
Mesh make_rectangle(const Vector<2>& size, const std::array<int, 2>& cells,
                    const Vector<2>& origin = Vector<2>::Zero(),
                    TrianglePattern pattern = TrianglePattern::uniform);

/// The same box of hexahedra, one for each cube, and rectangle of quadrilaterals.
Mesh make_hexahedron_box(const Vector3& size, const std::array<int, 3>& cells,
                         const Vector3& origin = Vector3::Zero());
Mesh make_quadrilateral_rectangle(const Vector<2>& size, const std::array<int, 2>& cells,
                                  const Vector<2>& origin = Vector<2>::Zero());

}  // namespace resilin
