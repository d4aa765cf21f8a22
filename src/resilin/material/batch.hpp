#pragma once

#include <cstddef>
#include <vector>

#include "resilin/core/cpu.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/material/law.hpp"

/// A law at many states at once, for arrays of a caller: batches of deformation gradients from Python, torch
/// or C++. Each state stands for itself: what lies outside the law's domain gives +infinity as its energy
/// and nan as the rest, for that state alone.
namespace resilin {

/// `count` states of one law. All arrays are C-contiguous; float is read and written as such, everything in
/// between is computed in double.
template <class Real>
struct StateBatch {
  const LawInfo* law;
  int dim;  ///< 3, or 2: plane strain
  std::size_t count;
  const Real* deformation_gradients;  ///< (count, dim, dim)
  /// Whether the array above holds H = F - I, which keeps all digits at small strain.
  bool holds_displacement_gradients = false;
  std::vector<Column> constants;  ///< constants of the law's formula, in its order
  /// Unit vectors of the fibre families, (count or 1, number of families, 3); null for a law without fibres.
  const double* fibres = nullptr;
  std::size_t num_fibres = 0;    ///< families, 0 to law->max_fibres
  std::size_t fibre_stride = 0;  ///< numbers from state to state: 0 or 3 num_fibres
  InstructionSet instruction_set = preferred_instruction_set();
};

/// Psi [J/m^3], (count).
template <class Real>
void energy_densities(const StateBatch<Real>& states, Real* psi);

/// P = dPsi/dF [Pa], (count, dim, dim).
template <class Real>
void first_piola_kirchhoff_stresses(const StateBatch<Real>& states, Real* P);

/// dP_ij/dF_kl [Pa], (count, dim, dim, dim, dim).
template <class Real>
void stress_tangents(const StateBatch<Real>& states, Projection projection, Real* A);

/// Forces on the corners of simplices [N], (count, dim + 1, dim): f_a = -V P dN_a/dX, where the rows of
/// Dm^-1 are the gradients of corners 1, 2, ...
/// @param rest_shape_inverses  Dm^-1, (count, dim, dim), the columns of Dm being the edges from corner 0
/// [1/m]
/// @param rest_volumes         (count) [m^3]
template <class Real>
void elastic_forces(const StateBatch<Real>& states, const Real* rest_shape_inverses, const Real* rest_volumes,
                    Real* forces);

/// dPsi/dp (count) and dP/dp (count, dim, dim) with respect to the constant of this place; either may be
/// null.
template <class Real>
void constant_derivatives(const StateBatch<Real>& states, std::size_t constant, Real* dpsi, Real* dP);

/// d2Psi/(dp dq) (count) with respect to the constants of these places.
template <class Real>
void second_constant_derivatives(const StateBatch<Real>& states, std::size_t p, std::size_t q, Real* d2psi);

// Instantiated for double and float.

}  // namespace resilin
