#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Names of vertices and cells in the file of a mesh, so that messages speak the file's language.
struct Numbering {
  std::string file = "mesh";           ///< opens every message
  std::string cell_word = "element";   ///< "element" in MSH, "cell" in VTK
  std::int64_t first_vertex = 0;       ///< number of vertex 0, when `vertices` is empty
  std::int64_t first_cell = 0;         ///< number of cell 0 of each block, when it has no list in `cells`
  std::vector<std::int64_t> vertices;  ///< number of each vertex; empty: counted from first_vertex
  std::vector<std::vector<std::int64_t>>
      cells;  ///< numbers of the cells of each block; may be shorter or empty

  std::int64_t vertex(Index i) const;
  std::int64_t cell(std::size_t block, Index i) const;

  /// "element 7", "elements 1, 3", "elements 1, 2, 3 and 40 more".
  std::string cell_list(std::size_t block, std::span<const Index> list) const;
  /// "vertex 5", "vertices 3 and 6", "vertices 1, 2, 3 and 40 more".
  std::string vertex_list(std::span<const Index> list) const;
};

}  // namespace resilin
