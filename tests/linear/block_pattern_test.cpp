#include "resilin/linear/block_pattern.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace resilin {
namespace {

using Pairs = std::set<std::pair<Index, Index>>;

Pairs pairs_of(const BlockPattern& pattern) {
  Pairs pairs;
  for (Index i = 0; i < pattern.num_nodes(); ++i)
    for (Offset s = pattern.row_begin[i]; s < pattern.row_begin[i + 1]; ++s)
      pairs.emplace(i, pattern.columns[static_cast<std::size_t>(s)]);
  return pairs;
}

TEST(BlockPatternBuilder, FindsAllCouplingsOfCellsAndPairs) {
  const Index num_nodes = 30;
  std::mt19937 random(7);
  std::uniform_int_distribution<Index> any_node(0, num_nodes - 1);
  BlockPatternBuilder builder(num_nodes);
  Pairs expected;
  for (Index i = 0; i < num_nodes; ++i) expected.emplace(i, i);
  for (const int nodes_per_cell : {3, 4, 2}) {
    std::vector<Index> cells;
    for (int k = 0; k < 5 * nodes_per_cell; ++k) cells.push_back(any_node(random));
    for (std::size_t cell = 0; cell < cells.size(); cell += nodes_per_cell)
      for (int a = 0; a < nodes_per_cell; ++a)
        for (int b = 0; b < nodes_per_cell; ++b)
          if (cells[cell + a] <= cells[cell + b]) expected.emplace(cells[cell + a], cells[cell + b]);
    builder.add_cells(cells, nodes_per_cell);
  }
  builder.add_pair(28, 2);
  builder.add_pair(2, 28);
  builder.add_pair(5, 5);
  expected.emplace(2, 28);
  const BlockPattern pattern = builder.build();
  EXPECT_EQ(pairs_of(pattern), expected);
  EXPECT_EQ(pattern.num_slots(), static_cast<Offset>(expected.size())) << "a pair stands there twice";
}

TEST(BlockPattern, HasTheDiagonalFirstAndAscendingColumns) {
  BlockPatternBuilder builder(5);
  builder.add_cells(std::vector<Index>{4, 0, 2, 1, 4, 2}, 3);
  const BlockPattern pattern = builder.build();
  for (Index i = 0; i < 5; ++i) {
    EXPECT_EQ(pattern.columns[static_cast<std::size_t>(pattern.row_begin[static_cast<std::size_t>(i)])], i);
    for (Offset s = pattern.row_begin[static_cast<std::size_t>(i)] + 1;
         s < pattern.row_begin[static_cast<std::size_t>(i) + 1]; ++s)
      EXPECT_LT(pattern.columns[static_cast<std::size_t>(s) - 1],
                pattern.columns[static_cast<std::size_t>(s)]);
  }
}

TEST(BlockPattern, KnowsTheSlotOfEveryPairAndOfNoOther) {
  BlockPatternBuilder builder(4);
  builder.add_pair(0, 3);
  const BlockPattern pattern = builder.build();
  EXPECT_EQ(pattern.slot(0, 0), 0);
  EXPECT_EQ(pattern.slot(0, 3), 1);
  EXPECT_EQ(pattern.slot(3, 3), 4);
  EXPECT_EQ(pattern.find_slot(1, 3), -1);
}

}  // namespace
}  // namespace resilin
