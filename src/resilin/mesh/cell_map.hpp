#pragma once

#include <optional>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"
#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// The rest shape of cells, and its inverse: from places in space to reference coordinates. In 2D the third
/// coordinate is zero.
class CellMap {
 public:
  /// @param cells           nodes, element.num_nodes for each cell; every cell has positive volume
  /// @param rest_positions  dim numbers per node [m]
  CellMap(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions);

  Index num_cells() const { return static_cast<Index>(affine_.size()); }
  const ElementInfo& element() const { return element_; }
  const CellBlock& block() const { return block_; }
  std::span<const Index> nodes(Index cell) const { return block_.cell(cell); }

  /// X(xi) is affine: of straight simplices and of parallelepipeds.
  bool is_affine(Index cell) const { return affine_[static_cast<std::size_t>(cell)].is_exact; }

  /// A box around the whole cell, also a curved one.
  Box box(Index cell) const;
  double mean_edge(Index cell) const;  ///< [m]

  /// X(xi) [m].
  Vector3 place(Index cell, const Vector3& xi) const;

  /// Depth of xi in the reference cell: the least of the barycentric coordinates, or of the distances from
  /// the sides of the unit square or cube; negative outside.
  double depth(const Vector3& xi) const;

  /// xi with X(xi) = X for a place in the cell or near it; empty where Newton's method finds none.
  std::optional<Vector3> invert(Index cell, const Vector3& X) const;

  /// Weights of the nodes at X, of which xi is the place in the cell or the nearest to it: the shape
  /// functions and their slope from there to X. They sum to one, and sum_a w_a X_a = X.
  void weights_at(Index cell, const Vector3& xi, const Vector3& X, std::span<double> weights) const;

 private:
  struct Affine {
    Vector3 origin;
    Matrix<3> dxi_dX;
    bool is_exact;
  };

  const Vector3& node(Index cell, int a) const;
  Matrix<3> dX_dxi(Index cell, const Vector3& xi) const;
  Affine affine_of(Index cell) const;

  const ElementInfo& element_;
  CellBlock block_;
  std::vector<Vector3> places_;  ///< places of the nodes [m]
  std::vector<Affine> affine_;
};

}  // namespace resilin
