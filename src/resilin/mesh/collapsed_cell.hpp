#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "resilin/mesh/cell_kind.hpp"

namespace resilin {

/// A cell whose corners all differ.
struct CellOfCorners {
  CellKind kind;
  std::array<Index, max_cell_nodes> nodes{};

  std::span<const Index> all() const {
    return std::span(nodes).first(static_cast<std::size_t>(num_nodes(kind)));
  }
};

/// Sides of a tetrahedron, pyramid, prism or hexahedron, outward for a positive volume, each by the vertices
/// that differ; those of fewer than three are left out.
std::vector<std::vector<Index>> sides_of_different_corners(CellKind kind, std::span<const Index> nodes);

/// Programs that have only hexahedra give a wedge as a hexahedron two of whose edges are collapsed to a
/// vertex each, a pyramid or a tetrahedron likewise, and a triangle as a quadrilateral that names a corner
/// twice.
/// @return the cell that is meant; empty where all corners differ or what is left is none of our kinds
std::optional<CellOfCorners> cell_of_different_corners(CellKind kind, std::span<const Index> nodes);

}  // namespace resilin
