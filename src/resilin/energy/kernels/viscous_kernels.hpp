#pragma once

#include "resilin/energy/kernels/quadrature_kernels.hpp"

// Loops over elements of a Kelvin-Voigt solid, whose second Piola-Kirchhoff stress is S = 2 eta Edot + zeta
// tr(Edot) 1 with Edot = sym(F^T Fdot) (docs/theory/damping.md), F taken at a shape that is known.
namespace resilin {

/// Rows of lanes eta and zeta [Pa s], once or for each block.
struct ViscosityRows {
  const double* rows;
  std::size_t stride;  ///< numbers from block to block; 0 when there is one set
};
constexpr std::size_t viscosity_rows = 2;

/// For elements of every kind; linear simplices have one point and need no reference gradients.
struct ViscousKernels {
  /// Adds D v, or the absolute values of each element's share, at the owned nodes. `shape` and `velocities`:
  /// of all nodes, the displacements of the shape and v.
  void (*add_forces)(const QuadratureTile&, const ViscosityRows&, const double* shape,
                     const double* velocities, bool is_magnitude, const OwnedNodes&, double* forces);

  /// Adds `factor` times the element's share of D to upper blocks (a, b), a <= b, of matrices whose rows sum
  /// to zero, as those of D do: [tile block][pair][dim * dim][lane]. K is aligned to 64 bytes.
  void (*add_matrices)(const QuadratureTile&, const ViscosityRows&, const double* shape, double factor,
                       double* K);
};

const ViscousKernels& viscous_kernels(int dim, int num_nodes, InstructionSet set);

template <InstructionSet set>
const ViscousKernels& compiled_viscous_kernels(int dim, int num_nodes);

}  // namespace resilin
