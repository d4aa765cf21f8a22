// Laws against 80-digit arithmetic (validation/material_points_*.json, closed_forms.json).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "reference_material.hpp"
#include "resilin/material/derive.hpp"

namespace resilin {
namespace {

using Json = nlohmann::json;
using testing::file_laws;
using testing::file_material;

/// Our energies are zero at rest; the formulas of the files are not.
double energy_at_rest(const std::string& key, const Material& material) {
  const double mu = material.constants[0], lambda = material.constants[1];
  if (key == "snh") return mu * mu / (2 * lambda);
  if (key == "snh_log") return 9 * mu * mu / (32 * lambda) - mu / 2 * std::log(4.0);
  return 0;
}

template <int dim>
Matrix<dim> matrix_of(const Json& rows) {
  Matrix<dim> A;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) A(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return A;
}

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The sum of the absolute terms of P: those of the invariants' gradients (F, |F|^3 where the second
/// invariant is used, cof F), and what the rounding of J, a sum of products of entries of F and H, does to
/// the last one. mu and lambda are those of small strains.
template <int dim>
double size_of_terms(const Material& material, const Matrix<dim>& F) {
  const double f = F.norm() + 1, cof = dim == 3 ? f * f : f, det_terms = cof * f;
  const double J = std::abs(F.determinant());
  const TangentMatrix<3> rest = stress_tangent<3>(material, Matrix<3>(0.999 * Matrix<3>::Identity()));
  const double mu = rest(1, 1), lambda = std::abs(rest(0, 4));
  if (material.law->kind == LawKind::small_strain) return (2 * mu + 3 * lambda) * f;
  const bool has_root = material.law->constants.back().name == "bulk_modulus";
  if (material.law->uses_second_invariant && !has_root) return (mu + lambda) * f * f * f;
  double slope = mu + lambda * (J + 1), curvature = lambda, shape = mu;
  if (material.law->needs_positive_J) {
    const double t = has_root ? std::pow(J, -2.0 / 3) : 1;
    shape *= t * (material.law->uses_second_invariant ? f * f * (1 + t) : 1);
    slope += (shape * f * f + lambda * (1 + std::abs(std::log(J)))) / J;
    curvature += (shape * f * f + lambda * (1 + std::abs(std::log(J)))) / (J * J);
  }
  return shape * f + slope * cof + curvature * cof * det_terms;
}

/// Effect on P of a rounding of each entry of F on its way to I_C, and another on its way to J. Powers and
/// exponentials magnify these beyond the size of their terms.
template <int dim>
double size_of_changes(const Matrix<dim>& F, const TangentMatrix<dim>& A) {
  return 2 * A.norm() * (F.norm() + 1);
}

template <int dim>
void check_point(const Json& point, const std::string& key, const Material& material) {
  const Json& truth = point["laws"][key];
  const Matrix<dim> F = matrix_of<dim>(point["F"]);
  std::ostringstream place;
  place << key << " " << dim << "D point " << point["id"] << " " << point["kind"];
  const std::string where = place.str();
  const double psi = energy_density<dim>(material, F);
  const Matrix<dim> P = first_piola_kirchhoff_stress<dim>(material, F);
  const TangentMatrix<dim> A = stress_tangent<dim>(material, F);
  if (truth.value("overflow", false)) {  // beyond the range of doubles
    EXPECT_FALSE(std::isfinite(psi)) << where;
    EXPECT_FALSE(P.allFinite()) << where;
    return;
  }
  if (truth.value("defined", true) == false) {
    EXPECT_FALSE(std::isfinite(psi)) << where;
    EXPECT_FALSE(P.allFinite()) << where;
    EXPECT_FALSE(A.allFinite()) << where;
    return;
  }
  const double terms = size_of_terms<dim>(material, F) + (A.allFinite() ? size_of_changes<dim>(F, A) : 0);
  Matrix<dim> P_true;
  TangentMatrix<dim> A_true;  // the file counts by rows, vec(F) by columns
  const auto row_major = [](int i) { return static_cast<std::size_t>(dim * (i % dim) + i / dim); };
  for (int i = 0; i < dim * dim; ++i) P_true(i) = truth["P"][row_major(i)];
  EXPECT_LE((P - P_true).cwiseAbs().maxCoeff(), 64 * epsilon * terms) << where;

  const double rest = energy_at_rest(key, material), psi_true = truth["psi"].get<double>() - rest;
  EXPECT_NEAR(psi, psi_true, 64 * epsilon * (terms * (F.norm() + 1) + std::abs(rest))) << where;
  if (point["kind"] == "tiny strain 1e-8" && rest == 0) {
    EXPECT_NEAR(psi, psi_true, 1e-8 * psi_true) << where;
  }

  if (truth["H"].is_null()) return;  // where fibres begin to bear load the law has but one derivative
  for (int i = 0; i < dim * dim; ++i)
    for (int j = 0; j < dim * dim; ++j) A_true(i, j) = truth["H"][row_major(i)][row_major(j)];

  // Near J = 0 the tangent is as sensitive to the rounding of J as P is, once more.
  const double J = std::abs(F.determinant()),
               steep = material.law->needs_positive_J ? 1 + 64 * epsilon / (J * 1e-10) : 1;
  EXPECT_LE((A - A_true).norm(), 1e-10 * steep * (F.norm() + 1) * A_true.norm()) << where;

  std::vector<double> eigenvalues = truth["H_eigenvalues"];
  for (const Projection projection : {Projection::clamp, Projection::absolute}) {
    std::vector<double> expected;
    for (const double value : eigenvalues)
      expected.push_back(projection == Projection::clamp ? std::max(value, 0.0) : std::abs(value));
    std::ranges::sort(expected);
    const Eigen::SelfAdjointEigenSolver<TangentMatrix<dim>> solver(
        stress_tangent<dim>(material, F, projection));
    for (int i = 0; i < dim * dim; ++i)
      EXPECT_NEAR(solver.eigenvalues()[i], expected[static_cast<std::size_t>(i)],
                  1e-10 * steep * (F.norm() + 1) * A_true.norm())
          << where;
  }
}

template <int dim>
void check_file() {
  const Json file = testing::read_reference("material_points_" + std::to_string(dim) + "d");
  int checked = 0;
  for (const Json& point : file["points"])
    for (const auto& [key, law] : file_laws()) {
      check_point<dim>(point, key, file_material(file, key));
      ++checked;
    }
  EXPECT_EQ(checked, 94 * 15);
}

TEST(Validation, MaterialPointsInTwoDimensions) { check_file<2>(); }

TEST(Validation, MaterialPointsInThreeDimensions) { check_file<3>(); }

TEST(Validation, ClosedForms) {
  const Json file = testing::read_reference("closed_forms");
  int checked = 0;
  for (const auto& [key, law] : file_laws()) {
    const Material material = file_material(file, key);
    for (const auto& [kind, rows] : file["results"][key].items())
      for (const Json& row : rows) {
        if (row.contains("no_state")) continue;
        const Matrix<3> F = matrix_of<3>(row["F"]), P = matrix_of<3>(row["P"]);
        const double tolerance =
            64 * epsilon *
            (size_of_terms<3>(material, F) + size_of_changes<3>(F, stress_tangent<3>(material, F)));
        const std::string where = key + " " + kind + " " + row["value"].dump();
        EXPECT_LE((first_piola_kirchhoff_stress<3>(material, F) - P).cwiseAbs().maxCoeff(), tolerance)
            << where;
        const double rest = energy_at_rest(key, material);
        EXPECT_NEAR(energy_density<3>(material, F), row["psi"].get<double>() - rest,
                    tolerance * (F.norm() + 1))
            << where;
        if (material.law->kind == LawKind::small_strain) continue;  // its Cauchy stress is P by definition
        const Matrix<3> sigma = matrix_of<3>(row["cauchy"]);
        EXPECT_LE((cauchy_stress<3>(material, F) - sigma).cwiseAbs().maxCoeff(),
                  tolerance * (F.norm() + 1) / F.determinant())
            << where;
        ++checked;
      }
  }
  EXPECT_GT(checked, 150);
}

}  // namespace
}  // namespace resilin
