// Laws in plane stress: the thickness that leaves no stress across the plane, and the law of two dimensions
// that follows (tests/reference/plane_stress.json, and properties of every law).
#include "resilin/material/plane_stress.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "reference_material.hpp"
#include "resilin/material/derive.hpp"
#include "sample_states.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

using testing::hooke_of;
using testing::random_rotation;
using testing::sample_gradients;
using testing::sample_hooke;
using testing::sample_material;

const LawInfo& in_plane_stress(const LawInfo& law) { return *find_law(plane_stress_name(law.name)); }

Material twin_of(Material material) {
  material.law = &in_plane_stress(*material.law);
  return material;
}

/// F33 - 1, from H or from F.
double thickness_strain(const Material& material, const Matrix<2>& gradient, bool is_displacement) {
  const Eigen::Matrix<double, 2, 2, Eigen::RowMajor> rows = gradient;
  StateBatch<double> states{.law = material.law,
                            .dim = 2,
                            .count = 1,
                            .deformation_gradients = rows.data(),
                            .holds_displacement_gradients = is_displacement,
                            .constants = {}};
  for (const double& constant : material.constants) states.constants.push_back({&constant, 0});
  if (!material.fibres.empty()) states.fibres = material.fibres.front().data();
  states.num_fibres = material.fibres.size();
  double strain;
  thickness_strains(states, &strain);
  return strain;
}

Matrix<3> with_thickness(const Material& material, const Matrix<2>& H) {
  Matrix<3> full = Matrix<3>::Zero();
  full.topLeftCorner<2, 2>() = H;
  full(2, 2) = thickness_strain(material, H, true);
  return full;
}

/// Displacement gradients whose area is not inverted.
std::vector<Matrix<2>> plane_states(const LawInfo& law) {
  std::vector<Matrix<2>> states = sample_gradients<2>(law);
  std::erase_if(states,
                [](const Matrix<2>& H) { return !((Matrix<2>::Identity() + H).determinant() > 0.1); });
  return states;
}

Material reference_material(const nlohmann::json& sheet) {
  const std::string key = sheet["law"];
  const std::map<std::string, std::pair<std::string, std::vector<std::string>>> known = {
      {"nh_log", {"neo_hookean", {"mu", "lam"}}},
      {"snh", {"stable_neo_hookean", {"mu", "lam"}}},
      {"nh_iso_j1", {"neo_hookean_isochoric", {"mu", "kappa"}}},
      {"mooney_rivlin", {"mooney_rivlin", {"c10", "c01", "kappa"}}},
      {"gent", {"gent", {"mu", "jm", "kappa"}}}};
  const auto& [law, names] = known.at(key);
  Material material{find_law(plane_stress_name(law)), {}, {}};
  for (const std::string& name : names) material.constants.push_back(sheet["constants"][name]);
  return material;
}

double energy_at_rest(const nlohmann::json& sheet) {
  if (sheet["law"] != "snh") return 0;
  const double mu = sheet["constants"]["mu"], lambda = sheet["constants"]["lam"];
  return mu * mu / (2 * lambda);
}

TEST(PlaneStress, StretchesSheetsAsClosedFormsSay) {
  for (const auto& sheet : testing::read_reference("plane_stress")["cases"]["sheets"]) {
    const Material material = reference_material(sheet);
    const double rest = energy_at_rest(sheet), modulus = material.constants[0] + material.constants.back();
    for (const auto& row : sheet["rows"]) {
      SCOPED_TRACE(sheet["law"].dump() + " " + row["kind"].dump() + " " + row["stretches"].dump());
      const std::vector<double> stretches = row["stretches"], truth = row["P"];
      Matrix<2> H = Matrix<2>::Zero();
      H(0, 0) = stretches[0] - 1;
      H(1, 1) = stretches[1] - 1;
      EXPECT_NEAR(1 + thickness_strain(material, H, true), stretches[2], 1e-12 * stretches[2]);
      const Matrix<2> P = from_displacement_gradient::first_piola_kirchhoff_stress<2>(material, H);
      const double scale = std::abs(truth[0]) + std::abs(truth[1]);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(P(i, i), truth[static_cast<std::size_t>(i)], 1e-11 * scale + 4e-16 * modulus) << i;
      const double energy = row["energy"];
      EXPECT_NEAR(from_displacement_gradient::energy_density<2>(material, H), energy - rest,
                  1e-11 * std::abs(energy - rest) + 1e-15 * modulus);
    }
  }
}

TEST(PlaneStress, ShearsSheetsAsClosedFormsSay) {
  for (const auto& sheet : testing::read_reference("plane_stress")["cases"]["shear"]) {
    const Material material = reference_material(sheet);
    for (const auto& row : sheet["rows"]) {
      Matrix<2> H = Matrix<2>::Zero();
      H(0, 1) = row["shear"];
      const double thickness = row["thickness"], P12 = row["P12"], energy = row["energy"];
      EXPECT_NEAR(1 + thickness_strain(material, H, true), thickness, 1e-12);
      EXPECT_NEAR(from_displacement_gradient::first_piola_kirchhoff_stress<2>(material, H)(0, 1), P12,
                  1e-11 * P12);
      EXPECT_NEAR(from_displacement_gradient::energy_density<2>(material, H), energy - energy_at_rest(sheet),
                  1e-10 * energy);
      const Matrix<3> cauchy = from_displacement_gradient::cauchy_stress<2>(material, H);
      const std::vector<double> truth = row["cauchy"];
      EXPECT_NEAR(cauchy(0, 0), truth[0], 1e-11 * truth[2]);
      EXPECT_NEAR(cauchy(1, 1), truth[1], 1e-11 * truth[2]);
      EXPECT_NEAR(cauchy(0, 1), truth[2], 1e-11 * truth[2]);
      EXPECT_NEAR(cauchy(2, 2), 0, 1e-11 * truth[2]);
    }
  }
}

TEST(PlaneStress, IsTheSolidAtTheThicknessWithoutStressAcross) {
  for (const LawInfo* law : laws()) {
    const Material solid = sample_material(*law), sheet = twin_of(solid);
    for (const Matrix<2>& H : plane_states(*law)) {
      SCOPED_TRACE(std::string(law->name) + "\n" + std::to_string(H.norm()));
      const Matrix<3> full = with_thickness(sheet, H);
      const Matrix<3> P = from_displacement_gradient::first_piola_kirchhoff_stress<3>(solid, full);
      const double psi = from_displacement_gradient::energy_density<3>(solid, full);
      ASSERT_TRUE(P.allFinite());
      const double scale = P.norm() + sample_hooke().mu;
      EXPECT_NEAR(P(2, 2), 0, 1e-12 * scale * (1 + full.norm()));
      EXPECT_NEAR(from_displacement_gradient::energy_density<2>(sheet, H), psi, 1e-12 * (psi + scale));
      EXPECT_LT(
          (from_displacement_gradient::first_piola_kirchhoff_stress<2>(sheet, H) - P.topLeftCorner<2, 2>())
              .norm(),
          1e-12 * scale * (1 + full.norm()));
      // In three dimensions the twin is the solid.
      EXPECT_EQ(from_displacement_gradient::energy_density<3>(sheet, full), psi);
    }
  }
}

TEST(PlaneStress, HasTheCondensedTangent) {
  for (const LawInfo* law : laws()) {
    const Material solid = sample_material(*law), sheet = twin_of(solid);
    for (const Matrix<2>& H : plane_states(*law)) {
      const TangentMatrix<3> A =
          from_displacement_gradient::stress_tangent<3>(solid, with_thickness(sheet, H));
      TangentMatrix<2> condensed;
      constexpr std::array<int, 4> place = {0, 1, 3, 4};  // columns of 2x2 in those of 3x3
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) {
          const int a = place[static_cast<std::size_t>(i)], b = place[static_cast<std::size_t>(k)];
          condensed(i, k) = A(a, b) - A(a, 8) * A(8, b) / A(8, 8);
        }
      const TangentMatrix<2> own = from_displacement_gradient::stress_tangent<2>(sheet, H);
      EXPECT_LT((own - condensed).norm(), 1e-9 * (A.norm() + sample_hooke().mu)) << law->name << "\n" << H;
      const TangentMatrix<2> projected =
          from_displacement_gradient::stress_tangent<2>(sheet, H, Projection::clamp);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<TangentMatrix<2>>(projected).eigenvalues().minCoeff(),
                -1e-9 * A.norm())
          << law->name;
    }
  }
}

TEST(PlaneStress, FollowsRotationsInThePlane) {
  std::mt19937 random(3);
  for (const LawInfo* law : laws()) {
    if (law->kind == LawKind::small_strain) continue;
    const Material sheet = twin_of(sample_material(*law));
    for (const Matrix<2>& H : plane_states(*law)) {
      const Matrix<2> F = Matrix<2>::Identity() + H, Q = random_rotation<2>(random);
      const Matrix<2> P = first_piola_kirchhoff_stress<2>(sheet, F);
      EXPECT_NEAR(thickness_strain(sheet, Q * F, false), thickness_strain(sheet, F, false), 1e-12)
          << law->name;
      EXPECT_LT((first_piola_kirchhoff_stress<2>(sheet, Q * F) - Q * P).norm(),
                1e-10 * (P.norm() + sample_hooke().mu))
          << law->name;
    }
  }
}

/// sigma = E / (1 - nu^2) ((1 - nu) eps + nu tr eps I), and the thickness -nu / (1 - nu) tr eps, to the
/// strain itself.
TEST(PlaneStress, IsHookeanAtAStrainOfOneInABillion) {
  for (const LawInfo* law : laws()) {
    if (law->max_fibres > 0) continue;  // stiffer in their direction
    const Hooke hooke = hooke_of(*law);
    const double E = hooke.youngs_modulus(), nu = hooke.poissons_ratio();
    const Material sheet = twin_of({law, law->constants_from(hooke), {}});
    Matrix<2> H;
    H << 3e-9, 1e-9, 2e-9, -1e-9;
    const Matrix<2> strain = 0.5 * (H + H.transpose());
    const Matrix<2> expected =
        E / (1 - nu * nu) * ((1 - nu) * strain + nu * strain.trace() * Matrix<2>::Identity());
    const Matrix<2> P = from_displacement_gradient::first_piola_kirchhoff_stress<2>(sheet, H);
    EXPECT_LT((P - expected).norm(), 2e-7 * expected.norm()) << law->name;
    const double thickness = -nu / (1 - nu) * strain.trace();
    EXPECT_NEAR(thickness_strain(sheet, H, true), thickness, 2e-7 * std::abs(thickness)) << law->name;
    EXPECT_NEAR(from_displacement_gradient::energy_density<2>(sheet, H),
                0.5 * expected.cwiseProduct(strain).sum(), 2e-7 * expected.norm() * strain.norm())
        << law->name;
  }
}

TEST(PlaneStress, HasDerivativesByTheConstants) {
  for (const LawInfo* law : laws()) {
    const Material sheet = twin_of(sample_material(*law));
    Matrix<2> H;
    H << 0.3, 0.2, -0.1, 0.1;
    for (std::size_t p = 0; p < sheet.constants.size(); ++p) {
      const Eigen::Matrix<double, 2, 2, Eigen::RowMajor> rows = H;
      StateBatch<double> states{.law = sheet.law,
                                .dim = 2,
                                .count = 1,
                                .deformation_gradients = rows.data(),
                                .holds_displacement_gradients = true,
                                .constants = {}};
      for (const double& constant : sheet.constants) states.constants.push_back({&constant, 0});
      if (!sheet.fibres.empty()) states.fibres = sheet.fibres.front().data();
      states.num_fibres = sheet.fibres.size();
      Eigen::Matrix<double, 2, 2, Eigen::RowMajor> dP;
      double dpsi, second;
      constant_derivatives<double>(states, p, &dpsi, dP.data());
      second_constant_derivatives<double>(states, p, p, &second);
      if (sheet.constants[p] == 0) continue;  // at the end of its range
      const double size = std::abs(sheet.constants[p]);
      const auto changed = [&](double change) {
        Material other = sheet;
        other.constants[p] += change;
        return other;
      };
      const double h = 1e-4 * size;
      const auto energy = [&](double change) {
        return from_displacement_gradient::energy_density<2>(changed(change), H);
      };
      const auto stress = [&](double change) {
        return from_displacement_gradient::first_piola_kirchhoff_stress<2>(changed(change), H);
      };
      const double psi = energy(0);
      EXPECT_NEAR(dpsi * size, (energy(h) - energy(-h)) / (2 * h) * size, 1e-6 * psi) << law->name << p;
      EXPECT_NEAR(second * size * size, (energy(h) - 2 * psi + energy(-h)) / (h * h) * size * size,
                  1e-5 * psi)
          << law->name << p;
      const Matrix<2> difference = (stress(h) - stress(-h)) / (2 * h) * size;
      EXPECT_LT((dP * size - difference).norm(), 1e-6 * stress(0).norm()) << law->name << p;
    }
  }
}

TEST(PlaneStress, HasNoEnergyWhereThePlaneIsInverted) {
  for (const LawInfo* law : laws()) {
    if (law->kind == LawKind::small_strain) continue;
    Matrix<2> H = Matrix<2>::Zero();
    H(0, 0) = -1.5;
    EXPECT_EQ(from_displacement_gradient::energy_density<2>(twin_of(sample_material(*law)), H),
              std::numeric_limits<double>::infinity())
        << law->name;
  }
}

}  // namespace
}  // namespace resilin
