#pragma once

#include <algorithm>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {

/// An update matrix of a front: of `num_delayed` unknowns that it could not eliminate, and of its rows below.
/// One with delayed unknowns is a single block: nodes are not to be split among blocks.
struct UpdateMatrix : Trapezoid {
  int num_delayed = 0;

  /// Calls visit(first, count) for columns of the rows below, `width` at a time, which a block is a multiple
  /// of; for several at the same time.
  template <class Visit>
  void for_columns_of_rows(int width, const Visit& visit) const {
    const int num_rows = layout.order - num_delayed;
    parallel_tasks(static_cast<std::size_t>((num_rows + width - 1) / width), [&](std::size_t k) {
      const int first = num_delayed + static_cast<int>(k) * width;
      visit(first, std::min(width, layout.order - first));
    });
  }
};

/// Sums the dense matrix of a front from entries of the matrix and the update matrices of its children. The
/// unknowns of a front come in this order: its own columns, those that its children delayed, its rows below.
struct FrontAssembly {
  const MultifrontalAnalysis& analysis;
  int dim;
  std::span<const double> values;  ///< blocks by slot of the merged pattern
  Index front;                     ///< the supernode
  int num_delayed = 0;             ///< by all of its children

  int num_own() const { return supernode().num_columns * dim; }
  int num_columns() const { return num_own() + num_delayed; }
  int num_rows() const { return supernode().num_rows() * dim; }
  int height() const { return num_columns() + num_rows(); }
  const Supernode& supernode() const { return analysis.supernodes[front]; }

  void add_entries(const Trapezoid& panel) const;
  /// Columns of the child's update that are fully summed here; those that it delayed begin at `first_delayed`
  /// among those of all children.
  void add_to_panel(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                    const Trapezoid& panel) const;
  /// The rest of them.
  void add_to_update(const Supernode& child, const UpdateMatrix& update, const UpdateMatrix& to) const;

 private:
  void add_delayed(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                   const Trapezoid& panel) const;
};

}  // namespace resilin
