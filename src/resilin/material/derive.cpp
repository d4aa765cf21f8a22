#include "resilin/material/derive.hpp"

#include <Eigen/LU>
#include <cmath>

#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

template <int dim>
using RowMajor = Eigen::Matrix<double, dim, dim, Eigen::RowMajor>;

/// A batch of one state, which must outlive it.
template <int dim>
StateBatch<double> batch_of(const Material& material, const RowMajor<dim>& gradient, bool is_displacement) {
  StateBatch<double> batch{.law = material.law,
                           .dim = dim,
                           .count = 1,
                           .deformation_gradients = gradient.data(),
                           .holds_displacement_gradients = is_displacement,
                           .constants = {}};
  for (const double& constant : material.constants) batch.constants.push_back({&constant, 0});
  if (!material.fibres.empty()) batch.fibres = material.fibres.front().data();
  batch.num_fibres = material.fibres.size();
  return batch;
}

template <int dim>
double energy(const Material& material, const Matrix<dim>& gradient, bool is_displacement) {
  const RowMajor<dim> rows = gradient;
  double psi;
  energy_densities(batch_of<dim>(material, rows, is_displacement), &psi);
  return psi;
}

template <int dim>
Matrix<dim> stress(const Material& material, const Matrix<dim>& gradient, bool is_displacement) {
  const RowMajor<dim> rows = gradient;
  RowMajor<dim> P;
  first_piola_kirchhoff_stresses(batch_of<dim>(material, rows, is_displacement), P.data());
  return P;
}

template <int dim>
TangentMatrix<dim> tangent(const Material& material, const Matrix<dim>& gradient, Projection projection,
                           bool is_displacement) {
  const RowMajor<dim> rows = gradient;
  TangentMatrix<dim> by_rows, by_columns;
  stress_tangents(batch_of<dim>(material, rows, is_displacement), projection, by_rows.data());
  const auto transposed = [](int i) { return dim * (i % dim) + i / dim; };
  for (int i = 0; i < dim * dim; ++i)
    for (int k = 0; k < dim * dim; ++k) by_columns(i, k) = by_rows(transposed(i), transposed(k));
  return by_columns;
}

/// In plane strain the third row and column are those of diag(F_2, 1), in plane stress those of the
/// thickness.
template <int dim>
Matrix<3> cauchy(const Material& material, const Matrix<dim>& gradient, bool is_displacement) {
  Matrix<3> full = Matrix<3>::Zero();
  if (!is_displacement) full = Matrix<3>::Identity();
  full.template topLeftCorner<dim, dim>() = gradient;
  if constexpr (dim == 2)
    if (is_plane_stress(*material.law)) {
      const RowMajor<2> rows = gradient;
      double strain;
      thickness_strains(batch_of<2>(material, rows, is_displacement), &strain);
      full(2, 2) += strain;
    }
  Matrix<3> P = stress<3>(material, full, is_displacement);
  if (material.law->kind == LawKind::small_strain) return P;
  const Matrix<3> F = is_displacement ? Matrix<3>(full + Matrix<3>::Identity()) : full;
  return P * F.transpose() / F.determinant();
}

}  // namespace

template <int dim>
double energy_density(const Material& material, const Matrix<dim>& F) {
  return energy<dim>(material, F, false);
}
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& F) {
  return stress<dim>(material, F, false);
}
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& F, Projection projection) {
  return tangent<dim>(material, F, projection, false);
}

template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& F) {
  return cauchy<dim>(material, F, false);
}

double von_mises(const Matrix<3>& stress) {
  const Matrix<3> deviator = stress - stress.trace() / 3 * Matrix<3>::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

namespace from_displacement_gradient {
template <int dim>
double energy_density(const Material& material, const Matrix<dim>& H) {
  return energy<dim>(material, H, true);
}
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& H) {
  return stress<dim>(material, H, true);
}
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& H, Projection projection) {
  return tangent<dim>(material, H, projection, true);
}

template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& H) {
  return cauchy<dim>(material, H, true);
}

template Matrix<3> cauchy_stress<2>(const Material&, const Matrix<2>&);
template Matrix<3> cauchy_stress<3>(const Material&, const Matrix<3>&);
template double energy_density<2>(const Material&, const Matrix<2>&);
template double energy_density<3>(const Material&, const Matrix<3>&);
template Matrix<2> first_piola_kirchhoff_stress<2>(const Material&, const Matrix<2>&);
template Matrix<3> first_piola_kirchhoff_stress<3>(const Material&, const Matrix<3>&);
template TangentMatrix<2> stress_tangent<2>(const Material&, const Matrix<2>&, Projection);
template TangentMatrix<3> stress_tangent<3>(const Material&, const Matrix<3>&, Projection);
}  // namespace from_displacement_gradient

template double energy_density<2>(const Material&, const Matrix<2>&);
template double energy_density<3>(const Material&, const Matrix<3>&);
template Matrix<2> first_piola_kirchhoff_stress<2>(const Material&, const Matrix<2>&);
template Matrix<3> first_piola_kirchhoff_stress<3>(const Material&, const Matrix<3>&);
template TangentMatrix<2> stress_tangent<2>(const Material&, const Matrix<2>&, Projection);
template TangentMatrix<3> stress_tangent<3>(const Material&, const Matrix<3>&, Projection);
template Matrix<3> cauchy_stress<2>(const Material&, const Matrix<2>&);
template Matrix<3> cauchy_stress<3>(const Material&, const Matrix<3>&);

}  // namespace resilin
