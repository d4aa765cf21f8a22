#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/linear/block_pattern.hpp"

namespace resilin {

/// Symmetric sparse matrix of dim x dim blocks on a fixed pattern, plus a few blocks that come and go.
///
/// The base part never changes its pattern, so element-to-slot maps stay valid. Terms whose pairs change
/// between iterations (contact) put blocks into `extra`, which is added to the base in every product and
/// factorisation, each pair once.
struct BlockMatrix {
  struct ExtraBlock {
    Index row, column;  ///< row <= column
    Offset begin;       ///< first value in `extra_values`
  };

  int dim = 3;
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<double> values;  ///< dim * dim per slot, row-major
  std::vector<ExtraBlock> extra;
  std::vector<double> extra_values;

  BlockMatrix() = default;
  BlockMatrix(int dimension, std::shared_ptr<const BlockPattern> fixed_pattern);

  Index num_nodes() const { return pattern->num_nodes(); }
  Index num_unknowns() const { return num_nodes() * dim; }
  double* block(Offset slot) { return values.data() + slot * dim * dim; }
  const double* block(Offset slot) const { return values.data() + slot * dim * dim; }

  void set_zero();  ///< keeps the base pattern, drops the extra blocks
  /// Adds the row-major block to (i, j): to the base where the pattern has it, else as an extra block. Either
  /// order of i and j; the transpose is stored when i > j.
  void add_block(Index i, Index j, const double* block_values);
  void add_to_diagonal(Index node, int component, double value);

 private:
  double* extra_block(Index row, Index column);
  void enlarge_places();

  std::vector<Index> extra_places_;  ///< hash table of the numbers in `extra`; -1: free
};

/// y = A x. Parallel; the same bits for any number of threads.
void multiply(const BlockMatrix& A, const VectorX& x, VectorX& y);
/// The same, with memory that is kept between calls.
void multiply(const BlockMatrix& A, const VectorX& x, VectorX& y, std::vector<double>& work);

/// Takes the unknowns with is_fixed[i] != 0 out: their rows and columns become those of the identity.
/// Cost: one pass over the columns of the pattern, and the blocks of the nodes that are fixed.
void eliminate(BlockMatrix& A, std::span<const std::uint8_t> is_fixed);

}  // namespace resilin
