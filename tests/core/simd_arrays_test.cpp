#include "resilin/core/simd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "every_instruction_set.hpp"

namespace resilin::testing {
namespace {

using SimdArrays = EveryInstructionSet;

/// For every number of matrices in a block and for sizes that are and are not multiples of the width.
TEST_P(SimdArrays, MatricesBecomeRowsOfLanesAndComeBack) {
  constexpr std::size_t block = block_size;
  for (const std::size_t entries : {1U, 3U, 4U, 6U, 8U, 9U, 16U, 17U}) {
    for (std::size_t count = 1; count <= block; ++count) {
      std::vector<double> in(count * entries), rows(entries * block), out(count * entries, -1);
      std::iota(in.begin(), in.end(), 1.0);
      probe.read_block(in.data(), count, entries, rows.data());
      for (std::size_t entry = 0; entry < entries; ++entry)
        for (std::size_t lane = 0; lane < block; ++lane)  // lanes without a matrix repeat the last one
          EXPECT_EQ(rows[entry * block + lane], in[std::min(lane, count - 1) * entries + entry]);
      probe.write_block(rows.data(), count, entries, out.data());
      EXPECT_EQ(out, in) << count << " matrices of " << entries;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lanes, SimdArrays, ::testing::ValuesIn(available_instruction_sets()), name_of_set);

}  // namespace
}  // namespace resilin::testing
