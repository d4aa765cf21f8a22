#pragma once

#include "resilin/energy/kernels/quadrature_kernels.hpp"

// Loops over elements of axisymmetric solids (docs/theory/axisymmetry.md). Nodes have two numbers, r and z;
// states have three dimensions, the third being the hoop direction. Their tiles hold more than others:
// `reference_gradients` is [point][node][3] with N as third number, `inverse_jacobians` is
// [block][point][5][lane] with 1/R as fifth row. H and P have nine rows, tangents 81.
namespace resilin {

/// For elements of three nodes as well.
const QuadratureKernels& axisymmetric_kernels(int num_nodes, InstructionSet set);

template <InstructionSet set>
const QuadratureKernels& compiled_axisymmetric_kernels(int num_nodes);

}  // namespace resilin
