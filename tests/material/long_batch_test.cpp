// Results too long for the caches go past them: the same numbers, wherever the array begins.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <type_traits>
#include <vector>

#include "resilin/core/cpu.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/material/batch.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

template <class Real>
std::vector<Real> random_numbers(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> near_rest(-0.1, 0.1);
  std::vector<Real> numbers(count);
  for (Real& number : numbers) number = static_cast<Real>(near_rest(random));
  return numbers;
}

/// Evaluates all states at once into an array that begins amid a line of the cache, and 1,000 at a time.
template <class Real>
void expect_the_numbers_of_short_batches(std::size_t count, std::size_t numbers_per_state,
                                         const auto& evaluate) {
  constexpr std::size_t short_batch = 1000, offset = 3;
  const Material material = testing::sample_material(require_law("neo_hookean_quadratic", "law"));
  const std::vector<Real> H = random_numbers<Real>(9 * count);
  const Real untouched = 12345;
  const auto states_from = [&](std::size_t first, std::size_t size, InstructionSet set) {
    StateBatch<Real> states{.law = material.law,
                            .dim = 3,
                            .count = size,
                            .deformation_gradients = H.data() + 9 * first,
                            .holds_displacement_gradients = true,
                            .constants = {},
                            .instruction_set = set};
    for (const double& constant : material.constants) states.constants.push_back({&constant, 0});
    return states;
  };
  for (const InstructionSet set : available_instruction_sets()) {
    std::vector<Real> whole(offset + count * numbers_per_state + 1, untouched), part;
    evaluate(states_from(0, count, set), std::size_t{0}, whole.data() + offset);
    for (std::size_t first = 0; first < count; first += short_batch) {
      const std::size_t size = std::min(short_batch, count - first);
      part.assign(size * numbers_per_state, 0);
      evaluate(states_from(first, size, set), first, part.data());
      const auto in_whole = whole.begin() + static_cast<Offset>(offset + first * numbers_per_state);
      ASSERT_TRUE(std::equal(part.begin(), part.end(), in_whole)) << name(set) << " from state " << first;
    }
    for (std::size_t k = 0; k < offset; ++k) ASSERT_EQ(whole[k], untouched);
    ASSERT_EQ(whole.back(), untouched);
  }
}

template <class Real>
struct LongBatch : ::testing::Test {
  static constexpr std::size_t long_result = std::size_t{17} << 20;  // bytes: past the caches
  static std::size_t count_for(std::size_t numbers_per_state) {
    return long_result / (numbers_per_state * sizeof(Real)) + 13;
  }
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(LongBatch, Reals);

TYPED_TEST(LongBatch, OfStressesHasTheNumbersOfShortOnes) {
  expect_the_numbers_of_short_batches<TypeParam>(
      this->count_for(9), 9,
      [](const auto& states, std::size_t, TypeParam* P) { first_piola_kirchhoff_stresses(states, P); });
}

TYPED_TEST(LongBatch, OfTangentsHasTheNumbersOfShortOnes) {
  expect_the_numbers_of_short_batches<TypeParam>(
      this->count_for(81), 81,
      [](const auto& states, std::size_t, TypeParam* A) { stress_tangents(states, Projection::clamp, A); });
}

TYPED_TEST(LongBatch, OfForcesHasTheNumbersOfShortOnes) {
  const std::size_t count = this->count_for(12);
  const std::vector<TypeParam> inverses = random_numbers<TypeParam>(9 * count),
                               volumes = random_numbers<TypeParam>(count);
  const int before = num_threads();
  set_num_threads(2);
  expect_the_numbers_of_short_batches<TypeParam>(
      count, 12, [&](const auto& states, std::size_t first, TypeParam* forces) {
        elastic_forces(states, inverses.data() + 9 * first, volumes.data() + first, forces);
      });
  set_num_threads(before);
}

}  // namespace
}  // namespace resilin
