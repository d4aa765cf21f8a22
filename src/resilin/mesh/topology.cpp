#include "resilin/mesh/topology.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "resilin/core/memory.hpp"

namespace resilin {
namespace {

std::array<Index, 4> sorted(std::array<Index, 4> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// Sets that merge, with the smallest member as their name.
class UnionFind {
 public:
  explicit UnionFind(Index size) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  Index root(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void merge(Index a, Index b) {
    a = root(a);
    b = root(b);
    parent(std::max(a, b)) = std::min(a, b);
  }

 private:
  Index& parent(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

/// Numbers the components 0, 1, ... in the order in which cells meet them; `root_of_cell` names the set of a
/// cell.
template <class RootOfCell>
Components number_components(Index num_cells, Index num_sets, const RootOfCell& root_of_cell) {
  Components result;
  std::vector<Index> number_of_root(static_cast<std::size_t>(num_sets), -1);
  for (Index cell = 0; cell < num_cells; ++cell) {
    Index& number = number_of_root[static_cast<std::size_t>(root_of_cell(cell))];
    if (number < 0) number = result.count++;
    result.of_cell.push_back(number);
  }
  return result;
}

}  // namespace

std::array<Index, 4> facet_corners(const CellBlock& block, Facet facet) {
  const auto nodes = block.cell(facet.cell);
  std::array<Index, 4> corners = {-1, -1, -1, -1};
  const CellSide& side = cell_sides(block.kind)[static_cast<std::size_t>(facet.local)];
  for (std::size_t i = 0; i < side.corners().size(); ++i)
    corners[i] = nodes[static_cast<std::size_t>(side.nodes[i])];
  return corners;
}

void visit_facets(const CellBlock& block, const std::function<void(std::span<const Facet>)>& visit) {
  struct Keyed {
    std::array<Index, 4> key;
    Facet facet;
  };
  const auto num_sides = static_cast<int>(cell_sides(block.kind).size());
  const std::size_t num_facets =
      static_cast<std::size_t>(block.num_cells()) * static_cast<std::size_t>(num_sides);
  const double bytes = 2.0 * static_cast<double>(num_facets * sizeof(Keyed));  // in both orders
  if (!fits(bytes))
    foresee_memory(bytes, "finding the surface of " + std::to_string(block.num_cells()) + " cells",
                   what_would_fit(block.num_cells(), bytes, "cells") + ": take fewer, or raise the limit");
  std::vector<Keyed> facets;
  facets.reserve(num_facets);
  Index largest = -1;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    for (int local = 0; local < num_sides; ++local) {
      const auto key = sorted(facet_corners(block, {cell, local}));
      largest = std::max(largest, key[3]);
      facets.push_back({key, {cell, local}});
    }
  }
  // Counting sort by the largest node, then a short sort within each bucket.
  std::vector<std::size_t> begin(static_cast<std::size_t>(largest) + 2, 0);
  for (const Keyed& f : facets) ++begin[static_cast<std::size_t>(f.key[3]) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Keyed> ordered(facets.size());
  std::vector<std::size_t> next = begin;
  for (const Keyed& f : facets) ordered[next[static_cast<std::size_t>(f.key[3])]++] = f;

  const auto at = [&](std::size_t i) { return ordered.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t bucket = 0; bucket + 1 < begin.size(); ++bucket) {
    std::stable_sort(at(begin[bucket]), at(begin[bucket + 1]),
                     [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
  }
  std::vector<Facet> uses;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    uses.push_back(ordered[i].facet);
    if (i + 1 < ordered.size() && ordered[i + 1].key == ordered[i].key) continue;
    visit(uses);
    uses.clear();
  }
}

Boundary boundary(const CellBlock& block) {
  const std::span<const CellSide> sides = cell_sides(block.kind);
  Boundary result{{sides.empty() ? CellKind::triangle : sides[0].kind, {}}, {}};
  visit_facets(block, [&](std::span<const Facet> uses) {
    if (uses.size() == 1) result.owners.push_back(uses[0]);
  });
  std::sort(result.owners.begin(), result.owners.end(),
            [](Facet a, Facet b) { return a.cell != b.cell ? a.cell < b.cell : a.local < b.local; });
  for (const Facet& owner : result.owners) {
    const auto nodes = block.cell(owner.cell);
    for (const int local : sides[static_cast<std::size_t>(owner.local)].all())
      result.facets.nodes.push_back(nodes[static_cast<std::size_t>(local)]);
  }
  return result;
}

Boundary visible_facets(const CellBlock& block) {
  if (dimension(block.kind) == 3) return boundary(block);
  Boundary result{block, {}};
  for (Index cell = 0; cell < block.num_cells(); ++cell) result.owners.push_back({cell, -1});
  return result;
}

std::vector<std::array<Index, 2>> edges(const CellBlock& block) {
  std::vector<std::array<Index, 2>> result;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    const auto nodes = block.cell(cell);
    for (const auto& [i, j] : cell_edges(block.kind)) {
      const Index a = nodes[static_cast<std::size_t>(i)], b = nodes[static_cast<std::size_t>(j)];
      result.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Components connected_components(const CellBlock& block, Index num_vertices) {
  UnionFind sets(num_vertices);
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    const auto nodes = block.cell(cell);
    for (const Index node : nodes) sets.merge(nodes[0], node);
  }
  Components result = number_components(block.num_cells(), num_vertices,
                                        [&](Index cell) { return sets.root(block.cell(cell)[0]); });
  result.of_vertex.assign(static_cast<std::size_t>(num_vertices), -1);
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    for (const Index node : block.cell(cell)) {
      result.of_vertex[static_cast<std::size_t>(node)] = result.of_cell[static_cast<std::size_t>(cell)];
    }
  }
  return result;
}

std::vector<bool> used_vertices(const CellBlock& block, Index num_vertices) {
  std::vector<bool> is_used(static_cast<std::size_t>(num_vertices), false);
  for (const Index node : block.nodes) is_used[static_cast<std::size_t>(node)] = true;
  return is_used;
}

}  // namespace resilin
