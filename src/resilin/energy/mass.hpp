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

  // As a linear function of its entries: `nodal` where it is lumped, else `slots`.
  Eigen::Index num_entries() const {
    return is_lumped() ? nodal.size() : static_cast<Eigen::Index>(slots.size());
  }
  /// slopes += the slopes of w . M y by the entries.
  void add_slopes(const VectorX& w, const VectorX& y, VectorX& slopes) const;
  /// out += dM y, dM of the entries given.
  void add_change(const VectorX& entries, const VectorX& y, VectorX& out) const;

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

/// Cells whose mass `add_cell_masses` adds, as a function of density and rest positions.
struct CellMasses {
  const ElementInfo& element;
  std::span<const Index> cells;
  const VectorX& rest_positions;
  double density;  ///< [kg/m^3]
  bool is_consistent;

  /// Adds what changes of density [kg/m^3] and of rest positions [m] (may be empty: none) do to the entries
  /// of `mass` to first order.
  void add_change(const MassMatrix& mass, double density_change, const VectorX& rest_change,
                  VectorX& entries) const;
  /// From slopes by the entries of `mass`: adds those by the rest positions unless `rest_slopes` is empty.
  /// @return the slope by the density
  double add_slopes(const MassMatrix& mass, const VectorX& entry_slopes, VectorX& rest_slopes) const;
};

}  // namespace resilin
