#pragma once

#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// A surface of triangles as the rim of a solid: every place once, no triangle twice or collapsed,
/// neighbours wound alike.
struct SolidSurface {
  Mesh mesh;                       ///< triangles alone
  double area = 0;                 ///< [m^2]
  double volume = 0;               ///< volume inside; a guess for an open surface [m^3]
  Index num_turned = 0;            ///< triangles that were wound against their neighbours
  std::size_t num_open_edges = 0;  ///< edges of one triangle only
  double open_share = 0;           ///< least area of lids on its holes, by its own; 1 for a flat sheet

  const CellBlock& triangles() const { return mesh.blocks[0]; }
};

/// Whether triangles go along each edge as often one way as the other: their winding number is a whole number
/// at every point off them.
bool is_closed(const CellBlock& triangles);

/// A ball around the rim of a hole.
struct OpenRim {
  Vector3 center;
  double radius;  ///< [m]
};
/// Around connected edges along which triangles go more often one way than the other; none where the surface
/// is closed.
std::vector<OpenRim> open_rims(const Mesh& mesh, const CellBlock& triangles);

/// For each patch of connected triangles the winding of most of its area stays, so that the skin of a
/// cavity, which is wound the other way, stays one.
///
/// @param name  of the file, opens every message
/// @throws InputError  when there are no triangles, or none with an area, or coordinates too large to compute
/// with
SolidSurface make_solid_surface(const Mesh& mesh, const std::string& name);

/// @throws InputError  when the surface is an open sheet or encloses no volume
void require_volume(const SolidSurface& surface, const std::string& name);

/// Holes and turned triangles, one line each.
std::vector<std::string> remarks_on(const SolidSurface& surface, const std::string& name);

}  // namespace resilin
