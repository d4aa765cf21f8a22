// Stress-stretch curves: against closed forms, the slope of the energy, Hooke near rest, and known losses of
// stability.
#include "resilin/material/curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "reference_material.hpp"
#include "resilin/core/error.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

using Json = nlohmann::json;
using testing::file_laws;
using testing::file_material;
using ::testing::HasSubstr;
using testing::material_for;

constexpr LoadCase load_cases[] = {LoadCase::uniaxial, LoadCase::equibiaxial, LoadCase::planar,
                                   LoadCase::shear, LoadCase::volumetric};

/// Fibres are alike along x and y: two families across each other, or one along z.
Material sample(const LawInfo& law) {
  Material material = material_for(law, hooke_from_young_poisson(1e5 /* Pa */, 0.3));
  material.fibres =
      law.max_fibres == 1
          ? std::vector<Vector3>{Vector3::UnitZ()}
          : testing::fibres_for(law, {Vector3(1, 1, 0).normalized(), Vector3(1, -1, 0).normalized()});
  return material;
}

Material sample(std::string_view law) { return sample(*find_law(law)); }

std::string label(const Material& material, LoadCase load_case) {
  return std::string(material.law->name) + " " + std::string(name(load_case));
}

const std::map<std::string, LoadCase> file_cases = {{"uniaxial", LoadCase::uniaxial},
                                                    {"equibiaxial", LoadCase::equibiaxial},
                                                    {"plane_strain_uniaxial", LoadCase::planar},
                                                    {"simple_shear", LoadCase::shear},
                                                    {"dilation", LoadCase::volumetric}};

/// Within 1e-12 of the true number, and for numbers that are sums of cancelling terms of `size`, of that.
void expect_equal(double ours, double truth, double size, const std::string& where) {
  EXPECT_NEAR(ours, truth, 1e-12 * std::max(std::abs(truth), size)) << where;
}

void check_row(const StretchCurve& curve, std::size_t i, const Json& row, const std::string& where) {
  const std::string here = where + " " + row["value"].dump();
  if (row.contains("no_state")) {
    EXPECT_EQ(curve.stability[i], Stability::no_state) << here;
    EXPECT_TRUE(std::isnan(curve.nominal_stress[i]) && std::isnan(curve.energy_density[i])) << here;
    return;
  }
  ASSERT_NE(curve.stability[i], Stability::no_state) << here;
  const int column = curve.load_case == LoadCase::shear ? 1 : 0;
  const auto entry = [column](const Json& matrix) {
    return matrix[0][static_cast<std::size_t>(column)].get<double>();
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    expect_equal(curve.stretches[i][static_cast<int>(axis)], row["F"][axis][axis], 0, here);
  // Stresses of the strain 1e-4 are asked for to 1e-12 of themselves as well, but the file's value is
  // rounded.
  const double rounding = std::abs(row["value"].get<double>() - (column == 1 ? 0 : 1)) < 1e-3 ? 1e-3 : 0;
  expect_equal(curve.nominal_stress[i], entry(row["P"]), rounding, here);
  const Json& cauchy =
      row["cauchy"].is_null() ? row["P"] : row["cauchy"];  // cauchy of small strain: the same
  expect_equal(curve.cauchy_stress[i], entry(cauchy), rounding, here);
}

TEST(StretchCurve, EqualsTheClosedForms) {
  const Json file = testing::read_reference("closed_forms");
  int checked = 0;
  for (const auto& [key, file_law] : file_laws()) {
    if (find_law(file_law.name) == nullptr) continue;
    const Material material = file_material(file, key);
    for (const auto& [kind, load_case] : file_cases) {
      const Json& rows = file["results"][key][kind];
      std::vector<double> stretches;
      for (const Json& row : rows) stretches.push_back(row["value"]);
      const StretchCurve curve = stretch_curve(material, load_case, stretches);
      for (std::size_t i = 0; i < rows.size(); ++i, ++checked)
        check_row(curve, i, rows[i], label(material, load_case));
    }
  }
  EXPECT_GE(checked, 8 * 26);
}

/// dPsi/dl: the stresses times what the load moves.
double work_factor(LoadCase load_case) {
  return load_case == LoadCase::volumetric ? 3 : load_case == LoadCase::equibiaxial ? 2 : 1;
}

TEST(StretchCurve, StressIsTheSlopeOfTheEnergyAlongIt) {
  for (const LawInfo* law : laws())
    for (const LoadCase load_case : load_cases) {
      const Material material = sample(*law);
      const double h = 1e-4;
      std::vector<double> stretches;
      for (const double stretch : {0.7, 0.9, 1.05, 1.3})
        for (const double offset : {-h, 0.0, h}) stretches.push_back(stretch + offset);
      const StretchCurve curve = stretch_curve(material, load_case, stretches);
      for (std::size_t i = 1; i < stretches.size(); i += 3) {
        const double slope = (curve.energy_density[i + 1] - curve.energy_density[i - 1]) / (2 * h);
        // The third derivative of Psi is some 1e6 Pa, and h^2 / 6 of it remains.
        EXPECT_NEAR(work_factor(load_case) * curve.nominal_stress[i], slope, 1e-5 * std::abs(slope) + 0.1)
            << label(material, load_case) << " " << stretches[i];
      }
    }
}

TEST(StretchCurve, FreeFacesAreFreeOfStress) {
  const std::vector<double> stretches = {0.6, 0.8, 1 + 1e-9, 1.2, 1.6};
  for (const LawInfo* law : laws())
    for (const LoadCase load_case : {LoadCase::uniaxial, LoadCase::equibiaxial, LoadCase::planar}) {
      const Material material = sample(*law);
      const StretchCurve curve = stretch_curve(material, load_case, stretches);
      for (std::size_t i = 0; i < stretches.size(); ++i) {
        if (curve.stability[i] == Stability::no_state) continue;
        const Matrix<3> F = curve.stretches[i].asDiagonal();
        const Matrix<3> P = first_piola_kirchhoff_stress<3>(material, F);
        const double stiffness = stress_tangent<3>(material, F).cwiseAbs().maxCoeff();
        const int free_axis = load_case == LoadCase::equibiaxial ? 2 : 1;
        // Bound of the effect on P of rounding F to double.
        EXPECT_NEAR(P(free_axis, free_axis), 0, 1e-14 * stiffness) << label(material, load_case);
        if (load_case == LoadCase::uniaxial) {
          EXPECT_NEAR(P(2, 2), 0, 1e-14 * stiffness);
        }
        EXPECT_NEAR(curve.volume_ratio[i], F.determinant(), 1e-14 * F.determinant());
      }
    }
}

/// Young's modulus, and what stands for it when more faces are held, at a strain of 1e-7.
TEST(StretchCurve, BeginsWithTheModuliOfTheSmallStrainSolid) {
  const double e = 1e-7;
  for (const LawInfo* law : laws()) {
    Material material = sample(*law);
    if (material.law->max_fibres > 0) continue;  // they resist tension alone: no Hookean solid
    const TangentMatrix<3> A = stress_tangent<3>(material, Matrix<3>::Identity());
    const double mu = A(1, 1), lambda = A(0, 4), E = mu * (3 * lambda + 2 * mu) / (lambda + mu),
                 nu = lambda / (2 * (lambda + mu));
    const double moduli[] = {E, E / (1 - nu), E / (1 - nu * nu), mu, 3 * lambda + 2 * mu};
    for (const LoadCase load_case : load_cases) {
      const double rest = load_case == LoadCase::shear ? 0 : 1;
      const double stretch = rest + e;
      const StretchCurve curve = stretch_curve(material, load_case, std::vector<double>{stretch});
      const double expected = moduli[static_cast<int>(load_case)] * (stretch - rest);
      // Quadratic terms are some 1e-7 of the linear one.
      EXPECT_NEAR(curve.nominal_stress[0], expected, 1e-5 * expected) << label(material, load_case);
      EXPECT_EQ(curve.stability[0], Stability::stable) << label(material, load_case);
    }
  }
}

TEST(StretchCurve, KeepsTheOrderAskedForAndDoesNotDependOnTheOtherPoints) {
  const Material material = sample("neo_hookean");
  const std::vector<double> mixed = {1.5, 0.7, 1.0, 0.7, 2.5};
  const StretchCurve curve = stretch_curve(material, LoadCase::uniaxial, mixed);
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    const StretchCurve alone = stretch_curve(material, LoadCase::uniaxial, std::vector<double>{mixed[i]});
    EXPECT_EQ(curve.stretch[i], mixed[i]);
    EXPECT_NEAR(curve.nominal_stress[i], alone.nominal_stress[0], 1e-12 * std::abs(alone.nominal_stress[0]));
  }
  EXPECT_EQ(curve.nominal_stress[2], 0.0);
  EXPECT_TRUE(stretch_curve(material, LoadCase::planar, {}).stretch.empty());
}

/// P11 = E (l^3 - l)/2 with free sides: its slope vanishes at l = 1/sqrt(3), whatever nu is.
TEST(StretchCurve, SaintVenantKirchhoffGivesWayInCompression) {
  const Material material = sample("saint_venant_kirchhoff");
  const StretchCurve curve = stretch_curve(material, LoadCase::uniaxial, std::vector<double>{0.4, 0.6, 1.5});
  ASSERT_EQ(curve.limits.size(), 1u);
  EXPECT_EQ(curve.limits[0].loss, Stability::stress_drops);
  EXPECT_FALSE(curve.limits[0].above);
  EXPECT_NEAR(curve.limits[0].stretch, 1 / std::sqrt(3.0), 1e-6);
  EXPECT_EQ(curve.stability[0], Stability::stress_drops);
  EXPECT_EQ(curve.stability[1], Stability::stable);
  EXPECT_THAT(stability_text(material, curve), HasSubstr("drops below stretch 0.57735"));
}

/// x^2 = 1 - nu (l^2 - 1) for free sides: none is left beyond l^2 = 1 + 1/nu.
TEST(StretchCurve, SaintVenantKirchhoffHasNoSidesBeyondALimit) {
  const Material material = sample("saint_venant_kirchhoff");
  const StretchCurve curve = stretch_curve(material, LoadCase::uniaxial, std::vector<double>{2.0, 2.2});
  ASSERT_EQ(curve.limits.size(), 1u);
  EXPECT_EQ(curve.limits[0].loss, Stability::no_state);
  EXPECT_NEAR(curve.limits[0].stretch, std::sqrt(1 + 1 / 0.3), 1e-6);
  EXPECT_EQ(curve.stability[0], Stability::stable);
  EXPECT_EQ(curve.stability[1], Stability::no_state);
  EXPECT_TRUE(std::isnan(curve.cauchy_stress[1]) && std::isnan(curve.volume_ratio[1]));
  EXPECT_THAT(stability_text(material, curve), HasSubstr("there is no state beyond stretch"));
}

/// p = mu (l^2 - 1)/J + lambda ln J / J; with mu << lambda it drops beyond J = e.
TEST(StretchCurve, VolumetricStressOfNeoHookeanDropsBeyondE) {
  const Material material{find_law("neo_hookean"), {1e-6, 1.0}, {}};
  const StretchCurve curve = stretch_curve(material, LoadCase::volumetric, std::vector<double>{0.5, 2.0});
  ASSERT_EQ(curve.limits.size(), 1u);
  EXPECT_EQ(curve.limits[0].loss, Stability::stress_drops);
  EXPECT_NEAR(curve.limits[0].volume_ratio, std::exp(1.0), 1e-4);
  EXPECT_THAT(stability_text(material, curve), HasSubstr("the volumetric stress drops beyond stretch 1.39"));
}

TEST(StretchCurve, StateOfStableNeoHookeanIsGoneWhenTheSidesHaveClosed) {
  const Material material{find_law("stable_neo_hookean"), {1.25, 2.75}, {}};
  const StretchCurve curve = stretch_curve(material, LoadCase::uniaxial, std::vector<double>{0.2, 0.4});
  ASSERT_EQ(curve.limits.size(), 2u);
  EXPECT_EQ(curve.limits[0].loss, Stability::stress_drops);
  EXPECT_EQ(curve.limits[1].loss, Stability::no_state);
  // x^2 lambda l^2 = (lambda + mu) l - mu: positive above l = mu / (lambda + mu).
  EXPECT_NEAR(curve.limits[1].stretch, 1.25 / 4, 1e-6);
  EXPECT_EQ(curve.stability[0], Stability::no_state);
}

TEST(StretchCurve, OfLinearElasticityIsStableAndStraight) {
  const Material material = sample("linear_elastic");
  for (const LoadCase load_case : load_cases) {
    const StretchCurve curve = stretch_curve(material, load_case, std::vector<double>{0.9, 1.2, 1.4});
    EXPECT_TRUE(curve.limits.empty()) << name(load_case);
    const double rest = load_case == LoadCase::shear ? 0 : 1;
    EXPECT_NEAR(curve.nominal_stress[1] / (1.2 - rest), curve.nominal_stress[2] / (1.4 - rest),
                1e-9 * std::abs(curve.nominal_stress[1]));
    EXPECT_EQ(curve.nominal_stress, curve.cauchy_stress);
  }
}

TEST(StretchCurve, ShearIsOddAndReachesNegativeAmounts) {
  for (const LawInfo* law : laws()) {
    const Material material = sample(*law);
    const StretchCurve curve = stretch_curve(material, LoadCase::shear, std::vector<double>{-0.4, 0.4});
    EXPECT_NEAR(curve.nominal_stress[0], -curve.nominal_stress[1], 1e-12 * curve.nominal_stress[1]);
    EXPECT_EQ(curve.volume_ratio[0], 1.0);
  }
}

TEST(StretchCurve, RefusesStretchesThatAreNone) {
  const Material material = sample("neo_hookean");
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) try {
      stretch_curve(material, LoadCase::uniaxial, std::vector<double>{1.0, wrong});
      FAIL() << wrong;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("stretches[1]: expected a stretch above 0, got"));
    }
  EXPECT_THROW(stretch_curve(material, LoadCase::shear, std::vector<double>{HUGE_VAL}), InputError);
  EXPECT_THROW(require_load_case("uniaxal", "--curve"), InputError);
  EXPECT_EQ(require_load_case("planar", "--curve"), LoadCase::planar);
}

/// Stretches far beyond use give numbers or no state, never a hang or a made-up number.
TEST(StretchCurve, EndsAtExtremeStretches) {
  const std::vector<double> extremes = {1e-4, 1e-2, 30, 1e4};
  for (const LawInfo* law : laws())
    for (const LoadCase load_case : load_cases) {
      const Material material = sample(*law);
      const StretchCurve curve = stretch_curve(material, load_case, extremes);
      for (std::size_t i = 0; i < extremes.size(); ++i)
        EXPECT_EQ(std::isfinite(curve.nominal_stress[i]) && std::isfinite(curve.energy_density[i]),
                  curve.stability[i] != Stability::no_state)
            << label(material, load_case) << " " << extremes[i];
    }
}

}  // namespace
}  // namespace resilin
