#pragma once

#include <memory>
#include <span>
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

/// Adds the mass of linear triangles or tetrahedra. Lumped: each node carries its share of the cell;
/// consistent: m_ab = rho V / ((d + 1) (d + 2)) (1 + delta_ab), for which `mass.pattern` and `mass.slots`
/// must be set.
/// @param cells         nodes, those of one cell after another
/// @param rest_volumes  one for each cell [m^3]
/// @param density       [kg/m^3]
void add_cell_masses(MassMatrix& mass, std::span<const Index> cells, std::span<const double> rest_volumes,
                     double density, bool is_consistent);

}  // namespace resilin
