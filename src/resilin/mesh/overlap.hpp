#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "resilin/mesh/topology.hpp"

namespace resilin {

/// Solid cells of one kind at some positions, by their corners.
struct PlacedCells {
  CellKind kind;
  std::span<const Index> nodes;       ///< num_nodes(kind) for each cell
  std::span<const double> positions;  ///< positions of all nodes, dimension(kind) numbers each [m]
};

/// Two cells that share space.
struct Overlap {
  Index cell, other;
  Vector3 place;  ///< about where [m]
};

/// The first cell that shares space with one of other cells, and the first such; none where they only touch.
/// Sides are taken as flat, those of hexahedra as two triangles each; cells may be inverted. Cells are apart
/// when one of them has to be moved by less than 1e-3 of its size to part them, so that rounded coordinates
/// are no overlap.
std::optional<Overlap> find_overlap(const PlacedCells& cells, const PlacedCells& others);

/// Components of one body that share space.
struct ComponentOverlap {
  std::array<Index, 2> components;
  std::array<Index, 2> cells;  ///< cells of these, in the block
};
/// At most so many of them.
std::vector<ComponentOverlap> overlapping_components(const Mesh& mesh, const CellBlock& block,
                                                     const Components& components, std::size_t most);

}  // namespace resilin
