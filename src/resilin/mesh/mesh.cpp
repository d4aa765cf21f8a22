#include "resilin/mesh/mesh.hpp"

#include <algorithm>

namespace resilin {
const CellBlock* Mesh::find_block(CellKind kind) const {
  const auto found =
      std::find_if(blocks.begin(), blocks.end(), [kind](const CellBlock& b) { return b.kind == kind; });
  return found == blocks.end() ? nullptr : &*found;
}

CellBlock& Mesh::block(CellKind kind) {
  const auto found =
      std::find_if(blocks.begin(), blocks.end(), [kind](const CellBlock& b) { return b.kind == kind; });
  if (found != blocks.end()) return *found;
  return blocks.emplace_back(CellBlock{kind, {}});
}

const CellBlock* Mesh::find_solid(int dim) const {
  const auto found = std::find_if(blocks.begin(), blocks.end(), [dim](const CellBlock& b) {
    return b.num_cells() > 0 && is_solid(b.kind, dim);
  });
  return found == blocks.end() ? nullptr : &*found;
}

const Group* Mesh::find_group(std::string_view group_name) const {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [group_name](const Group& g) { return g.name == group_name; });
  return found == groups.end() ? nullptr : &*found;
}

}  // namespace resilin
