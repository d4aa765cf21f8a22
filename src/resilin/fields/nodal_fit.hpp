#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/linear/linear_solver.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Smooth fields of a body from values at quadrature points: the L2 projection onto continuous fields that
/// are linear (on squares and cubes, bilinear) in each cell.
///
///   sum_b M_ab p_b = sum_q V_q N_a(xi_q) f_q,   M_ab = sum_q V_q N_a(xi_q) N_b(xi_q)
///
/// N_a are the shape functions of the corners, V_q rest volumes; M is the consistent mass matrix of unit
/// density. Both sums run over the element's own points when there are enough of them, so that a linear field
/// is met exactly; with one point, M is exact. Nodes between corners take the value of the linear field
/// there. Solved by conjugate gradients with M's diagonal, whose condition number does not depend on the mesh
/// (Wathen 1987). Source: Zienkiewicz & Zhu 1987.
class NodalFit {
 public:
  explicit NodalFit(const Body& body);

  /// @param point_values  `components` numbers for each quadrature point, cell by cell
  /// @return              `components` numbers for each node of the body; zero at a node that no cell uses;
  /// nan
  ///                      everywhere when some value is not a finite number
  std::vector<double> fit(std::span<const double> point_values, int components);

 private:
  /// A node that is no corner, with a cell that has it as node number `local`.
  struct NodeBetween {
    std::size_t node, cell, local;
  };
  void add_matrix(const Body& body);
  void find_nodes_between(const Body& body);
  VectorX right_side(std::span<const double> point_values, std::size_t components, std::size_t first) const;

  std::size_t num_nodes_ = 0, num_points_ = 0, num_corners_ = 0;
  std::vector<Index> corners_;           ///< nodes of the body, num_corners_ for each cell
  std::vector<double> point_volumes_;    ///< [m^3]
  std::vector<double> shape_at_points_;  ///< N_a at [point * num_corners_ + a]
  std::vector<double> shape_at_nodes_;   ///< N_a at [node of the element * num_corners_ + a]
  std::vector<NodeBetween> between_;
  BlockMatrix matrix_;  ///< M for three components at a time
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace resilin
