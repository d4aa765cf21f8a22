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

namespace {

bool are_below(const std::vector<Index>& numbers, std::size_t end) {
  return std::ranges::all_of(
      numbers, [end](Index number) { return number >= 0 && static_cast<std::size_t>(number) < end; });
}

bool is_whole_block(const CellBlock& block, std::size_t num_vertices) {
  return block.kind >= CellKind::point && block.kind <= CellKind::tetrahedron10 &&
         block.nodes.size() % static_cast<std::size_t>(num_nodes(block.kind)) == 0 &&
         are_below(block.nodes, num_vertices);
}

bool is_whole_group(const Group& group, const Mesh& mesh) {
  if (group.cells.size() > mesh.blocks.size() || !are_below(group.vertices, mesh.vertices.size()))
    return false;
  for (std::size_t b = 0; b < group.cells.size(); ++b)
    if (!are_below(group.cells[b], static_cast<std::size_t>(mesh.blocks[b].num_cells()))) return false;
  return true;
}

}  // namespace

bool Mesh::is_whole() const {
  return std::ranges::all_of(blocks,
                             [&](const CellBlock& b) { return is_whole_block(b, vertices.size()); }) &&
         std::ranges::all_of(groups, [&](const Group& group) { return is_whole_group(group, *this); }) &&
         std::ranges::all_of(cell_fields,
                             [&](const CellField& field) { return field.block < blocks.size(); });
}

}  // namespace resilin
