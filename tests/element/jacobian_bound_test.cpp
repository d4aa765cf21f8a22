#include "resilin/element/jacobian_bound.hpp"

#include <gtest/gtest.h>

#include <random>

#include "every_element.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

using Kind = JacobianSign::Kind;

std::vector<double> moved_nodes(const ElementInfo& element, double distortion, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-distortion, distortion);
  std::vector<double> positions;
  for (const Vector3& node : element.nodes)
    for (int i = 0; i < element.dim; ++i) positions.push_back(node[i] + uniform(random));
  return positions;
}

/// Smallest determinant on a fine grid of the reference cell.
double sampled(const ElementInfo& element, std::span<const double> positions) {
  constexpr int n = 20;
  double least = 1e300;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= (element.dim == 3 ? n : 0); ++k) {
        const Vector3 xi = Vector3(i, j, k) / n;
        if (is_simplex(element.shape) && i + j + k > n) continue;
        least = std::min(least, jacobian(element, xi, positions));
      }
  return least;
}

std::vector<const ElementInfo*> elements_with_a_bound() {
  std::vector<const ElementInfo*> all = elements();
  std::erase_if(all, [](const ElementInfo* element) { return element->has_mean_volume; });
  return all;
}

struct JacobianSignOfEveryElement : OnEveryElement {};

INSTANTIATE_TEST_SUITE_P(Catalogue, JacobianSignOfEveryElement, ::testing::ValuesIn(elements_with_a_bound()),
                         name_of_element);

/// Random cells, from sound ones to folded ones: a bound never exceeds a sample, and a fold is shown.
TEST_P(JacobianSignOfEveryElement, IsCertain) {
  std::mt19937 random(7);
  int num_positive = 0, num_folded = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const std::vector<double> positions = moved_nodes(element, 0.007 * trial, random);
    const JacobianSign sign = jacobian_sign(element, positions);
    const double least = sampled(element, positions);
    SCOPED_TRACE("least sample " + std::to_string(least));
    if (sign.kind == Kind::positive) {
      ++num_positive;
      EXPECT_LE(sign.value, least * (1 + 1e-12));
    } else {
      ++num_folded;
      ASSERT_EQ(sign.kind, Kind::not_positive);
      EXPECT_LE(sign.value, 0);
      // The place is a corner of a part of the reference cell; the value there is the determinant.
      EXPECT_NEAR(jacobian(element, sign.xi, positions), sign.value, 1e-12);
    }
  }
  EXPECT_GT(num_positive, 20);
  EXPECT_GT(num_folded, 5);
}

/// The middle of an edge at a quarter of it makes the determinant zero at the corner beside.
TEST(JacobianSign, KnowsTheQuarterPoint) {
  const ElementInfo& element = *find_element("P2", 2);
  const auto with_middle_at = [&](double place) {
    std::vector<double> positions = {0, 0, 1, 0, 0, 1, place, 0, 0.5, 0.5, 0, 0.5};
    return jacobian_sign(element, positions).kind;
  };
  EXPECT_EQ(with_middle_at(0.25), Kind::not_positive);
  EXPECT_EQ(with_middle_at(0.26), Kind::positive);
  EXPECT_EQ(with_middle_at(0.24), Kind::not_positive);
}

/// Positive at all corners and edges' middles, negative inside: samples at nodes do not see it.
TEST(JacobianSign, FindsAFoldThatNoNodeSees) {
  const ElementInfo& element = *find_element("P2", 3);
  std::mt19937 random(11);
  int num_found = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const std::vector<double> positions = moved_nodes(element, 0.12, random);
    bool all_nodes_positive = true;
    for (const Vector3& node : element.nodes)
      all_nodes_positive = all_nodes_positive && jacobian(element, node, positions) > 0;
    if (all_nodes_positive && jacobian_sign(element, positions).kind == Kind::not_positive) ++num_found;
  }
  EXPECT_GT(num_found, 0);
}

}  // namespace
}  // namespace resilin
