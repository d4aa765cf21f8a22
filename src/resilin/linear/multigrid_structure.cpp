#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <limits>
#include <numeric>
#include <span>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/found_rows.hpp"
#include "resilin/linear/multigrid_level.hpp"
#include "resilin/linear/ordering.hpp"

/// Data of a level, and of its transfer to the next, that depend on its pattern alone.
namespace resilin {
namespace {

constexpr std::size_t fine_rows_at_once = 2048, coarse_rows_at_once = 128;

}  // namespace

bool MultigridLevel::connect(Aggregates& groups, MultigridLevel& coarse) {
  if (!find_lower_places() || !find_prolongation(groups)) return false;
  const ProductRows product = find_product_rows(groups.count);
  const NodeGraph graph = couple_groups(product);
  SweepOrder order = two_color_order(graph, coarse.least_couplings());
  if (!find_coarse_rows(product, graph, order, coarse)) return false;
  coarse.sweeps = std::move(order.chunks);
  coarse.along_layers = std::move(order.along_layers);
  const std::vector<Index> number = inverse_of(order.node_at);
  for (Index& group : groups.of_node)
    if (group >= 0) group = number[group];
  for (Index& group : prolongation_columns) group = number[group];
  color_transfers(groups.count);
  narrow_the_places();
  prolongation.resize(prolongation_columns.size() * static_cast<std::size_t>(block_size() * num_modes()) +
                          static_cast<std::size_t>(lanes_of(num_modes())),
                      static_cast<std::size_t>(num_nodes()));
  return true;
}

/// Places of the upper entries in their rows, by the lower ones that are their transposes.
bool MultigridLevel::find_lower_places() {
  std::vector<std::uint16_t>& places = wide_places.lower;
  places.resize(columns.size());
  std::vector<Offset> next(lower.begin.begin(), lower.begin.end() - 1);
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset begin = row_begin[i], end = row_begin[i + 1];
    if (end - begin > std::numeric_limits<std::uint16_t>::max()) return false;
    for (Offset k = begin; k < end; ++k) places[next[columns[k]]++] = static_cast<std::uint16_t>(k - begin);
  }
  return true;
}

/// A node reaches the groups of its neighbours, in the order in which they come.
bool MultigridLevel::find_prolongation(const Aggregates& groups) {
  prolongation_begin.assign(1, 0);
  prolongation_columns.clear();
  const FullPattern pattern = full();
  constexpr auto none = std::numeric_limits<std::uint16_t>::max();
  std::vector<std::uint16_t>& places = wide_places.smoothing;
  places.reserve(pattern.num_entries());
  struct Rows : FoundRows {
    std::vector<std::uint16_t> places;
  };
  const auto find = [&](std::size_t first, std::size_t last) {
    Rows rows;
    std::vector<Offset> entry_of(static_cast<std::size_t>(groups.count), -1);
    for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i) {
      const auto begin = static_cast<Offset>(rows.columns.size());
      pattern.for_row(i, [&](Index j) {
        const Index group = groups.of_node[j];
        rows.places.push_back(none);
        if (group < 0 || groups.of_node[i] < 0) return;
        if (entry_of[group] < begin) {
          entry_of[group] = static_cast<Offset>(rows.columns.size());
          rows.columns.push_back(group);
        }
        rows.places.back() = static_cast<std::uint16_t>(entry_of[group] - begin);
      });
      rows.end_row();
    }
    return rows;
  };
  parallel_in_order(static_cast<std::size_t>(num_nodes()), fine_rows_at_once, find,
                    [&](std::size_t, const Rows& rows) {
                      rows.append_to(prolongation_begin, prolongation_columns);
                      places.insert(places.end(), rows.places.begin(), rows.places.end());
                    });
  for (std::size_t i = 0; i + 1 < prolongation_begin.size(); ++i)
    if (prolongation_begin[i + 1] - prolongation_begin[i] > none) return false;
  prolongation_columns.shrink_to_fit();
  return true;
}

/// Rows of A P: the groups that the neighbours of a node reach.
MultigridLevel::ProductRows MultigridLevel::find_product_rows(Index num_groups) {
  ProductRows product;
  product.begin.assign(1, 0);
  const FullPattern pattern = full();
  const auto find = [&](std::size_t first, std::size_t last) {
    FoundRows rows;
    std::vector<Index> seen_in_row(static_cast<std::size_t>(num_groups), -1);
    for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i) {
      pattern.for_row(i, [&](Index j) {
        for (Offset k = prolongation_begin[j]; k < prolongation_begin[j + 1]; ++k) {
          const Index group = prolongation_columns[k];
          if (seen_in_row[group] == i) continue;
          seen_in_row[group] = i;
          rows.columns.push_back(group);
        }
      });
      rows.end_row();
    }
    return rows;
  };
  parallel_in_order(
      static_cast<std::size_t>(num_nodes()), fine_rows_at_once, find,
      [&](std::size_t, const FoundRows& rows) { rows.append_to(product.begin, product.columns); });
  target_begin.assign(1, 0);
  widest_product_ = 0;
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset width = product.begin[i + 1] - product.begin[i];
    widest_product_ = std::max(widest_product_, static_cast<std::size_t>(width));
    target_begin.push_back(target_begin.back() + width * (prolongation_begin[i + 1] - prolongation_begin[i]));
  }

  product.reach_begin.assign(static_cast<std::size_t>(num_groups) + 1, 0);
  for (const Index group : prolongation_columns) ++product.reach_begin[group + 1];
  std::partial_sum(product.reach_begin.begin(), product.reach_begin.end(), product.reach_begin.begin());
  product.reach_nodes.resize(prolongation_columns.size());
  product.reach_targets.resize(prolongation_columns.size());
  std::vector<Offset> next(product.reach_begin.begin(), product.reach_begin.end() - 1);
  for (Index i = 0; i < num_nodes(); ++i)
    for (Offset k = prolongation_begin[i]; k < prolongation_begin[i + 1]; ++k) {
      const Offset at = next[prolongation_columns[k]]++;
      product.reach_nodes[at] = i;
      const Offset width = product.begin[i + 1] - product.begin[i];
      product.reach_targets[at] = target_begin[i] + width * (k - prolongation_begin[i]);
    }
  return product;
}

/// Couplings of groups in P^T A P.
NodeGraph MultigridLevel::couple_groups(const ProductRows& product) {
  const auto num_groups = static_cast<Index>(product.reach_begin.size()) - 1;
  const auto couple = [&](std::size_t first, std::size_t last) {
    FoundRows rows;
    std::vector<Index> seen_in_row(static_cast<std::size_t>(num_groups), -1);
    for (auto group = static_cast<Index>(first); group < static_cast<Index>(last); ++group) {
      const auto begin = static_cast<Offset>(rows.columns.size());
      product.for_each(group, [&](Index column, Offset) {
        if (column == group || seen_in_row[column] == group) return;
        seen_in_row[column] = group;
        rows.columns.push_back(column);
      });
      std::sort(rows.columns.begin() + begin, rows.columns.end());
      rows.end_row();
    }
    return rows;
  };
  NodeGraph graph;
  graph.begin.assign(1, 0);
  parallel_in_order(
      static_cast<std::size_t>(num_groups), coarse_rows_at_once, couple,
      [&](std::size_t, const FoundRows& rows) { rows.append_to(graph.begin, graph.neighbours); });
  return graph;
}

/// Upper rows of P^T A P in the order given, and to which of their blocks every product of a fine node is
/// added.
bool MultigridLevel::find_coarse_rows(const ProductRows& product, const NodeGraph& graph,
                                      const SweepOrder& order, MultigridLevel& coarse) {
  const Index num_groups = graph.num_nodes();
  const std::vector<Index> number = inverse_of(order.node_at);
  coarse.row_begin.assign(1, 0);
  coarse.columns.clear();
  assign_zeros(wide_places.coarse, static_cast<std::size_t>(target_begin.back()));
  // Each product belongs to one row, so that rows write to places of their own.
  const auto find = [&](std::size_t first, std::size_t last) {
    FoundRows rows;
    std::vector<std::uint16_t> place_of(static_cast<std::size_t>(num_groups), 0);
    for (auto row = static_cast<Index>(first); row < static_cast<Index>(last); ++row) {
      const Index group = order.node_at[row];
      const auto begin = static_cast<Offset>(rows.columns.size());
      for (Index k = graph.begin[group]; k < graph.begin[group + 1]; ++k)
        if (number[graph.neighbours[k]] > row) rows.columns.push_back(number[graph.neighbours[k]]);
      std::sort(rows.columns.begin() + begin, rows.columns.end());
      rows.end_row();
      place_of[row] = 1;
      for (Offset k = begin; k < rows.ends.back(); ++k)
        place_of[rows.columns[k]] = static_cast<std::uint16_t>(2 + k - begin);
      product.for_each(group, [&](Index column, Offset target) {
        if (number[column] >= row) wide_places.coarse[target] = place_of[number[column]];
      });
    }
    return rows;
  };
  parallel_in_order(
      static_cast<std::size_t>(num_groups), coarse_rows_at_once, find,
      [&](std::size_t, const FoundRows& rows) { rows.append_to(coarse.row_begin, coarse.columns); });
  for (Index row = 0; row < num_groups; ++row)
    if (coarse.row_begin[row + 1] - coarse.row_begin[row] > std::numeric_limits<std::uint16_t>::max() - 2)
      return false;
  coarse.columns.shrink_to_fit();
  return true;
}

/// In most levels one byte is enough for the maps: rows of the prolongation and of both products are short.
void MultigridLevel::narrow_the_places() {
  constexpr std::uint16_t none = 0xffff, most = 0xff;
  constexpr std::size_t places_per_chunk = 1 << 16;
  Places<std::uint8_t> narrow;
  const auto take = [&](const auto& wide, auto& into) {
    std::atomic<bool> are_narrow = true;
    assign_zeros(into, wide.size());
    parallel_for(wide.size(), places_per_chunk, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) {
        if (wide[k] >= most && wide[k] != none) are_narrow = false;
        into[k] = static_cast<std::uint8_t>(std::min(wide[k], most));
      }
    });
    return are_narrow.load();
  };
  if (!take(wide_places.lower, narrow.lower) || !take(wide_places.smoothing, narrow.smoothing) ||
      !take(wide_places.coarse, narrow.coarse))
    return;
  narrow_places = std::move(narrow);
  wide_places = {};
}

/// Each chunk of the sweeps takes the first colour that no chunk has with which it shares a group.
void MultigridLevel::color_transfers(Index num_groups) {
  std::vector<std::uint64_t> colors_at(static_cast<std::size_t>(num_groups), 0);
  std::vector<std::vector<ColoredChunks::Rows>> by_color;
  for (const ColoredChunks::Rows& rows : sweeps.chunks) {
    const auto groups = std::span(prolongation_columns)
                            .subspan(static_cast<std::size_t>(prolongation_begin[rows.first]),
                                     static_cast<std::size_t>(prolongation_begin[rows.last] -
                                                              prolongation_begin[rows.first]));
    std::uint64_t taken = 0;
    for (const Index group : groups) taken |= colors_at[group];
    const auto color = static_cast<std::size_t>(std::countr_one(taken));
    assert(color < 64 && "there are no more chunks than that");
    for (const Index group : groups) colors_at[group] |= std::uint64_t{1} << color;
    by_color.resize(std::max(by_color.size(), color + 1));
    by_color[color].push_back(rows);
  }
  transfers = {};
  for (const auto& chunks : by_color) {
    transfers.color_begin.push_back(transfers.chunks.size());
    transfers.chunks.insert(transfers.chunks.end(), chunks.begin(), chunks.end());
  }
  transfers.color_begin.push_back(transfers.chunks.size());
}

}  // namespace resilin
