#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/mesh/cell_kind.hpp"

namespace resilin {

/// All cells of one kind.
struct CellBlock {
  CellKind kind;
  std::vector<Index> nodes;  ///< num_nodes(kind) per cell, 0-based

  Index num_cells() const { return static_cast<Index>(nodes.size()) / num_nodes(kind); }
  std::span<const Index> cell(Index i) const {
    const auto n = static_cast<std::size_t>(num_nodes(kind));
    return std::span(nodes).subspan(static_cast<std::size_t>(i) * n, n);
  }
};

/// A named set of cells, one list for each block of the mesh (a physical group of MSH), and of vertices.
struct Group {
  std::string name;
  std::vector<std::vector<Index>>
      cells;                    ///< cells[block] = cell numbers in that block; may be shorter than blocks
  std::vector<Index> vertices;  ///< sorted, unique: all nodes of its cells and points
};

/// One number per cell of block `block`, such as a stiffness.
struct CellField {
  std::string name;
  std::size_t block = 0;
  std::vector<double> values;
};

/// Vertices and cells as a file gives them. In 2D the third coordinate is zero.
struct Mesh {
  std::vector<Vector3> vertices;  ///< [m]
  std::vector<CellBlock> blocks;  ///< at most one for each kind
  std::vector<Group> groups;
  std::vector<CellField> cell_fields;

  const CellBlock* find_block(CellKind kind) const;
  CellBlock& block(CellKind kind);  ///< the block of this kind, made when there is none
  /// The cells that a body of this dimension is made of; the first such block, nullptr when there is none.
  const CellBlock* find_solid(int dim) const;
  const Group* find_group(std::string_view group_name) const;

  /// Whether every number that stands for a vertex, a cell or a block is that of one.
  bool is_whole() const;
};

}  // namespace resilin
