#pragma once

#include "resilin/energy/kernels/quadrature_kernels.hpp"

// Loops over elements of a viscoelastic body, for the part s C:H / 2 + q ln J of a stage's energy density. H
// is a known symmetric tensor at each quadrature point, q a known stress, s is J^(-2/3) or 1
// (energy/viscoelastic.hpp).
namespace resilin {

/// Numbers of a symmetric tensor as a history has them: xx, yy, zz, xy, yz, xz.
constexpr int symmetric_size = 6;

/// H and, where the pressure relaxes, q of all blocks by rows of lanes: [block][point][size()][lane].
struct OverstressRows {
  const double* H;
  bool is_isochoric;  ///< s = J^(-2/3), else 1
  bool has_pressure;  ///< there is a q

  constexpr std::size_t size() const { return symmetric_size + (has_pressure ? 1U : 0U); }
};

/// For elements of every kind.
/// Displacements are those of all nodes.
struct OverstressKernels {
  /// Adds weight * (energy density at `to` less that at `from`). Factors are taken as differences, so that
  /// the sum keeps its digits where the two shapes are close.
  void (*add_differences)(const QuadratureTile&, const OverstressRows&, const double* from, const double* to,
                          EnergySum&);

  /// Adds weight times the absolute values of the parts of the energy density.
  void (*add_magnitudes)(const QuadratureTile&, const OverstressRows&, const double* displacements,
                         EnergySum&);

  /// Adds dE/dx, or the absolute values of each element's share, at the owned nodes.
  void (*add_forces)(const QuadratureTile&, const OverstressRows&, const double* displacements,
                     bool is_magnitude, const OwnedNodes&, double* forces);

  /// Adds the element Hessians to upper blocks (a, b), a <= b, of matrices whose rows sum to zero:
  /// [tile block][pair][dim * dim][lane]. With n_a = F^-T g_a, q_a = F H g_a and t = C:H the exact block
  /// is, for s = J^(-2/3),
  ///
  ///   s ((g_a.H g_b) 1 - 2/3 (n_a q_b^T + q_a n_b^T) + t/3 n_b n_a^T + 2/9 t n_a n_b^T) - q n_b n_a^T.
  ///
  /// and (g_a.H g_b) 1 - q n_b n_a^T for s = 1. With `removed` > 0 it is s (g_a.H' g_b) 1 instead, where
  /// `removed` times the negative part of the eigenvalues of H is taken off: positive semi-definite, and
  /// close where the branches pull.
  void (*add_matrices)(const QuadratureTile&, const OverstressRows&, const double* displacements,
                       double removed, double* K);
};

const OverstressKernels& overstress_kernels(int dim, int num_nodes, InstructionSet set);

/// Likewise for axisymmetric solids (axisymmetric_kernels.hpp), for which the rows of a matrix sum to
/// nothing.
const OverstressKernels& axisymmetric_overstress_kernels(int num_nodes, InstructionSet set);

template <InstructionSet set>
const OverstressKernels& compiled_overstress_kernels(int dim, int num_nodes);
template <InstructionSet set>
const OverstressKernels& compiled_axisymmetric_overstress_kernels(int num_nodes);

}  // namespace resilin
