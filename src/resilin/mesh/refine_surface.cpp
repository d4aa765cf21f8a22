#include "resilin/mesh/refine_surface.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace resilin {
namespace {

using Corners = std::array<Index, 3>;

/// The vertex in the middle of each edge that is cut.
using Middles = std::map<std::pair<Index, Index>, Index>;

void cut_edges(Mesh& surface, const std::vector<Index>& nodes, double longest, Middles& middles) {
  for (std::size_t t = 0; t < nodes.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax({nodes[t + i], nodes[t + (i + 1) % 3]});
      const Vector3 A = surface.vertices[static_cast<std::size_t>(a)];
      const Vector3 B = surface.vertices[static_cast<std::size_t>(b)];
      if (!((B - A).norm() > longest)) continue;
      const auto middle = static_cast<Index>(surface.vertices.size());
      if (middles.try_emplace({a, b}, middle).second) surface.vertices.emplace_back(0.5 * (A + B));
    }
}

/// The pieces of a triangle between its corners and the middles of its cut edges, turned as it is.
std::vector<Corners> pieces_of(const Corners& corners, const Middles& middles) {
  std::array<Index, 3> middle{};  // middle of the edge behind each corner; -1 where it is whole
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = middles.find(std::minmax({corners[i], corners[(i + 1) % 3]}));
    middle[i] = found == middles.end() ? -1 : found->second;
    count += middle[i] >= 0 ? 1 : 0;
  }
  if (count == 0) return {corners};
  const auto& [m0, m1, m2] = middle;
  if (count == 3) return {{corners[0], m0, m2}, {m0, corners[1], m1}, {m2, m1, corners[2]}, {m0, m1, m2}};
  // Turned so that the first edge is cut and, of two, the second one, too.
  std::size_t first = 0;
  while (middle[first] < 0 || (count == 2 && middle[(first + 1) % 3] < 0)) ++first;
  const Index a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
  const Index ab = middle[first], bc = middle[(first + 1) % 3];
  if (count == 1) return {{a, ab, c}, {ab, b, c}};
  return {{ab, b, bc}, {a, ab, c}, {ab, bc, c}};
}

}  // namespace

void refine_surface(Mesh& surface, double longest, std::size_t most_triangles) {
  const auto found = std::ranges::find(surface.blocks, CellKind::triangle, &CellBlock::kind);
  if (found == surface.blocks.end()) return;
  CellBlock& block = *found;
  const auto number = static_cast<std::size_t>(found - surface.blocks.begin());
  while (true) {
    const std::size_t num_vertices = surface.vertices.size();
    Middles middles;
    cut_edges(surface, block.nodes, longest, middles);
    if (middles.empty()) return;
    std::vector<Index> finer;
    std::vector<std::vector<Index>> pieces(block.nodes.size() / 3);
    for (std::size_t t = 0; t < pieces.size(); ++t)
      for (const Corners& piece :
           pieces_of({block.nodes[3 * t], block.nodes[3 * t + 1], block.nodes[3 * t + 2]}, middles)) {
        pieces[t].push_back(static_cast<Index>(finer.size() / 3));
        finer.insert(finer.end(), piece.begin(), piece.end());
      }
    if (finer.size() / 3 > most_triangles) {
      surface.vertices.resize(num_vertices);
      return;
    }
    block.nodes = std::move(finer);
    for (Group& group : surface.groups) {
      if (group.cells.size() <= number) continue;
      std::vector<Index> cells;
      for (const Index t : group.cells[number])
        cells.insert(cells.end(), pieces[static_cast<std::size_t>(t)].begin(),
                     pieces[static_cast<std::size_t>(t)].end());
      group.cells[number] = std::move(cells);
    }
    std::erase_if(surface.cell_fields, [number](const CellField& field) { return field.block == number; });
  }
}

}  // namespace resilin
