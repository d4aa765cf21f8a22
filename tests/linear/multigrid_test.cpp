#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>
#include <string>

#include "bar_problem.hpp"
#include "resilin/linear/multigrid_level.hpp"
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
  PermutedPattern upper;
  LowerPattern lower;
  std::vector<Index> all;  // nodes

  EveryBar() {
    pattern.update(bar.matrix, MergedPattern::Keep::same_pairs);
    all.resize(static_cast<std::size_t>(pattern.num_nodes()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    upper = PermutedPattern(pattern, NodeGraph(pattern), all);
    lower = LowerPattern(upper.row_begin, upper.columns);
  }
  FullPattern full() const { return {upper.row_begin, upper.columns, lower}; }
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
  const Aggregates groups = aggregate(full(), is_active, all);
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
  const Aggregates groups = aggregate(full(), is_active, all);
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

/// A chain of nodes in groups of two, and one that is coupled with all of them.
struct Chain {
  int dim;
  bool has_hub;
  Index num_groups = 260;  // more than the maps of a level can count in one byte
  MultigridLevel fine{}, coarse{};
  Aggregates groups{};

  void build() {
    const Index num_nodes = 2 * num_groups;
    fine.dim = coarse.dim = dim;
    coarse.is_given = false;
    fine.row_begin = {0};
    for (Index i = 0; i < num_nodes; ++i) {
      if (i + 1 < num_nodes) fine.columns.push_back(i + 1);
      if (has_hub && i + 2 < num_nodes) fine.columns.push_back(num_nodes - 1);
      fine.row_begin.push_back(static_cast<Offset>(fine.columns.size()));
    }
    fine.sweeps = ColoredChunks::whole(num_nodes);
    fine.lower = LowerPattern(fine.row_begin, fine.columns);
    groups.count = num_groups;
    for (Index i = 0; i < num_nodes; ++i) groups.of_node.push_back(i / 2);
    ASSERT_TRUE(fine.connect(groups, coarse));
    fine.allocate();
    coarse.allocate();
  }
  void fill() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-1, 1);
    const int size = fine.block_size();
    for (float& entry : fine.blocks) entry = number(random);
    for (Index i = 0; i < fine.num_nodes(); ++i)
      for (int r = 0; r < size; ++r)
        for (int c = 0; c <= r; ++c) {
          float* block = fine.blocks.data() + i * size * size;
          block[r * size + c] = block[c * size + r];
          if (r == c) block[r * size + r] += 20;
        }
    std::vector<float> modes(static_cast<std::size_t>(fine.num_nodes() * size * fine.num_modes()));
    for (float& entry : modes) entry = number(random);
    fine.set_tentative(modes);
  }
  /// The matrix of a level, from its upper blocks.
  static Eigen::MatrixXd matrix_of(const MultigridLevel& level) {
    const int size = level.block_size();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(level.num_nodes() * size, level.num_nodes() * size);
    const auto put = [&](Index i, Index j, Offset block) {
      const Eigen::MatrixXd values = Eigen::Map<const Eigen::Matrix<float, -1, -1, Eigen::RowMajor>>(
                                         level.blocks.data() + block * size * size, size, size)
                                         .cast<double>();
      matrix.block(i * size, j * size, size, size) = values;
      matrix.block(j * size, i * size, size, size) = values.transpose();
    };
    for (Index i = 0; i < level.num_nodes(); ++i) {
      put(i, i, i);
      for (Offset k = level.row_begin[i]; k < level.row_begin[i + 1]; ++k)
        put(i, level.columns[k], level.num_nodes() + k);
    }
    return matrix;
  }
  /// A block of a node.
  Eigen::MatrixXd block_of(const MultigridLevel::Shortened& all, Offset block, Index node) const {
    const int rows = fine.block_size(), columns = fine.num_modes();
    return static_cast<double>(all.scales[static_cast<std::size_t>(node)]) *
           Eigen::Map<const Eigen::Matrix<std::int16_t, -1, -1, Eigen::RowMajor>>(
               all.numbers.data() + block * rows * columns, rows, columns)
               .cast<double>();
  }
  /// Each node's row of modes under its group.
  Eigen::MatrixXd tentative() const {
    const int rows = fine.block_size(), columns = fine.num_modes();
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(fine.num_nodes() * rows, num_groups * columns);
    for (Index i = 0; i < fine.num_nodes(); ++i)
      T.block(i * rows, groups.of_node[static_cast<std::size_t>(i)] * columns, rows, columns) =
          block_of(fine.tentative, i, i);
    return T;
  }
  /// D^-1 A B.
  Eigen::MatrixXd jacobi_product(const Eigen::MatrixXd& B) const {
    const int size = fine.block_size();
    const Eigen::MatrixXd A = matrix_of(fine);
    Eigen::MatrixXd product = A * B;
    for (Index i = 0; i < fine.num_nodes(); ++i)
      product.middleRows(i * size, size) =
          A.block(i * size, i * size, size, size).ldlt().solve(product.middleRows(i * size, size)).eval();
    return product;
  }
  Eigen::MatrixXd prolongation() const {
    const int rows = fine.block_size(), columns = fine.num_modes();
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(fine.num_nodes() * rows, num_groups * columns);
    for (Index i = 0; i < fine.num_nodes(); ++i)
      for (Offset k = fine.prolongation_begin[i]; k < fine.prolongation_begin[i + 1]; ++k)
        P.block(i * rows, fine.prolongation_columns[k] * columns, rows, columns) =
            block_of(fine.prolongation, k, i);
    return P;
  }
};

/// With a node that reaches very many groups the maps of the product need two bytes.
TEST(MultigridLevel, ProjectsItsMatrixByMapsOfOneByteAndOfTwo) {
  for (const int dim : {2, 3})
    for (const bool has_hub : {false, true}) {
      SCOPED_TRACE(std::to_string(dim) + (has_hub ? "D with a hub" : "D"));
      Chain chain{.dim = dim, .has_hub = has_hub};
      chain.build();
      EXPECT_EQ(chain.fine.has_narrow_places(), !has_hub);
      chain.fill();
      ASSERT_TRUE(chain.fine.invert_diagonal());
      chain.fine.project_to(chain.coarse);
      const Eigen::MatrixXd P = chain.prolongation(), T = chain.tentative(), S = chain.jacobi_product(T);
      const double damping = (T - P).cwiseProduct(S).sum() / S.squaredNorm();  // P = T - damping D^-1 A T
      EXPECT_GT(damping, 0.1);
      // Half of the last of two bytes, and single precision.
      EXPECT_LT((T - damping * S - P).lpNorm<Eigen::Infinity>(), 2.5e-5 * T.lpNorm<Eigen::Infinity>());
      const Eigen::MatrixXd expected = P.transpose() * Chain::matrix_of(chain.fine) * P;
      const double error = (Chain::matrix_of(chain.coarse) - expected).lpNorm<Eigen::Infinity>();
      EXPECT_LT(error, 1e-5 * expected.lpNorm<Eigen::Infinity>());  // single precision
    }
}

}  // namespace
}  // namespace resilin
