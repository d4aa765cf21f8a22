#pragma once

#include <Eigen/Dense>
#include <memory>
#include <random>

#include "resilin/linear/block_matrix.hpp"

namespace resilin::testing {

inline Eigen::MatrixXd dense(const BlockMatrix& A) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(A.num_unknowns(), A.num_unknowns());
  const auto add = [&](Index i, Index j, const double* block) {
    for (int r = 0; r < A.dim; ++r)
      for (int c = 0; c < A.dim; ++c) {
        D(i * A.dim + r, j * A.dim + c) += block[r * A.dim + c];
        if (i != j) D(j * A.dim + c, i * A.dim + r) += block[r * A.dim + c];
      }
  };
  const BlockPattern& pattern = *A.pattern;
  for (Index i = 0; i < A.num_nodes(); ++i)
    for (Offset s = pattern.row_begin[static_cast<std::size_t>(i)];
         s < pattern.row_begin[static_cast<std::size_t>(i) + 1]; ++s)
      add(i, pattern.columns[static_cast<std::size_t>(s)], A.block(s));
  for (const BlockMatrix::ExtraBlock& extra : A.extra)
    add(extra.row, extra.column, &A.extra_values[extra.begin]);
  return D;
}

/// Random couplings of random strength; `shift` is added to the diagonal (positive definite from about 20
/// on). Some couplings stand outside the pattern, as extra blocks. `slots_per_chunk` as in
/// BlockPattern::complete.
inline BlockMatrix sample_matrix(int dim, Index num_nodes, double shift, int num_extra,
                                 Offset slots_per_chunk = 32768) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any_value(-1, 1);
  std::uniform_int_distribution<Index> any_node(0, num_nodes - 1);
  BlockPatternBuilder builder(num_nodes);
  for (Index k = 0; k < 3 * num_nodes; ++k) builder.add_pair(any_node(random), any_node(random));
  auto pattern = std::make_shared<BlockPattern>(builder.build());
  pattern->complete(slots_per_chunk);
  BlockMatrix A(dim, pattern);
  for (double& value : A.values) value = any_value(random);
  for (Index i = 0; i < num_nodes; ++i) {
    Eigen::Map<Eigen::MatrixXd> diagonal(A.block(pattern->slot(i, i)), dim, dim);
    diagonal = (diagonal + diagonal.transpose()).eval() + shift * Eigen::MatrixXd::Identity(dim, dim);
  }
  for (int k = 0; k < num_extra; ++k) {
    std::vector<double> block(static_cast<std::size_t>(dim) * dim);
    for (double& value : block) value = any_value(random);
    Index i = any_node(random), j = any_node(random);
    while (i == j || pattern->find_slot(std::min(i, j), std::max(i, j)) >= 0)
      j = any_node(random), i = any_node(random);
    A.add_block(i, j, block.data());
    A.add_block(j, i, block.data());  // a pair may come twice
  }
  return A;
}

}  // namespace resilin::testing
