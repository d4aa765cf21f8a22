#include "resilin/mesh/topology.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <tuple>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"

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
  constexpr std::size_t cells_per_chunk = 4096, buckets_per_chunk = 4096;
  const auto num_sides = static_cast<int>(cell_sides(block.kind).size());
  const auto num_cells = static_cast<std::size_t>(block.num_cells());
  const std::size_t num_facets = num_cells * static_cast<std::size_t>(num_sides);
  const auto bytes = static_cast<double>(num_facets * sizeof(Keyed));
  if (!fits(bytes))
    foresee_memory(bytes, "finding the surface of " + std::to_string(block.num_cells()) + " cells",
                   what_would_fit(block.num_cells(), bytes, "cells") + ": take fewer, or raise the limit");
  const auto for_each_side = [&](const auto& use) {
    parallel_for(num_cells, cells_per_chunk, [&](std::size_t first, std::size_t last) {
      for (auto cell = static_cast<Index>(first); cell < static_cast<Index>(last); ++cell)
        for (int local = 0; local < num_sides; ++local)
          use(Keyed{sorted(facet_corners(block, {cell, local})), {cell, local}});
    });
  };
  // Counting sort by the largest node, then a short sort within each bucket, in whose order no two are equal.
  const Index num_nodes = block.nodes.empty() ? 0 : *std::ranges::max_element(block.nodes) + 1;
  std::vector<std::size_t> next(static_cast<std::size_t>(num_nodes) + 1, 0);
  for_each_side([&](const Keyed& f) {
    std::atomic_ref(next[static_cast<std::size_t>(f.key[3]) + 1]).fetch_add(1, std::memory_order_relaxed);
  });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Keyed> ordered;
  assign_zeros(ordered, num_facets);
  for_each_side([&](const Keyed& f) {
    const auto bucket = static_cast<std::size_t>(f.key[3]);
    ordered[std::atomic_ref(next[bucket]).fetch_add(1, std::memory_order_relaxed)] = f;
  });
  // Each bucket now ends where it says, and begins where the one before ends.
  parallel_for(next.size() - 1, buckets_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t bucket = first; bucket < last; ++bucket)
      std::sort(ordered.begin() + static_cast<std::ptrdiff_t>(bucket == 0 ? 0 : next[bucket - 1]),
                ordered.begin() + static_cast<std::ptrdiff_t>(next[bucket]),
                [](const Keyed& a, const Keyed& b) {
                  return std::tie(a.key, a.facet.cell, a.facet.local) <
                         std::tie(b.key, b.facet.cell, b.facet.local);
                });
  });
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
