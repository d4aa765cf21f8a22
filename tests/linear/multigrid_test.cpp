#include <gtest/gtest.h>

#include <algorithm>

#include "bar_problem.hpp"
#include "resilin/linear/ordering.hpp"
#include "resilin/linear/permuted_pattern.hpp"
#include "resilin/linear/rigid_modes.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

using testing::dense;

struct EveryBar : ::testing::TestWithParam<int> {
  const BarProblem bar = make_bar_problem({.dim = GetParam(), .cells_per_height = 3});
  MergedPattern pattern;
  FullPattern full;
  std::vector<Index> all;  // nodes

  EveryBar() {
    pattern.update(bar.matrix, MergedPattern::Keep::same_pairs);
    all.resize(static_cast<std::size_t>(pattern.num_nodes()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    const PermutedPattern upper(pattern, NodeGraph(pattern), all);
    full = FullPattern(upper.row_begin, upper.columns);
  }
};
INSTANTIATE_TEST_SUITE_P(Multigrid, EveryBar, ::testing::Values(2, 3), ::testing::PrintToStringParamName());

bool is_permutation_of_all(std::vector<Index> order, Index count) {
  std::sort(order.begin(), order.end());
  for (Index i = 0; i < static_cast<Index>(order.size()); ++i)
    if (order[static_cast<std::size_t>(i)] != i) return false;
  return static_cast<Index>(order.size()) == count;
}

TEST_P(EveryBar, OrdersHoldEveryNodeOnce) {
  const NodeGraph graph(pattern);
  EXPECT_TRUE(is_permutation_of_all(reverse_cuthill_mckee(graph).node_at, graph.num_nodes()));
  EXPECT_TRUE(is_permutation_of_all(fill_reducing_order(graph), graph.num_nodes()));
}

TEST(Ordering, TakesNodesWithoutNeighbours) {
  const BlockMatrix A(2, std::make_shared<const BlockPattern>(BlockPatternBuilder(4).build()));
  MergedPattern pattern;
  pattern.update(A, MergedPattern::Keep::same_pairs);
  const NodeGraph graph(pattern);
  EXPECT_TRUE(is_permutation_of_all(reverse_cuthill_mckee(graph).node_at, 4));
  EXPECT_TRUE(is_permutation_of_all(fill_reducing_order(graph), 4));
}

TEST_P(EveryBar, GroupsAreConnectedAndLeaveOutWhatIsNotActive) {
  std::vector<std::uint8_t> is_active(static_cast<std::size_t>(pattern.num_nodes()), 1);
  is_active[3] = is_active[10] = 0;
  const Aggregates groups = aggregate(full, is_active, all);
  EXPECT_LT(groups.count, pattern.num_nodes() / 3);
  std::vector<int> sizes(static_cast<std::size_t>(groups.count), 0);
  for (std::size_t i = 0; i < is_active.size(); ++i) {
    ASSERT_EQ(groups.of_node[i] >= 0, is_active[i] != 0) << i;
    if (is_active[i] != 0) ++sizes[static_cast<std::size_t>(groups.of_node[i])];
  }
  for (const int size : sizes) EXPECT_GE(size, 2);
}

template <class NodeModes>
Eigen::MatrixXd rows_of(const NodeModes& modes, Index node) {
  Eigen::Matrix<double, -1, -1, Eigen::RowMajor> rows(modes.size, modes.count);
  modes.write(node, rows.data());
  return rows;
}

TEST_P(EveryBar, RigidModesCostNoEnergyAwayFromTheClamp) {
  const int dim = GetParam();
  const std::vector<std::uint8_t> none(bar.is_fixed.size(), 0);
  const RigidModes modes(dim, bar.node_positions, none, all);
  const Eigen::MatrixXd K = dense(bar.matrix);
  for (int mode = 0; mode < modes.count; ++mode) {
    VectorX u(K.rows());
    for (Index i = 0; i < pattern.num_nodes(); ++i)
      for (int d = 0; d < dim; ++d) u[i * dim + d] = rows_of(modes, i)(d, mode);
    const VectorX force = K * u;
    for (Eigen::Index k = 0; k < force.size(); ++k) {
      const bool is_far = bar.node_positions[k / dim * dim] > 0.7;
      ASSERT_LT(is_far ? std::abs(force[k]) : 0, 1e-12 * K.norm()) << mode;
    }
  }
}

TEST_P(EveryBar, TentativeProlongationKeepsTheModes) {
  const int dim = GetParam();
  const std::vector<std::uint8_t> is_active(static_cast<std::size_t>(pattern.num_nodes()), 1);
  const Aggregates groups = aggregate(full, is_active, all);
  const RigidModes modes(dim, bar.node_positions, bar.is_fixed, all);
  const TentativeProlongation tentative = orthonormalize(modes, groups);
  std::vector<Eigen::MatrixXd> gram(static_cast<std::size_t>(groups.count),
                                    Eigen::MatrixXd::Zero(modes.count, modes.count));
  for (Index i = 0; i < pattern.num_nodes(); ++i) {
    const Index group = groups.of_node[static_cast<std::size_t>(i)];
    const Eigen::MatrixXd Q = Eigen::Map<const Eigen::Matrix<float, -1, -1, Eigen::RowMajor>>(
                                  tentative.fine.data() + static_cast<Offset>(i) * modes.size * modes.count,
                                  modes.size, modes.count)
                                  .cast<double>();
    gram[static_cast<std::size_t>(group)] += Q.transpose() * Q;
    EXPECT_LT((Q * rows_of(tentative.coarse, group) - rows_of(modes, i)).norm(), 1e-6);
  }
  for (Index group = 0; group < groups.count; ++group)
    for (int c = 0; c < modes.count; ++c) {
      const double expected =
          tentative.is_absent[static_cast<std::size_t>(group * modes.count + c)] != 0 ? 0 : 1;
      EXPECT_NEAR(gram[static_cast<std::size_t>(group)](c, c), expected, 1e-6);
    }
}

}  // namespace
}  // namespace resilin
