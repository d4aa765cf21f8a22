#include "resilin/linear/sweep_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bar_problem.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/linear/multigrid_level.hpp"
#include "resilin/linear/ordering.hpp"
#include "resilin/linear/permuted_pattern.hpp"

namespace resilin {
namespace {

using Order = SweepOrder (*)(const NodeGraph& graph, Offset least_couplings);

struct EveryOrder : ::testing::TestWithParam<std::tuple<Order, std::string>> {
  const Order order_of = std::get<0>(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Sweeps, EveryOrder,
                         ::testing::Values(std::tuple(&two_color_order, "TwoColors"),
                                           std::tuple(&two_ended_order, "TwoEnds")),
                         [](const auto& kind) { return std::get<1>(kind.param); });

NodeGraph graph_of(const BlockPattern& pattern) {
  MergedPattern merged;
  merged.update(BlockMatrix(2, std::make_shared<const BlockPattern>(pattern)),
                MergedPattern::Keep::same_pairs);
  return NodeGraph(merged);
}

/// Rows that a chunk writes to when its rows add to their neighbours behind them.
std::vector<Index> touched(const NodeGraph& graph, const SweepOrder& order, const ColoredChunks::Rows& rows) {
  const std::vector<Index> position = inverse_of(order.node_at);
  std::vector<Index> places;
  for (Index i = rows.first; i < rows.last; ++i) {
    places.push_back(i);
    const Index node = order.node_at[static_cast<std::size_t>(i)];
    for (Index e = graph.begin[static_cast<std::size_t>(node)];
         e < graph.begin[static_cast<std::size_t>(node) + 1]; ++e) {
      const Index other = position[static_cast<std::size_t>(graph.neighbours[static_cast<std::size_t>(e)])];
      if (other > i) places.push_back(other);
    }
  }
  std::ranges::sort(places);
  places.erase(std::ranges::unique(places).begin(), places.end());
  return places;
}

/// @return the number of chunks
std::size_t expect_sound(const NodeGraph& graph, const SweepOrder& order) {
  std::vector<Index> nodes = order.node_at, positions = order.along_layers;
  std::ranges::sort(nodes);
  std::ranges::sort(positions);
  EXPECT_EQ(static_cast<Index>(nodes.size()), graph.num_nodes());
  EXPECT_EQ(nodes, positions);
  EXPECT_TRUE(std::ranges::adjacent_find(nodes) == nodes.end());
  const ColoredChunks& chunks = order.chunks;
  Index end = 0;
  for (const ColoredChunks::Rows& rows : chunks.chunks) {
    EXPECT_EQ(rows.first, end);
    end = rows.last;
  }
  EXPECT_EQ(end, graph.num_nodes());
  EXPECT_EQ(chunks.color_begin.back(), chunks.chunks.size());
  for (std::size_t color = 0; color + 1 < chunks.color_begin.size(); ++color) {
    std::vector<Index> all;
    for (std::size_t k = chunks.color_begin[color]; k < chunks.color_begin[color + 1]; ++k)
      std::ranges::copy(touched(graph, order, chunks.chunks[k]), std::back_inserter(all));
    std::ranges::sort(all);
    EXPECT_TRUE(std::ranges::adjacent_find(all) == all.end()) << "two chunks of colour " << color << " meet";
  }
  return chunks.chunks.size();
}

TEST_P(EveryOrder, LetsNoTwoChunksOfAColourMeet) {
  for (const auto& [dim, cells] : {std::pair{2, 20}, {3, 7}}) {
    const NodeGraph graph =
        graph_of(*make_bar_problem({.dim = dim, .cells_per_height = cells}).matrix.pattern);
    for (const Offset least : {20, 300, 1000}) EXPECT_GE(expect_sound(graph, order_of(graph, least)), 3U);
    EXPECT_EQ(expect_sound(graph, order_of(graph, 1000000)), 1U);
  }
}

TEST_P(EveryOrder, TakesBodiesApartAndSingleNodesAndNone) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    // Chains of any length with some couplings between nodes near each other, and nodes alone.
    const Index num_nodes = std::uniform_int_distribution<Index>(0, 400)(random);
    BlockPatternBuilder builder(num_nodes);
    const Index reach = std::uniform_int_distribution<Index>(1, 6)(random);
    const double density = std::uniform_real_distribution<double>(0.3, 1.5)(random);
    for (Index k = 0; k < static_cast<Index>(density * static_cast<double>(num_nodes)); ++k) {
      const Index i = std::uniform_int_distribution<Index>(0, num_nodes - 1)(random);
      const Index j = std::min(num_nodes - 1, i + std::uniform_int_distribution<Index>(1, reach)(random));
      if (i != j) builder.add_pair(i, j);
    }
    const NodeGraph graph = graph_of(builder.build());
    expect_sound(graph, order_of(graph, std::uniform_int_distribution<Offset>(1, 60)(random)));
  }
}

TEST(MultigridLevel, LetsNoTwoChunksOfAColourReachOneGroup) {
  for (const auto& [dim, cells] : {std::pair{2, 40}, {3, 9}}) {
    MergedPattern pattern;
    pattern.update(make_bar_problem({.dim = dim, .cells_per_height = cells}).matrix,
                   MergedPattern::Keep::same_pairs);
    const NodeGraph graph(pattern);
    SweepOrder order = two_color_order(graph, 100);
    const PermutedPattern permuted(pattern, graph, order.node_at);
    MultigridLevel fine, coarse;
    fine.dim = coarse.dim = dim;
    coarse.is_given = false;
    fine.row_begin = permuted.row_begin;
    fine.columns = permuted.columns;
    fine.sweeps = order.chunks;
    fine.lower = LowerPattern(fine.row_begin, fine.columns);
    const std::vector<std::uint8_t> is_active(permuted.node_at.size(), 1);
    Aggregates groups = aggregate(fine.full(), is_active, order.along_layers);
    ASSERT_TRUE(fine.connect(groups, coarse));
    EXPECT_GT(fine.transfers.chunks.size(), 10U);
    EXPECT_GT(fine.transfers.chunks.size(), 2 * (fine.transfers.color_begin.size() - 1))
        << "hardly any at once";
    std::vector<int> rows_done(permuted.node_at.size(), 0);
    for (std::size_t color = 0; color + 1 < fine.transfers.color_begin.size(); ++color) {
      std::vector<std::size_t> chunk_at(static_cast<std::size_t>(groups.count), 0);
      for (std::size_t k = fine.transfers.color_begin[color]; k < fine.transfers.color_begin[color + 1]; ++k)
        for (auto i = static_cast<std::size_t>(fine.transfers.chunks[k].first);
             i < static_cast<std::size_t>(fine.transfers.chunks[k].last); ++i) {
          ++rows_done[i];
          for (Offset e = fine.prolongation_begin[i]; e < fine.prolongation_begin[i + 1]; ++e) {
            std::size_t& chunk =
                chunk_at[static_cast<std::size_t>(fine.prolongation_columns[static_cast<std::size_t>(e)])];
            ASSERT_TRUE(chunk == 0 || chunk == k + 1) << "two chunks of colour " << color << " meet";
            chunk = k + 1;
          }
        }
    }
    EXPECT_TRUE(std::ranges::all_of(rows_done, [](int times) { return times == 1; }));
  }
}

/// Large enough for every loop to have several chunks.
struct LargeBar : ::testing::TestWithParam<std::tuple<std::string, int>> {
  const BarProblem bar = make_bar_problem({.dim = std::get<1>(GetParam()),
                                           .cells_per_height = std::get<1>(GetParam()) == 3 ? 12 : 60,
                                           .time_step = 0.01});
  VectorX solve(int threads) const {
    set_num_threads(threads);
    const auto solver = make_linear_solver({.kind = std::get<0>(GetParam())}, bar.matrix.num_unknowns());
    solver->analyze(bar.matrix, bar.node_positions);
    EXPECT_EQ(solver->factorize(bar.matrix).status, LinearReport::Status::ok);
    VectorX x;
    EXPECT_EQ(solver->solve(bar.matrix, bar.right_side, x, 1e-8).status, LinearReport::Status::ok);
    return x;
  }
};
INSTANTIATE_TEST_SUITE_P(Sweeps, LargeBar,
                         ::testing::Combine(::testing::Values("cg_ic0", "cg_amg", "cg_jacobi"),
                                            ::testing::Values(2, 3)),
                         [](const auto& kind) {
                           return std::get<0>(kind.param) + "_" + std::to_string(std::get<1>(kind.param)) +
                                  "D";
                         });

TEST_P(LargeBar, HasTheSameBitsForAnyNumberOfThreads) {
  const int threads_before = num_threads();
  const VectorX alone = solve(1);
  for (const int threads : {2, 3, 4, 8}) EXPECT_EQ(alone, solve(threads)) << threads << " threads";
  set_num_threads(threads_before);
  VectorX product;
  multiply(bar.matrix, alone, product);
  EXPECT_LE((bar.right_side - product).norm(), 1.01e-8 * bar.right_side.norm());
}

}  // namespace
}  // namespace resilin
