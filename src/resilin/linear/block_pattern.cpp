#include "resilin/linear/block_pattern.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/found_rows.hpp"

namespace resilin {
namespace {

/// Chunks of rows with at least `slots_per_chunk` slots each; four times as many once there are enough
/// chunks. A matrix below two chunks stays whole.
std::vector<Index> chunk_rows(const BlockPattern& pattern, Offset slots_per_chunk) {
  constexpr Offset enough_chunks = 16;
  std::vector<Index> chunk_begin = {0};
  const Index num_nodes = pattern.num_nodes();
  const Offset num_chunks =
      std::max({Offset{1}, std::min(enough_chunks, pattern.num_slots() / slots_per_chunk),
                pattern.num_slots() / (4 * slots_per_chunk)});
  for (Offset chunk = 1; chunk < num_chunks; ++chunk) {
    const Offset target = pattern.num_slots() * chunk / num_chunks;
    const auto row = std::lower_bound(pattern.row_begin.begin(), pattern.row_begin.end(), target);
    const auto begin = static_cast<Index>(row - pattern.row_begin.begin());
    if (begin > chunk_begin.back() && begin < num_nodes) chunk_begin.push_back(begin);
  }
  chunk_begin.push_back(num_nodes);
  return chunk_begin;
}

BlockPattern::ProductPlan make_product_plan(const BlockPattern& pattern, Offset slots_per_chunk) {
  BlockPattern::ProductPlan plan;
  plan.chunk_begin = chunk_rows(pattern, slots_per_chunk);
  plan.targets = pattern.columns;
  plan.chunk_places = {0};
  const Index num_nodes = pattern.num_nodes();
  std::vector<std::pair<Index, Index>> node_and_place;
  std::vector<Index> place_of(static_cast<std::size_t>(num_nodes), -1);
  for (Index chunk = 0; chunk < plan.num_chunks(); ++chunk) {
    const Index first_place = plan.chunk_places.back();
    const Index end = plan.chunk_begin[chunk + 1];
    for (Offset s = pattern.row_begin[plan.chunk_begin[chunk]]; s < pattern.row_begin[end]; ++s) {
      const Index column = pattern.columns[s];
      if (column < end) continue;
      if (place_of[column] < first_place) {
        place_of[column] = static_cast<Index>(node_and_place.size());
        node_and_place.emplace_back(column, place_of[column]);
      }
      plan.targets[s] = num_nodes + place_of[column];
    }
    plan.chunk_places.push_back(static_cast<Index>(node_and_place.size()));
  }
  std::sort(node_and_place.begin(), node_and_place.end());
  plan.gather_begin.assign(static_cast<std::size_t>(num_nodes) + 1, 0);
  for (const auto& [node, place] : node_and_place) {
    ++plan.gather_begin[node + 1];
    plan.gather_places.push_back(place);
  }
  for (Index i = 0; i < num_nodes; ++i) plan.gather_begin[i + 1] += plan.gather_begin[i];
  return plan;
}

}  // namespace

Offset BlockPattern::find_slot(Index i, Index j) const {
  const auto begin = columns.begin() + row_begin[i];
  const auto end = columns.begin() + row_begin[i + 1];
  const auto found = std::lower_bound(begin, end, j);
  return found != end && *found == j ? found - columns.begin() : -1;
}

Offset BlockPattern::slot(Index i, Index j) const {
  const Offset found = find_slot(i, j);
  assert(found >= 0);
  return found;
}

void BlockPattern::complete(Offset slots_per_chunk) {
  product_plan = make_product_plan(*this, slots_per_chunk);
}

void BlockPatternBuilder::add_cells(std::vector<Index> nodes, int nodes_per_cell) {
  cells_.emplace_back(std::move(nodes), nodes_per_cell);
}

void BlockPatternBuilder::add_clique(std::span<const Index> nodes) {
  for (const Index i : nodes)
    for (const Index j : nodes)
      if (i < j) pairs_.emplace_back(i, j);
}

BlockPattern BlockPatternBuilder::build() const {
  // Node to cells, so that the neighbours of one node are found, sorted and stored at a time.
  BlockPattern pattern;
  std::vector<std::vector<Offset>> cells_begin(cells_.size());
  std::vector<std::vector<Index>> cells_of(cells_.size());
  for (std::size_t group = 0; group < cells_.size(); ++group) {
    const auto& [nodes, per_cell] = cells_[group];
    std::vector<Offset>& begin = cells_begin[group];
    begin.assign(static_cast<std::size_t>(num_nodes_) + 1, 0);
    for (const Index node : nodes) ++begin[node + 1];
    for (Index i = 0; i < num_nodes_; ++i) begin[i + 1] += begin[i];
    cells_of[group].resize(nodes.size());
    std::vector<Offset> next(begin.begin(), begin.end() - 1);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      cells_of[group][next[nodes[k]]++] = static_cast<Index>(k / static_cast<std::size_t>(per_cell));
  }
  std::vector<std::pair<Index, Index>> pairs = pairs_;
  for (auto& [i, j] : pairs)
    if (i > j) std::swap(i, j);
  std::sort(pairs.begin(), pairs.end());

  pattern.row_begin.assign(1, 0);
  const auto couple_rows = [&](std::size_t first, std::size_t last) {
    FoundRows rows;
    auto pair = std::lower_bound(pairs.begin(), pairs.end(), std::pair(static_cast<Index>(first), Index{-1}));
    for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i) {
      const auto begin = static_cast<Offset>(rows.columns.size());
      const auto couple = [&](Index j) {
        if (j >= i) rows.columns.push_back(j);
      };
      couple(i);
      for (std::size_t group = 0; group < cells_.size(); ++group) {
        const auto& [nodes, per_cell] = cells_[group];
        for (Offset k = cells_begin[group][i]; k < cells_begin[group][i + 1]; ++k)
          for (int corner = 0; corner < per_cell; ++corner)
            couple(nodes[static_cast<std::size_t>(cells_of[group][k]) * per_cell + corner]);
      }
      for (; pair != pairs.end() && pair->first == i; ++pair) couple(pair->second);
      std::sort(rows.columns.begin() + begin, rows.columns.end());
      rows.columns.erase(std::unique(rows.columns.begin() + begin, rows.columns.end()), rows.columns.end());
      rows.end_row();
    }
    return rows;
  };
  constexpr std::size_t rows_per_chunk = 1024;
  parallel_in_order(
      static_cast<std::size_t>(num_nodes_), rows_per_chunk, couple_rows,
      [&](std::size_t, const FoundRows& rows) { rows.append_to(pattern.row_begin, pattern.columns); });
  constexpr Offset most_slots = std::numeric_limits<Index>::max();
  if (pattern.num_slots() > most_slots)
    throw InputError("mesh", "at most " + std::to_string(most_slots) + " coupled pairs of nodes",
                     std::to_string(pattern.num_slots()), "take fewer cells");
  pattern.columns.shrink_to_fit();
  pattern.complete();
  return pattern;
}

}  // namespace resilin
