// The grid's Laplacian has known eigenvalues, many of them repeated.

#include "resilin/linear/eigenmodes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_matrix.hpp"

namespace resilin::testing {
namespace {

/// Springs between neighbours of an n x n grid; with or without springs from the rim to a frame.
BlockMatrix grid(int n, bool is_held) {
  const auto node = [n](int i, int j) { return static_cast<Index>(i * n + j); };
  BlockPatternBuilder builder(n * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i + 1 < n) builder.add_pair(node(i, j), node(i + 1, j));
      if (j + 1 < n) builder.add_pair(node(i, j), node(i, j + 1));
    }
  }
  BlockMatrix K(2, std::make_shared<const BlockPattern>(builder.build()));
  const double coupling[4] = {-1, 0, 0, -1};
  const auto connect = [&](Index a, Index b) {
    K.add_block(a, b, coupling);
    for (int k = 0; k < 2; ++k) {
      K.add_to_diagonal(a, k, 1);
      K.add_to_diagonal(b, k, 1);
    }
  };
  const auto hold = [&](Index a) {
    for (int k = 0; k < 2; ++k) K.add_to_diagonal(a, k, 1);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i + 1 < n) connect(node(i, j), node(i + 1, j));
      if (j + 1 < n) connect(node(i, j), node(i, j + 1));
    }
    if (!is_held) continue;
    hold(node(i, 0));
    hold(node(i, n - 1));
    hold(node(0, i));
    hold(node(n - 1, i));
  }
  return K;
}

/// 4 - 2 cos - 2 cos, each twice for the two components.
std::vector<double> exact_values(int n, bool is_held) {
  const auto of_line = [n, is_held](int k) {
    const double angle = is_held ? (k + 1) * std::numbers::pi / (n + 1) : k * std::numbers::pi / n;
    return 2 - 2 * std::cos(angle);
  };
  std::vector<double> values;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) values.insert(values.end(), 2, of_line(i) + of_line(j));
  std::ranges::sort(values);
  return values;
}

EigenModes modes_of(const BlockMatrix& K, double mass, Index count) {
  const std::vector<std::uint8_t> is_fixed(static_cast<std::size_t>(K.num_unknowns()), 0);
  const EigenProblem problem{.stiffness = K,
                             .add_mass =
                                 [mass](double factor, BlockMatrix& A) {
                                   for (Index node = 0; node < A.num_nodes(); ++node)
                                     for (int k = 0; k < A.dim; ++k)
                                       A.add_to_diagonal(node, k, factor * mass);
                                 },
                             .multiply_mass = [mass](const VectorX& x, VectorX& y) { y = mass * x; },
                             .is_fixed = is_fixed};
  const auto solver = make_linear_solver({.kind = "ldlt"}, K.num_unknowns());
  return smallest_eigenmodes(problem, count, *solver);
}

TEST(Eigenmodes, AreFoundWithAllTheirCopies) {
  for (const int n : {6, 12}) {  // a dense and a sparse search
    for (const bool is_held : {true, false}) {
      const double mass = 2.5;
      const EigenModes modes = modes_of(grid(n, is_held), mass, 14);
      ASSERT_EQ(modes.status, EigenModes::Status::converged);
      const std::vector<double> exact = exact_values(n, is_held);
      for (Eigen::Index k = 0; k < 14; ++k)
        EXPECT_NEAR(modes.values[k], exact[static_cast<std::size_t>(k)] / mass, 1e-10) << n << " " << k;
      const Eigen::MatrixXd gram = mass * modes.vectors.transpose() * modes.vectors;
      EXPECT_LT((gram - Eigen::MatrixXd::Identity(14, 14)).norm(), 1e-9);
      EXPECT_EQ((modes.values.array().abs() <= modes.zero).count(), is_held ? 0 : 2);
    }
  }
}

TEST(Eigenmodes, MayBeNegative) {
  BlockMatrix K = grid(12, true);
  for (int k = 0; k < 2; ++k) K.add_to_diagonal(66, k, -3);
  const EigenModes modes = modes_of(K, 1, 4);
  ASSERT_EQ(modes.status, EigenModes::Status::converged);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> exact(dense(K));
  EXPECT_LT(exact.eigenvalues()[0], -0.1);
  for (Eigen::Index k = 0; k < 4; ++k) EXPECT_NEAR(modes.values[k], exact.eigenvalues()[k], 1e-10);
}

TEST(Eigenmodes, CanBeStopped) {
  const BlockMatrix K = grid(12, true);
  const std::vector<std::uint8_t> is_fixed(static_cast<std::size_t>(K.num_unknowns()), 0);
  const EigenProblem problem{.stiffness = K,
                             .add_mass =
                                 [](double factor, BlockMatrix& A) {
                                   for (Index node = 0; node < A.num_nodes(); ++node)
                                     for (int k = 0; k < A.dim; ++k) A.add_to_diagonal(node, k, factor);
                                 },
                             .multiply_mass = [](const VectorX& x, VectorX& y) { y = x; },
                             .is_fixed = is_fixed};
  const auto solver = make_linear_solver({.kind = "ldlt"}, K.num_unknowns());
  const EigenModes modes = smallest_eigenmodes(problem, 10, *solver, [] { return true; });
  EXPECT_EQ(modes.status, EigenModes::Status::interrupted);
}

}  // namespace
}  // namespace resilin::testing
