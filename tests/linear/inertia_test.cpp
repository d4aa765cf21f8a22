// Pivots of one and two columns in the fronts: families of random matrices against dense eigenvalues.

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <random>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

using testing::dense;
using Status = LinearReport::Status;
using Block = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

/// A grid of nodes, each coupled with those to the right, below and across; nodes of the grid may be followed
/// by others. The elimination tree has several levels.
struct Grid {
  static constexpr Index side = 10, size = side * side;
  std::mt19937 random;
  int dim;

  Grid(int dimension, int seed) : random(static_cast<unsigned>(seed)), dim(dimension) {}

  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); }
  Index node() { return std::uniform_int_distribution<Index>(0, size - 1)(random); }
  Block block() {
    return Block::NullaryExpr(dim, dim, [&] { return number(-1, 1); });
  }
  Block symmetric_block() {
    const Block B = block();
    return B + B.transpose();
  }
  Block definite_block() {
    const Block B = block();
    return B * B.transpose() + 0.1 * Block::Identity(dim, dim);
  }
  template <class Visit>
  void for_pairs(const Visit& visit) {
    for (Index i = 0; i < size; ++i) {
      if (i % side < side - 1) visit(i, i + 1);
      if (i + side < size) visit(i, i + side);
      if (i % side < side - 1 && i + side < size) visit(i, i + side + 1);
    }
  }
  BlockMatrix empty_matrix(Index num_others = 0,
                           const std::vector<std::pair<Index, Index>>& other_pairs = {}) {
    BlockPatternBuilder builder(size + num_others);
    for_pairs([&](Index i, Index j) { builder.add_pair(i, j); });
    for (const auto& [i, j] : other_pairs) builder.add_pair(i, j);
    return {dim, std::make_shared<const BlockPattern>(builder.build())};
  }
  /// Nothing holds the springs: evenly moved they are at rest.
  void add_springs(BlockMatrix& A) {
    for_pairs([&](Index i, Index j) {
      const Block K = definite_block(), minus = -K;
      A.add_block(i, i, K.data());
      A.add_block(j, j, K.data());
      A.add_block(i, j, minus.data());
    });
  }
};

BlockMatrix springs_less_a_shift(int dim, int seed) {
  Grid grid(dim, seed);
  BlockMatrix A = grid.empty_matrix();
  grid.add_springs(A);
  const double shift = grid.number(0.01, 5);
  for (Index i = 0; i < Grid::size; ++i)
    for (int d = 0; d < dim; ++d) A.add_to_diagonal(i, d, -shift);
  return A;
}

/// [K B; B^T 0] with a multiplier for every third node; each binds three nodes.
BlockMatrix saddle_point(int dim, int seed) {
  Grid grid(dim, seed);
  const Index num_multipliers = Grid::size / 3;
  std::vector<std::pair<Index, Index>> pairs;
  for (Index m = 0; m < num_multipliers; ++m)
    for (const Index k : {0, 1, 2}) pairs.emplace_back(3 * m + k, Grid::size + m);
  BlockMatrix A = grid.empty_matrix(num_multipliers, pairs);
  grid.add_springs(A);
  for (const auto& [i, j] : pairs) A.add_block(i, j, grid.block().data());
  return A;
}

BlockMatrix any_values(int dim, int seed) {
  Grid grid(dim, seed);
  BlockMatrix A = grid.empty_matrix();
  for (Index i = 0; i < Grid::size; ++i) A.add_block(i, i, grid.symmetric_block().data());
  grid.for_pairs([&](Index i, Index j) { A.add_block(i, j, grid.block().data()); });
  return A;
}

BlockMatrix zero_diagonal(int dim, int seed) {
  BlockMatrix A = any_values(dim, seed);
  for (Index i = 0; i < A.num_nodes(); ++i)
    for (int d = 0; d < dim; ++d) A.block(A.pattern->slot(i, i))[d * (dim + 1)] = 0;
  return A;
}

/// Blocks on the diagonal vanish for every node but some: columns wait for their neighbours.
BlockMatrix few_diagonal_blocks(int dim, int seed) {
  BlockMatrix A = any_values(dim, seed);
  for (Index i = 0; i < A.num_nodes(); ++i)
    if (i % 5 != 0) std::fill_n(A.block(A.pattern->slot(i, i)), dim * dim, 0.0);
  return A;
}

/// Couplings across the grid make large fronts; most columns wait for their neighbours.
BlockMatrix large_fronts(int dim, int seed) {
  Grid grid(dim, seed);
  std::vector<std::pair<Index, Index>> pairs;
  for (Index k = 0; k < 4 * Grid::size; ++k) pairs.emplace_back(grid.node(), grid.node());
  std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
  BlockMatrix A = grid.empty_matrix(0, pairs);
  for (Index i = 0; i < Grid::size; ++i)
    if (i % 5 == 0) A.add_block(i, i, grid.symmetric_block().data());
  grid.for_pairs([&](Index i, Index j) { A.add_block(i, j, grid.block().data()); });
  for (const auto& [i, j] : pairs) A.add_block(i, j, grid.block().data());
  return A;
}

/// Pivots that are small, though not zero.
BlockMatrix small_diagonal(int dim, int seed) {
  BlockMatrix A = any_values(dim, seed);
  for (Index i = 0; i < A.num_nodes(); ++i)
    for (int k = 0; k < dim * dim; ++k) A.block(A.pattern->slot(i, i))[k] *= 1e-11;
  return A;
}

/// Unknowns in units that differ by up to 12 orders of magnitude: the signs of the eigenvalues stay.
void change_units(BlockMatrix& A, int seed) {
  Grid grid(A.dim, seed);
  std::vector<double> units(static_cast<std::size_t>(A.num_unknowns()));
  for (double& unit : units) unit = std::pow(10, grid.number(-6, 6));
  for (Index i = 0; i < A.num_nodes(); ++i)
    for (Offset s = A.pattern->row_begin[static_cast<std::size_t>(i)];
         s < A.pattern->row_begin[static_cast<std::size_t>(i) + 1]; ++s)
      for (int r = 0; r < A.dim; ++r)
        for (int c = 0; c < A.dim; ++c)
          A.block(s)[r * A.dim + c] *= units[i * A.dim + r] * units[A.pattern->columns[s] * A.dim + c];
}

struct Family {
  std::string name;
  BlockMatrix (*make)(int dim, int seed);

  friend std::ostream& operator<<(std::ostream& out, const Family& family) { return out << family.name; }
};

const std::vector<Family> regular = {{"springs_less_a_shift", springs_less_a_shift},
                                     {"saddle_point", saddle_point},
                                     {"any_values", any_values},
                                     {"zero_diagonal", zero_diagonal},
                                     {"few_diagonal_blocks", few_diagonal_blocks},
                                     {"large_fronts", large_fronts},
                                     {"small_diagonal", small_diagonal}};

constexpr int num_seeds = 6;

struct Inertia : ::testing::TestWithParam<std::tuple<Family, int>> {
  const Family family = std::get<0>(GetParam());
  const int dim = std::get<1>(GetParam());
  const std::unique_ptr<LinearSolver> solver =
      make_linear_solver({.kind = "multifrontal", .is_definite = false}, 100);

  /// The largest |b - A x|_i / (|A| |x| + |b|)_i: how much the entries must change for x to be exact (Oettli
  /// & Prager 1964).
  static double backward_error(const BlockMatrix& A, const VectorX& b, const VectorX& x) {
    const Eigen::MatrixXd D = dense(A);
    const VectorX scale = D.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
    return ((b - D * x).cwiseAbs().array() / scale.array()).maxCoeff();
  }
};

std::string name_of(const ::testing::TestParamInfo<std::tuple<Family, int>>& info) {
  return std::get<0>(info.param).name + "_" + std::to_string(std::get<1>(info.param)) + "d";
}

INSTANTIATE_TEST_SUITE_P(Multifrontal, Inertia,
                         ::testing::Combine(::testing::ValuesIn(regular), ::testing::Values(2, 3)), name_of);

TEST_P(Inertia, IsThatOfTheEigenvaluesInAnyUnitsAndSolvesAreExact) {
  for (int seed = 0; seed < num_seeds; ++seed) {
    BlockMatrix A = family.make(dim, seed);
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(A), Eigen::EigenvaluesOnly).eigenvalues();
    const auto expected = (eigenvalues.array() < 0).count();
    for (const bool is_scaled : {false, true}) {
      if (is_scaled) change_units(A, seed);
      const LinearReport report = solver->factorize(A);
      ASSERT_EQ(report.status, Status::ok) << seed << " " << is_scaled;
      EXPECT_EQ(report.negative_pivots, expected) << seed << " " << is_scaled;
      VectorX b, x;
      multiply(A, VectorX::Random(A.num_unknowns()), b);
      const LinearReport solve = solver->solve(A, b, x, 1e-14);
      EXPECT_LT(solve.relative_residual, 1e-12) << seed << " " << is_scaled;
      // In mixed units the small rows of b do not count in the norm that refinement stops at.
      if (!is_scaled) {
        EXPECT_LT(backward_error(A, b, x), 1e-13) << seed;
      }
    }
  }
}

TEST_P(Inertia, AndSolutionHaveTheSameBitsForAnyNumberOfThreads) {
  const BlockMatrix A = family.make(dim, 1);
  const VectorX b = VectorX::Ones(A.num_unknowns());
  const int threads_before = num_threads();
  VectorX x[2];
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    const auto fresh = make_linear_solver({.kind = "multifrontal", .is_definite = false}, 100);
    ASSERT_EQ(fresh->factorize(A).status, Status::ok);
    fresh->solve(A, b, x[threads - 1], 1e-12);
  }
  set_num_threads(threads_before);
  EXPECT_EQ(x[0], x[1]);
}

BlockMatrix free_springs(int dim, int seed) {
  Grid grid(dim, seed);
  BlockMatrix A = grid.empty_matrix();
  grid.add_springs(A);
  return A;
}

/// Two multipliers ask for the same.
BlockMatrix redundant_multipliers(int dim, int seed) {
  Grid grid(dim, seed);
  std::vector<std::pair<Index, Index>> pairs;
  for (const Index multiplier : {Grid::size, Grid::size + 1})
    for (const Index node : {3, 4, 40}) pairs.emplace_back(node, multiplier);
  BlockMatrix A = grid.empty_matrix(2, pairs);
  grid.add_springs(A);
  for (Index i = 0; i < Grid::size; ++i) A.add_block(i, i, grid.definite_block().data());
  for (std::size_t k = 0; k < 3; ++k) {
    const Block B = grid.block();
    A.add_block(pairs[k].first, pairs[k].second, B.data());
    A.add_block(pairs[k + 3].first, pairs[k + 3].second, B.data());
  }
  return A;
}

BlockMatrix row_of_zeros(int dim, int seed) {
  BlockMatrix A = any_values(dim, seed);
  std::vector<std::uint8_t> is_fixed(static_cast<std::size_t>(A.num_unknowns()), 0);
  const Index node = Grid(dim, seed).node();
  is_fixed[static_cast<std::size_t>(node * dim)] = 1;
  eliminate(A, is_fixed);
  A.add_to_diagonal(node, 0, -1);
  return A;
}

BlockMatrix springs_shifted_by_an_eigenvalue(int dim, int seed) {
  BlockMatrix A = springs_less_a_shift(dim, seed);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(A), Eigen::EigenvaluesOnly).eigenvalues();
  for (Index i = 0; i < Grid::size; ++i)
    for (int d = 0; d < dim; ++d) A.add_to_diagonal(i, d, -eigenvalues[eigenvalues.size() / 3]);
  return A;
}

const std::vector<Family> singular = {{"free_springs", free_springs},
                                      {"redundant_multipliers", redundant_multipliers},
                                      {"row_of_zeros", row_of_zeros},
                                      {"springs_shifted_by_an_eigenvalue", springs_shifted_by_an_eigenvalue}};

struct SingularMatrix : Inertia {};
INSTANTIATE_TEST_SUITE_P(Multifrontal, SingularMatrix,
                         ::testing::Combine(::testing::ValuesIn(singular), ::testing::Values(2, 3)), name_of);

TEST_P(SingularMatrix, IsReportedInAnyUnits) {
  for (int seed = 0; seed < num_seeds; ++seed) {
    BlockMatrix A = family.make(dim, seed);
    for (const bool is_scaled : {false, true}) {
      if (is_scaled) change_units(A, seed);
      const LinearReport report = solver->factorize(A);
      EXPECT_EQ(report.status, Status::indefinite) << seed << " " << is_scaled;
      EXPECT_GE(report.worst_node, 0) << seed << " " << is_scaled;
    }
  }
}

}  // namespace
}  // namespace resilin
