#pragma once

#include <memory>
#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Mass of the bodies [kg]: each entry m_ij couples nodes i and j equally in all components, M = m (x) I.
struct MassMatrix {
  int dim = 3;
  VectorX nodal;  ///< row sums, one per node [kg]; the whole matrix when it is lumped
  std::shared_ptr<const BlockPattern> pattern;  ///< set when some body has a consistent mass
  std::vector<double> slots;                    ///< one entry per slot of the pattern, then

  bool is_lumped() const { return slots.empty(); }

  /// y = M x for vectors of dim numbers per node.
  void multiply(const VectorX& x, VectorX& y) const;
  /// A += factor M.
  void add_to(double factor, BlockMatrix& A) const;
  double total() const { return nodal.sum(); }
};

}  // namespace resilin
