#pragma once

#include <vector>

#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {

/// An update matrix of a front: the lower triangle of `num_delayed` unknowns that it could not eliminate and
/// of its rows below.
struct UpdateMatrix {
  double* values = nullptr;  ///< column-major
  int num_delayed = 0;
  int order = 0;  ///< its stride

  /// The part of the rows below.
  double* of_rows() const { return values + static_cast<Offset>(num_delayed) * (order + 1); }
};

/// Sums the dense matrix of a front from entries of the matrix and the update matrices of its children. The
/// unknowns of a front come in this order: its own columns, those that its children delayed, its rows below.
struct FrontAssembly {
  const MultifrontalAnalysis& analysis;
  int dim;
  Index front;          ///< the supernode
  int num_delayed = 0;  ///< by all of its children

  int num_own() const { return supernode().num_columns * dim; }
  int num_columns() const { return num_own() + num_delayed; }
  int num_rows() const { return supernode().num_rows() * dim; }
  int stride() const { return num_columns() + num_rows(); }
  const Supernode& supernode() const { return analysis.supernodes[front]; }

  /// @param values  blocks by slot of the merged pattern
  void add_entries(const std::vector<double>& values, double* panel) const;
  /// Columns of the child's update that are fully summed here; those that it delayed begin at `first_delayed`
  /// among those of all children.
  void add_to_panel(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                    double* panel) const;
  /// The rest of them. `to` is the part of the rows below.
  void add_to_update(const Supernode& child, const UpdateMatrix& update, double* to, int to_stride) const;

 private:
  void add_delayed(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                   double* panel) const;
};

}  // namespace resilin
