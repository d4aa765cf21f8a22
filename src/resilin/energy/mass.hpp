#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/element/element.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Mass of the bodies [kg]: each entry m_ij couples nodes i and j equally in all components, M = m (x) I.
struct MassMatrix {
  int dim = 3;
  VectorX nodal;  ///< lumped, one per node, positive [kg]; the whole matrix when it is lumped
  std::shared_ptr<const BlockPattern> pattern;  ///< set when some body has a consistent mass
  std::vector<double> slots;                    ///< one entry per slot of the pattern, then

  bool is_lumped() const { return slots.empty(); }

  /// y = M x for vectors of dim numbers per node.
  void multiply(const VectorX& x, VectorX& y) const;
  /// y = |M| x, entry by entry: consistent masses have negative entries too, at the corners of quadratic
  /// cells.
  void multiply_magnitude(const VectorX& x, VectorX& y) const;
  /// A += factor M.
  void add_to(double factor, BlockMatrix& A) const;
  double total() const { return nodal.sum(); }
  /// The same matrix times a factor.
  MassMatrix times(double factor) const;

 private:
  /// y = M x, each entry of a matrix that is not lumped replaced by entry(m_ij).
  template <class Entry>
  void multiply_with(const Entry& entry, const VectorX& x, VectorX& y) const;
};

/// Adds the mass of a body's cells. Consistent: m_ab = rho integral N_a N_b dV, for which `mass.pattern` and
/// `mass.slots` must be set. Lumped: row sums for elements of degree 1; for those of degree 2, whose corners
/// would get negative ones, the diagonal scaled to the cell's mass.
/// Source: Hinton, Rock & Zienkiewicz 1976, "A note on mass lumping and related processes".
/// @param cells           nodes in the world, those of one cell after another
/// @param rest_positions  of all nodes of the world, dim each [m]
/// @param density         [kg/m^3]
void add_cell_masses(MassMatrix& mass, const ElementInfo& element, std::span<const Index> cells,
                     const VectorX& rest_positions, double density, bool is_consistent);

}  // namespace resilin
