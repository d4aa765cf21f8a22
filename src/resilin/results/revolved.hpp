#pragma once

#include <filesystem>

#include "resilin/io/vtu.hpp"

namespace resilin {

/// Angle and fineness of a revolved body.
struct Revolution {
  double angle = 270;  ///< total turn [degree], above 0, at most 360
  int sectors = 48;    ///< cells around the turn, at least 3
};

/// An axisymmetric frame as a solid: its half section, with radius x and axis y, turned about the axis. The
/// axis stays the y axis; the section at angle t lies at (x cos t, y, -x sin t). Triangles become prisms
/// (triangles of second order four of them), quadrilaterals hexahedra, lines quadrilaterals; points are left
/// out.
///
/// Vectors and tensors turn with the section, scalars and principal values are copied; arrays that are no
/// field (the number of the body) are copied too. Internal variables are left out.
/// @throws std::invalid_argument  where the angle or the number of sectors is out of its range
VtuContent revolved(const VtuContent& section, const Revolution& revolution);

/// Writes all frames of an axisymmetric run as revolved bodies, and its colliders: DIR/revolved/0000.vtu ...,
/// collider_0000.vtu ..., and the lists revolved.pvd and revolved_colliders.pvd.
/// @return                number of frames
/// @throws InputError     when the folder has no frames, or they are not axisymmetric
std::size_t write_revolved(const std::filesystem::path& folder, const Revolution& revolution);

}  // namespace resilin
