#include "resilin/mesh/mesh.hpp"

#include <algorithm>

namespace resilin {
namespace {

struct KindFacts {
  int num_nodes;
  int dimension;
  std::string_view name;
};

KindFacts facts(CellKind kind) {
  switch (kind) {
    case CellKind::point:
      return {1, 0, "points"};
    case CellKind::line:
      return {2, 1, "lines"};
    case CellKind::triangle:
      return {3, 2, "triangles"};
    case CellKind::quadrilateral:
      return {4, 2, "quadrilaterals"};
    case CellKind::tetrahedron:
      return {4, 3, "tetrahedra"};
    case CellKind::hexahedron:
      return {8, 3, "hexahedra"};
    case CellKind::prism:
      return {6, 3, "prisms"};
    case CellKind::pyramid:
      return {5, 3, "pyramids"};
    case CellKind::line3:
      return {3, 1, "second-order lines"};
    case CellKind::triangle6:
      return {6, 2, "second-order triangles"};
    case CellKind::tetrahedron10:
      return {10, 3, "second-order tetrahedra"};
  }
  return {1, 0, "points"};
}

}  // namespace

int num_nodes(CellKind kind) { return facts(kind).num_nodes; }
int dimension(CellKind kind) { return facts(kind).dimension; }
std::string_view name(CellKind kind) { return facts(kind).name; }

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

const Group* Mesh::find_group(std::string_view group_name) const {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [group_name](const Group& g) { return g.name == group_name; });
  return found == groups.end() ? nullptr : &*found;
}

}  // namespace resilin
