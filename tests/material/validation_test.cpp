// Laws against 80-digit arithmetic (validation/material_points_*.json, closed_forms.json).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "resilin/material/derive.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

using Json = nlohmann::json;

const std::map<std::string, std::string> law_names = {{"nh_log", "neo_hookean"},
                                                      {"nh_j1_log", "neo_hookean_quadratic"},
                                                      {"snh", "stable_neo_hookean"},
                                                      {"snh_log", "stable_neo_hookean_log"},
                                                      {"nh_iso_j1", "neo_hookean_isochoric"},
                                                      {"nh_iso_simo", "neo_hookean_simo"},
                                                      {"stvk", "saint_venant_kirchhoff"},
                                                      {"linear", "linear_elastic"}};

Material material_of(const Json& file, const std::string& key) {
  const Json& parameters = file["laws"][key]["parameters"];
  const double second = parameters.contains("kappa") ? parameters["kappa"] : parameters["lam"];
  return {find_law(law_names.at(key)), {parameters["mu"], second}};
}

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
/// the last one.
template <int dim>
double size_of_terms(const Material& material, const Matrix<dim>& F) {
  const double f = F.norm() + 1, cof = dim == 3 ? f * f : f, det_terms = cof * f;
  const double J = std::abs(F.determinant());
  const double mu = material.constants[0], lambda = std::abs(material.constants[1]);
  if (material.law->kind == LawKind::small_strain) return (2 * mu + 3 * lambda) * f;
  if (material.law->uses_second_invariant) return (mu + lambda) * f * f * f;
  double slope = mu + lambda * (J + 1), curvature = lambda, shape = mu;
  if (material.law->needs_positive_J) {
    const double t = material.law->constants[1].name == "bulk_modulus" ? std::pow(J, -2.0 / 3) : 1;
    shape *= t;
    slope += (mu * t * f * f + lambda * (1 + std::abs(std::log(J)))) / J;
    curvature += (mu * t * f * f + lambda * (1 + std::abs(std::log(J)))) / (J * J);
  }
  return shape * f + slope * cof + curvature * cof * det_terms;
}

template <int dim>
void check_point(const Json& point, const std::string& key, const Material& material) {
  const Json& truth = point["laws"][key];
  const Matrix<dim> F = matrix_of<dim>(point["F"]);
  const std::string where = key + " " + std::to_string(dim) + "D point " + point["id"].dump() + " " +
                            point["kind"].get<std::string>();
  const double psi = energy_density<dim>(material, F);
  const Matrix<dim> P = first_piola_kirchhoff_stress<dim>(material, F);
  const TangentMatrix<dim> A = stress_tangent<dim>(material, F);
  if (truth.value("defined", true) == false) {
    EXPECT_FALSE(std::isfinite(psi)) << where;
    EXPECT_FALSE(P.allFinite()) << where;
    EXPECT_FALSE(A.allFinite()) << where;
    return;
  }
  const double terms = size_of_terms<dim>(material, F);
  Matrix<dim> P_true;
  TangentMatrix<dim> A_true;  // the file counts by rows, vec(F) by columns
  const auto row_major = [](int i) { return static_cast<std::size_t>(dim * (i % dim) + i / dim); };
  for (int i = 0; i < dim * dim; ++i) {
    P_true(i) = truth["P"][row_major(i)];
    for (int j = 0; j < dim * dim; ++j) A_true(i, j) = truth["H"][row_major(i)][row_major(j)];
  }
  EXPECT_LE((P - P_true).cwiseAbs().maxCoeff(), 64 * epsilon * terms) << where;

  const double rest = energy_at_rest(key, material), psi_true = truth["psi"].get<double>() - rest;
  EXPECT_NEAR(psi, psi_true, 64 * epsilon * (terms * (F.norm() + 1) + std::abs(rest))) << where;
  if (point["kind"] == "tiny strain 1e-8" && rest == 0) {
    EXPECT_NEAR(psi, psi_true, 1e-8 * psi_true) << where;
  }

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
  const Json file = testing::read_validation_case("material_points_" + std::to_string(dim) + "d");
  int checked = 0;
  for (const Json& point : file["points"])
    for (const auto& [key, name] : law_names) {
      check_point<dim>(point, key, material_of(file, key));
      ++checked;
    }
  EXPECT_EQ(checked, 94 * 8);
}

TEST(Validation, MaterialPointsInTwoDimensions) {
  RESILIN_NEEDS_SHARED_DATA();
  check_file<2>();
}

TEST(Validation, MaterialPointsInThreeDimensions) {
  RESILIN_NEEDS_SHARED_DATA();
  check_file<3>();
}

TEST(Validation, ClosedForms) {
  RESILIN_NEEDS_SHARED_DATA();
  const Json file = testing::read_validation_case("closed_forms");
  int checked = 0;
  for (const auto& [key, name] : law_names) {
    const Material material = material_of(file, key);
    for (const auto& [kind, rows] : file["results"][key].items())
      for (const Json& row : rows) {
        if (row.contains("no_state")) continue;
        const Matrix<3> F = matrix_of<3>(row["F"]), P = matrix_of<3>(row["P"]);
        const double tolerance = 64 * epsilon * size_of_terms<3>(material, F);
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
