#include "resilin/material/derive.hpp"

#include <cmath>

namespace resilin {
namespace {

using Matrix9 = TangentMatrix<3>;

/// A x B: the symmetric product with cof A = 1/2 A x A (Bonet, Gil & Wood 2016).
Matrix<3> cross(const Matrix<3>& A, const Matrix<3>& B) {
  Matrix<3> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      C(i, j) = A(i1, j1) * B(i2, j2) + A(i2, j2) * B(i1, j1) - A(i1, j2) * B(i2, j1) - A(i2, j1) * B(i1, j2);
    }
  return C;
}

/// A state of strain; in 2D the third row and column of H are zero.
struct State {
  Matrix<3> F, H;
  Matrix<3> cof_H;
  Matrix<3> Y;  ///< cof F - I
  double j;

  State(const Matrix<3>& deformation_gradient, const Matrix<3>& displacement_gradient)
      : F(deformation_gradient), H(displacement_gradient) {
    cof_H = 0.5 * cross(H, H);
    Y = H.trace() * Matrix<3>::Identity() - H.transpose() + cof_H;
    const Matrix<3> cof_F = 0.5 * cross(F, F);
    const double J = F.row(0).dot(cof_F.row(0));
    // Near J = 0 the determinant of F itself: a cell that is exactly flat must be seen as such.
    j = J < 0.5 ? J - 1 : H.trace() + cof_H.trace() + det_H();
  }
  double det_H() const { return H.row(0).dot(cof_H.row(0)); }
};

/// The variables of the law's kind (material/law.hpp) and their first derivatives with respect to F.
struct Variables {
  std::array<double, 3> value;
  std::array<Matrix<3>, 3> gradient;
};

Variables variables_of(const State& s, LawKind kind) {
  const Matrix<3> I = Matrix<3>::Identity();
  if (kind == LawKind::small_strain) {
    const Matrix<3> eps = 0.5 * (s.H + s.H.transpose());
    return {{eps.squaredNorm(), 0, eps.trace()}, {2 * eps, Matrix<3>::Zero(), I}};
  }
  const double m2 = s.cof_H.trace(), det_H = s.det_H();
  return {
      {s.H.squaredNorm() - 2 * m2 - 2 * det_H, s.Y.squaredNorm() - 2 * m2 - 4 * det_H, s.j},
      {2 * (s.H - s.Y),
       2 * (s.Y.trace() * I - s.Y.transpose() + cross(s.H, s.Y) - s.Y - s.cof_H),  // 2 F x Y - 2 Y - 2 cof H
       I + s.Y}};
}

/// Derivative of `variables.gradient` in the direction dF.
std::array<Matrix<3>, 3> gradient_change(const State& s, LawKind kind, const Matrix<3>& dF) {
  if (kind == LawKind::small_strain) return {dF + dF.transpose(), Matrix<3>::Zero(), Matrix<3>::Zero()};
  const Matrix<3> d_cof = cross(s.F, dF), cof_F = Matrix<3>::Identity() + s.Y;
  return {2 * (dF - d_cof), 2 * (cross(dF, cof_F) + cross(s.F, d_cof)) - 4 * d_cof, d_cof};
}

LawValues evaluate(const Material& material, const Variables& variables) {
  return material.law->evaluate(material.constants.data(), variables.value);
}

Matrix<3> stress(const Material& material, const State& state) {
  const Variables variables = variables_of(state, material.law->kind);
  const LawValues psi = evaluate(material, variables);
  Matrix<3> P = psi.slope[0] * variables.gradient[0] + psi.slope[2] * variables.gradient[2];
  if (material.law->uses_second_invariant) P += psi.slope[1] * variables.gradient[1];
  return P;
}

Matrix9 tangent(const Material& material, const State& state) {
  constexpr int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const Variables variables = variables_of(state, material.law->kind);
  const LawValues psi = evaluate(material, variables);
  Matrix9 A;
  for (int column = 0; column < 9; ++column) {
    Matrix<3> dF = Matrix<3>::Zero();
    dF(column % 3, column / 3) = 1;
    const auto change = gradient_change(state, material.law->kind, dF);
    Matrix<3> dP = Matrix<3>::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      double slope_change = 0;
      for (std::size_t l = 0; l < 3; ++l)
        slope_change += psi.curvature[static_cast<std::size_t>(place[k][l])] *
                        variables.gradient[l](column % 3, column / 3);
      dP += slope_change * variables.gradient[k] + psi.slope[k] * change[k];
    }
    A.col(column) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dP.data());
  }
  return A;
}

template <int dim>
State state_from_F(const Matrix<dim>& F) {
  Matrix<3> F3 = Matrix<3>::Identity();
  F3.template topLeftCorner<dim, dim>() = F;
  return {F3, F3 - Matrix<3>::Identity()};
}

template <int dim>
State state_from_H(const Matrix<dim>& H) {
  Matrix<3> H3 = Matrix<3>::Zero();
  H3.template topLeftCorner<dim, dim>() = H;
  return {H3 + Matrix<3>::Identity(), H3};
}

template <int dim>
TangentMatrix<dim> projected(const Matrix9& A, Projection projection) {
  TangentMatrix<dim> part;
  for (int column = 0; column < dim * dim; ++column)
    for (int row = 0; row < dim * dim; ++row)
      part(row, column) = A(row % dim + 3 * (row / dim), column % dim + 3 * (column / dim));
  if (projection == Projection::none || !part.allFinite()) return part;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(part);  // dynamic size compiles sooner
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const Eigen::VectorXd treated =
      projection == Projection::clamp ? values.cwiseMax(0.0).eval() : values.cwiseAbs().eval();
  return eigen.eigenvectors() * treated.asDiagonal() * eigen.eigenvectors().transpose();
}

Matrix<3> cauchy(const Material& material, const State& state) {
  const Matrix<3> P = stress(material, state);
  if (material.law->kind == LawKind::small_strain) return P;
  return P * state.F.transpose() / (1 + state.j);
}

double energy(const Material& material, const State& state) {
  return evaluate(material, variables_of(state, material.law->kind)).energy;
}

}  // namespace

template <int dim>
double energy_density(const Material& material, const Matrix<dim>& F) {
  return energy(material, state_from_F<dim>(F));
}
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& F) {
  return stress(material, state_from_F<dim>(F)).template topLeftCorner<dim, dim>();
}
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& F, Projection projection) {
  return projected<dim>(tangent(material, state_from_F<dim>(F)), projection);
}

template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& F) {
  return cauchy(material, state_from_F<dim>(F));
}

double von_mises(const Matrix<3>& stress) {
  const Matrix<3> deviator = stress - stress.trace() / 3 * Matrix<3>::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

namespace from_displacement_gradient {
template <int dim>
double energy_density(const Material& material, const Matrix<dim>& H) {
  return energy(material, state_from_H<dim>(H));
}
template <int dim>
Matrix<dim> first_piola_kirchhoff_stress(const Material& material, const Matrix<dim>& H) {
  return stress(material, state_from_H<dim>(H)).template topLeftCorner<dim, dim>();
}
template <int dim>
TangentMatrix<dim> stress_tangent(const Material& material, const Matrix<dim>& H, Projection projection) {
  return projected<dim>(tangent(material, state_from_H<dim>(H)), projection);
}

template <int dim>
Matrix<3> cauchy_stress(const Material& material, const Matrix<dim>& H) {
  return cauchy(material, state_from_H<dim>(H));
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
