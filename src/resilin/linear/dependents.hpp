#pragma once

#include <array>
#include <span>
#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Unknowns that follow from others, x_i = sum_j w_ij x_j + c_i, and what becomes of forces and matrices
/// when they are eliminated: g_r = C^T g and H_r = C^T H C, with x = C q + c.
///
/// They keep their place in all vectors and in the pattern. Their forces stay where they are, as the force
/// that holds them; their rows and columns of a reduced matrix are zero, for `eliminate` to complete.
class Dependents {
 public:
  struct Weight {
    Index unknown;
    double value;
  };
  struct Relation {
    Index unknown;           ///< follows ...
    std::vector<Weight> by;  ///< ... these, none of which follows others; each once
  };

  /// @param relations  one for each dependent unknown at most
  Dependents(int dim, Index num_unknowns, std::vector<Relation> relations);

  std::span<const Relation> relations() const { return relations_; }
  bool is_dependent(Index unknown) const { return row_of_[static_cast<std::size_t>(unknown)] >= 0; }

  /// Adds C^T f of dependent unknowns to the others; or the same with |weights|.
  void add_forces(VectorX& forces) const;
  void add_magnitudes(VectorX& magnitudes) const;
  /// Makes the dependent entries those that follow from the others, without constants.
  void follow(VectorX& change) const;
  /// Likewise of positions. @param constants  c_i at the dependent unknowns
  void place(const VectorX& constants, VectorX& positions) const;

  /// The pattern with the couplings of C^T H C besides those of H.
  BlockPattern extended(const BlockPattern& pattern, BlockPatternBuilder builder) const;
  /// H becomes C^T H C. Cost: the blocks of nodes with dependent unknowns.
  void reduce(BlockMatrix& matrix) const;

 private:
  /// The part of a node in dependent nodes: x_i = sum_m W_im x_m, W row-major; itself where nothing follows.
  struct Part {
    Index node;
    std::array<double, 9> weights;
  };
  std::vector<Part> parts_of(Index node) const;
  void add_reduced(Index i, Index j, const double* block, BlockMatrix& matrix) const;

  int dim_;
  std::vector<Relation> relations_;
  std::vector<Index> row_of_;             ///< by unknown: number of its relation; -1: none
  std::vector<std::vector<Part>> parts_;  ///< by node; empty where none of its unknowns is dependent
};

}  // namespace resilin
