#pragma once

#include <vector>

#include "resilin/linear/kernels/multigrid_kernels.hpp"
#include "resilin/linear/rigid_modes.hpp"
#include "resilin/linear/sweep_order.hpp"

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
  int numbers_per_block() const { return block_size() * block_size(); }
  /// Couplings of a chunk: some five microseconds of a sweep.
  Offset least_couplings() const { return is_given ? 6000 : 600; }
  Index num_nodes() const { return static_cast<Index>(row_begin.size()) - 1; }

  std::vector<Offset> row_begin;  ///< strictly upper part
  std::vector<Index> columns;
  std::vector<float> blocks;  ///< the diagonal blocks, then the upper ones; see LevelView
  std::vector<float> inverse_diagonal;
  std::vector<std::uint8_t> is_absent;  ///< by unknown: its row is empty and becomes that of the identity

  LowerPattern lower;
  FullPattern full() const { return {row_begin, columns, lower}; }
  std::vector<Offset> prolongation_begin;
  std::vector<Index> prolongation_columns;
  /// See ShortNumbers: of the prolongation an error of a few millionths of a row's largest number is not seen
  /// beside what the smoother leaves.
  struct Shortened {
    std::vector<std::int16_t> numbers;
    std::vector<float> scales;

    void resize(std::size_t count, std::size_t num_nodes) {
      numbers.resize(count);
      scales.resize(num_nodes);
    }
    detail::ShortNumbers view() { return {numbers.data(), scales.data()}; }
  };
  Shortened prolongation, tentative;
  std::vector<Offset> target_begin;
  /// See TransferView; in one byte each where that is enough for all of them.
  template <class Place>
  struct Places {
    std::vector<Place> lower, smoothing, coarse;
  };
  Places<std::uint8_t> narrow_places;
  Places<std::uint16_t> wide_places;
  bool has_narrow_places() const { return wide_places.coarse.empty(); }

  ColoredChunks sweeps;             ///< sweeps of nodes that have no neighbour in common: see two_color_order
  ColoredChunks transfers;          ///< transfers of nodes that reach no group in common
  std::vector<Index> along_layers;  ///< nodes as they lie beside each other: so they are grouped

  std::vector<float> x, r, b, first_x, first_r;  ///< vectors of a cycle, `lanes` numbers for each node

  /// Sets up the way down by these groups of nodes, and the structure of the next level. The groups are
  /// numbered anew, in the order of that level's sweeps. False where a node reaches so many groups that the
  /// maps cannot count them: this level is the coarsest then.
  bool connect(Aggregates& groups, MultigridLevel& coarse);
  void set_tentative(const std::vector<float>& modes);
  void allocate();  ///< blocks and vectors, once the structure stands

  /// After new blocks: the inverse of the diagonal, raised a little where single precision has cost a block
  /// its definiteness. False where more is amiss.
  bool invert_diagonal();
  /// The largest eigenvalue of D^-1 A, a little from below (power iteration).
  float largest_eigenvalue();
  /// Smooths the prolongation and writes P^T A P into the blocks of `coarse`.
  void project_to(MultigridLevel& coarse);

  void multiply(const std::vector<float>& from, std::vector<float>& to) const;  ///< to = A from
  void pre_smooth();                                ///< b = r, x = (D + L)^-1 r, then r = the residual of x
  void post_smooth();                               ///< x = (D + U)^-1 (b - L x), b destroyed
  void restrict_to(MultigridLevel& coarse);         ///< the r of `coarse` from this one's
  void prolong_from(const MultigridLevel& coarse);  ///< adds the x of `coarse` to this one's

 private:
  /// Fine nodes by the groups that they reach, and the columns of their rows of A P.
  struct ProductRows {
    std::vector<Offset> begin;
    std::vector<Index> columns;
    std::vector<Offset> reach_begin;
    std::vector<Index> reach_nodes;
    std::vector<Offset> reach_targets;  ///< the first one of the node's products with the group

    /// Calls visit(column, target) for the products that make the row of a group, some columns again and
    /// again.
    template <class Visit>
    void for_each(Index group, const Visit& visit) const {
      for (Offset t = reach_begin[group]; t < reach_begin[group + 1]; ++t) {
        const Offset first = begin[reach_nodes[t]], last = begin[reach_nodes[t] + 1];
        for (Offset c = first; c < last; ++c) visit(columns[c], reach_targets[t] + c - first);
      }
    }
  };
  detail::LevelView view() const;
  detail::TransferView transfer();
  detail::CoarseView writable();
  template <class Kernel>
  Kernel of_kind(const Kernel (&kernels)[2][2]) const {
    return kernels[dim - 2][is_given ? 0 : 1];
  }
  /// Those of the Galerkin product, for levels whose places count in one byte and in two.
  template <class Kernel>
  Kernel of_places(const Kernel (&kernels)[2][2][2]) const {
    return of_kind(kernels[has_narrow_places() ? 0 : 1]);
  }
  bool find_lower_places();
  bool find_prolongation(const Aggregates& groups);
  ProductRows find_product_rows(Index num_groups);
  static NodeGraph couple_groups(const ProductRows& product);
  bool find_coarse_rows(const ProductRows& product, const NodeGraph& graph, const SweepOrder& order,
                        MultigridLevel& coarse);
  void color_transfers(Index num_groups);
  void narrow_the_places();

  /// Memory of one task for the widest row of A P, each row of its blocks padded.
  std::vector<float> row_work() const;

  std::size_t widest_product_ = 0;  ///< columns of a row of A P
};

}  // namespace resilin
