#include "resilin/core/memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace resilin {
namespace {

TEST(AssignZeros, GivesZerosOfAnyCountWhateverWasThere) {
  for (const std::size_t before : {0U, 100U, 3000000U})
    for (const std::size_t count : {0U, 1U, 5000U, 1048577U, 2000000U}) {
      std::vector<double> numbers(before, 7.0);
      assign_zeros(numbers, count);
      ASSERT_EQ(numbers.size(), count);
      EXPECT_TRUE(std::ranges::all_of(numbers, [](double number) { return number == 0; }));
    }
}

// Pages are written to before the numbers are there: not one byte beyond the array.
TEST(TakePages, WritesWithinTheArrayAlone) {
  constexpr std::size_t much = (std::size_t{4} << 20) + 1234, beyond = 8192;
  std::vector<std::uint8_t> bytes(much + beyond, 5);
  take_pages(bytes.data(), much);
  EXPECT_TRUE(std::all_of(bytes.begin() + much, bytes.end(), [](std::uint8_t byte) { return byte == 5; }));
}

}  // namespace
}  // namespace resilin
