#pragma once

#include <vector>

#include "resilin/linear/kernels/multigrid_kernels.hpp"
#include "resilin/linear/rigid_modes.hpp"

namespace resilin {

/// One level of a multigrid: its matrix in symmetric blocks and, unless it is the coarsest, the way to the
/// next.
///
/// The structure is set up once; `refill` of the hierarchy gives new numbers to the same arrays.
struct MultigridLevel {
  int dim = 3;
  bool is_given = true;  ///< the matrix of the user (blocks of dim), not a product (blocks of 3 or 6)

  int block_size() const { return is_given ? dim : num_modes(); }
  int num_modes() const { return dim == 3 ? 6 : 3; }
  static int lanes_of(int size) { return size <= 2 ? 2 : size <= 4 ? 4 : 8; }
  int lanes() const { return lanes_of(block_size()); }
  int numbers_per_block() const { return block_size() * lanes(); }
  Index num_nodes() const { return static_cast<Index>(row_begin.size()) - 1; }

  std::vector<Offset> row_begin;  ///< strictly upper part
  std::vector<Index> columns;
  std::vector<float> blocks;  ///< the diagonal blocks, then the upper ones
  std::vector<float> inverse_diagonal;
  std::vector<std::uint8_t> is_absent;  ///< by unknown: its row is empty and becomes that of the identity

  FullPattern full;
  std::vector<Offset> prolongation_begin;
  std::vector<Index> prolongation_columns;
  std::vector<float> prolongation, tentative;
  std::vector<std::int16_t> smoothing_places;
  std::vector<std::uint16_t> product_width, product_places;
  std::vector<std::int32_t> coarse_blocks;
  std::vector<float> row_work;

  std::vector<float> x, r, b, first_x, first_r;  ///< vectors of a cycle, `lanes` numbers for each node

  /// Sets up the way down by these groups of nodes, and the structure of the next level.
  void connect(const Aggregates& groups, MultigridLevel& coarse);
  void set_tentative(const Modes& modes);
  void allocate();  ///< blocks and vectors, once the structure stands

  /// After new blocks: the inverse of the diagonal, raised a little where single precision has cost a block
  /// its definiteness. False where more is amiss.
  bool invert_diagonal();
  /// The largest eigenvalue of D^-1 A, a little from below (power iteration).
  float largest_eigenvalue();
  /// Smooths the prolongation and writes P^T A P into the blocks of `coarse`.
  void project_to(MultigridLevel& coarse);

  detail::LevelView view() const;
  detail::TransferView transfer();

 private:
  struct ProductRows {
    std::vector<Offset> begin;
    std::vector<Index> columns;
  };
  void find_prolongation(const Aggregates& groups);
  ProductRows find_product_rows(Index num_groups);
  void find_coarse_rows(Index num_groups, const ProductRows& product, MultigridLevel& coarse);
};

}  // namespace resilin
