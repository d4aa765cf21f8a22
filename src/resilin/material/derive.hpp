#pragma once

#include <vector>

#include "resilin/core/projection.hpp"
#include "resilin/core/types.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

/// A law with its constants.
struct Material {
  const LawInfo* law;
  std::vector<double> constants;  ///< in the order of law->constants
  std::vector<Vector3> fibres;    ///< rest directions of the families, of length 1; empty for isotropic laws
};

/// dP/dF with vec(F) by columns.
template <int dim>
using TangentMatrix = Eigen::Matrix<double, dim * dim, dim * dim>;

// One state at a time, plainly: for tests, tables and output. In 2D F is diag(F_2, 1), plane strain. The
// kernels (energy/kernels) do the same for many elements at a time. Instantiated for dim = 2 and 3.

/// Psi [J/m^3]; zero at rest, +infinity outside the law's domain.
template <int dim>
double energy_density(const Material& material, const Matrix<dim>& deformation_gradient);

/// P = dPsi/dF [Pa]; nan outside the domain.
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& deformation_gradient);

/// dP/dF [Pa], vec(F) by columns: row i + dim j, column k + dim l is dP_ij/dF_kl. Its eigenvalues are treated
/// as `projection` says.
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& deformation_gradient,
                                  Projection projection = Projection::none);

/// sigma = P F^T / J [Pa], three by three also in plane strain. For a small-strain law, the stress itself.
template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& deformation_gradient);

/// sqrt(3/2 s:s) of the stress deviator s [Pa].
double von_mises(const Matrix<3>& stress);

/// The same from the displacement gradient H = F - I, which keeps all digits at small strain when it is
/// formed from displacements.
namespace from_displacement_gradient {
template <int dim>
double energy_density(const Material& material, const Matrix<dim>& H);
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& H);
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& H,
                                  Projection projection = Projection::none);
template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& H);
}  // namespace from_displacement_gradient

}  // namespace resilin
