#include "resilin/optimize/connected_components.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace resilin {
namespace {

/// Nodes 0-2 and 4-5 hang together, 3 hangs on nothing.
std::shared_ptr<const BlockPattern> two_pieces() {
  BlockPatternBuilder builder(6);
  builder.add_pair(1, 2);
  builder.add_pair(0, 2);
  builder.add_pair(4, 5);
  return std::make_shared<BlockPattern>(builder.build());
}

TEST(ConnectedComponents, AreThePiecesThatHangTogether) {
  const ConnectedComponents parts(*two_pieces());
  EXPECT_EQ(parts.count(), 2);
  for (const Index node : {0, 1, 2, 3}) EXPECT_EQ(parts.of_node(node), 0) << node;
  for (const Index node : {4, 5}) EXPECT_EQ(parts.of_node(node), 1) << node;
}

TEST(ConnectedComponents, OfNodesThatNothingCouplesAreOne) {
  EXPECT_EQ(ConnectedComponents(BlockPatternBuilder(4).build()).count(), 1);
}

TEST(ConnectedComponents, AreOneWhereTheyTouch) {
  const auto pattern = two_pieces();
  BlockMatrix matrix(2, pattern);
  const std::vector<double> block = {1, 0, 0, 1};
  EXPECT_EQ(ConnectedComponents(*pattern).joined_by(matrix).count(), 2);
  matrix.add_block(5, 1, block.data());
  const ConnectedComponents joined = ConnectedComponents(*pattern).joined_by(matrix);
  EXPECT_EQ(joined.count(), 1);
  EXPECT_EQ(joined.of_node(4), 0);
}

TEST(ConnectedComponents, HaveNormsOfTheirOwn) {
  const ConnectedComponents parts(*two_pieces());
  VectorX values(6);
  values << 3, 4, 12, 0, 5, -7;
  const std::vector<std::uint8_t> is_fixed = {0, 0, 1, 0, 1, 0};
  EXPECT_EQ(parts.norms(values, is_fixed, Unknowns::all), VectorX(Eigen::Vector2d(13, std::sqrt(74))));
  EXPECT_EQ(parts.norms(values, is_fixed, Unknowns::free), VectorX(Eigen::Vector2d(5, 7)));
  EXPECT_EQ(parts.norms(values, is_fixed, Unknowns::fixed), VectorX(Eigen::Vector2d(12, 5)));
  EXPECT_EQ(parts.largest(values), VectorX(Eigen::Vector2d(12, 7)));
}

TEST(ConnectedComponents, HaveNormsWhereSquaresVanishOrOverflow) {
  const ConnectedComponents parts(*two_pieces());
  const std::vector<std::uint8_t> is_fixed(6, 0);
  for (const double tiny : {1e-3, 1e-120, 1e-170, 1e-300, 1e-318}) {
    VectorX values(6);
    values << 3 * tiny, 4 * tiny, 0, 0, 3 / tiny, 4 / tiny;
    if (!std::isfinite(1 / tiny)) values.tail(2) << 3e300, 4e300;
    const VectorX norms = parts.norms(values, is_fixed, Unknowns::all);
    EXPECT_NEAR(norms[0] / tiny, 5, tiny < 1e-307 ? 1e-3 : 1e-14) << tiny;
    EXPECT_NEAR(norms[1] / (values[4] / 3), 5, 1e-14) << tiny;
  }
  VectorX values = VectorX::Ones(6);
  values[4] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(std::isfinite(parts.norms(values, is_fixed, Unknowns::all)[1]));
  values[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(parts.norms(values, is_fixed, Unknowns::all)[0]));
}

TEST(ConnectedComponents, OfASystemMayBeMeasuredInUnitsOfTheirOwn) {
  const auto pattern = two_pieces();
  const ConnectedComponents parts(*pattern);
  BlockMatrix matrix(2, pattern);
  for (Index node = 0; node < 6; ++node)
    for (int k = 0; k < 2; ++k) matrix.add_to_diagonal(node, k, 1 + node);
  const std::vector<double> coupling = {0.25, 0, 0.5, 0.25};
  matrix.add_block(4, 5, coupling.data());
  const VectorX x = VectorX::LinSpaced(12, 1, 2);
  VectorX b, scaled_b;
  multiply(matrix, x, b);
  const VectorX weights = Eigen::Vector2d(1, 1e-9);
  scale_components(parts, weights, matrix);
  scale_components(parts, weights, b);
  multiply(matrix, x, scaled_b);
  EXPECT_LT((scaled_b - b).norm(), 1e-14 * b.norm());
}

}  // namespace
}  // namespace resilin
