// Sums of laws.
#include "resilin/material/law_sum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/material/volume_energy.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

namespace derive = from_displacement_gradient;

const char* const three = "mooney_rivlin + ogden + exponential_fibre";

/// The parts of a sum, each with its own constants and fibres.
std::vector<Material> parts_of_material(const Material& sum) {
  std::vector<Material> parts;
  for (const LawPart& part : parts_of(*sum.law)) {
    const auto first = sum.constants.begin() + static_cast<std::ptrdiff_t>(part.first_constant);
    Material own{find_law(part.law->name),
                 {first, first + static_cast<std::ptrdiff_t>(part.law->constants.size())},
                 {}};
    for (int k = 0; k < part.law->max_fibres; ++k)
      own.fibres.push_back(sum.fibres[part.first_family + static_cast<std::size_t>(k)]);
    parts.push_back(std::move(own));
  }
  return parts;
}

Material sample_sum(const std::string& name) {
  const LawInfo& law = require_law(name, "law");
  Material sum{&law, law.constants_from(testing::sample_hooke()), {}};
  for (int k = 0; k < law.max_fibres; ++k)
    sum.fibres.emplace_back(k % 2 == 0 ? Vector3(0.8, 0.6, 0) : Vector3(0.8, -0.6, 0));
  return sum;
}

template <int dim>
void expect_the_sum_of_the_parts(const std::string& name) {
  const Material sum = sample_sum(name);
  for (const Matrix<dim>& H : testing::sample_gradients<dim>(*sum.law, 20)) {
    double psi = 0;
    Matrix<dim> P = Matrix<dim>::Zero();
    TangentMatrix<dim> A = TangentMatrix<dim>::Zero();
    for (const Material& part : parts_of_material(sum)) {
      psi += derive::energy_density<dim>(part, H);
      P += derive::first_piola_kirchhoff_stress<dim>(part, H);
      A += derive::stress_tangent<dim>(part, H);
    }
    EXPECT_NEAR(derive::energy_density<dim>(sum, H), psi, 1e-14 * std::abs(psi));
    EXPECT_LE((derive::first_piola_kirchhoff_stress<dim>(sum, H) - P).norm(), 1e-14 * P.norm());
    EXPECT_LE((derive::stress_tangent<dim>(sum, H) - A).norm(), 1e-14 * A.norm());
    const TangentMatrix<dim> projected = derive::stress_tangent<dim>(sum, H, Projection::clamp);
    const Eigen::SelfAdjointEigenSolver<TangentMatrix<dim>> eigen(projected);
    EXPECT_GE(eigen.eigenvalues()[0], -1e-13 * A.norm());
  }
}

TEST(SumOfLaws, IsTheSumOfItsParts) {
  for (const char* name : {"neo_hookean + neo_hookean", three, "holzapfel_gasser_ogden + exponential_fibre",
                           "stable_neo_hookean + orthotropic"}) {
    SCOPED_TRACE(name);
    expect_the_sum_of_the_parts<2>(name);
    expect_the_sum_of_the_parts<3>(name);
  }
}

TEST(SumOfLaws, IsTheSmallStrainSolidThatItsPartsShare) {
  const Hooke hooke = testing::sample_hooke();
  const TangentMatrix<3> A = derive::stress_tangent<3>(sample_sum(three), Matrix<3>::Zero());
  EXPECT_NEAR(A(0, 0), hooke.lambda + 2 * hooke.mu, 1e-9 * hooke.mu);
  EXPECT_NEAR(A(1, 1), hooke.mu, 1e-9 * hooke.mu);
}

TEST(SumOfLaws, HasTheConstantsOfItsPartsByNumber) {
  const LawInfo& law = require_law(three, "law");
  EXPECT_EQ(law.constants[0].name, "sum[0].c10");
  EXPECT_EQ(law.constants[3].name, "sum[1].mu_1");
  EXPECT_EQ(law.constants.back().name, "sum[2].fibre_power");
  EXPECT_EQ(find_law(three), &law);
  EXPECT_EQ(law.max_fibres, 2);
  EXPECT_TRUE(law.needs_positive_J);
  EXPECT_FALSE(law.has_volume_energy);
  EXPECT_TRUE(require_law("mooney_rivlin + ogden", "law").has_volume_energy);
}

TEST(SumOfLaws, HasTheDerivativesOfItsPartsByTheirConstants) {
  Material sum = sample_sum(three);
  const Matrix<3> H = testing::sample_gradients<3>(*sum.law, 1).front();
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = H;
  for (std::size_t p = 0; p < sum.constants.size(); ++p) {
    StateBatch<double> states{.law = sum.law,
                              .dim = 3,
                              .count = 1,
                              .deformation_gradients = rows.data(),
                              .holds_displacement_gradients = true,
                              .constants = {},
                              .fibres = sum.fibres.front().data(),
                              .num_fibres = sum.fibres.size()};
    for (const double& constant : sum.constants) states.constants.push_back({&constant, 0});
    double slope, second;
    constant_derivatives<double>(states, p, &slope, nullptr);
    second_constant_derivatives(states, p, p == 0 ? 3 : 0, &second);
    const double value = sum.constants[p], step = 1e-5 * (std::abs(value) + 1e-3);
    sum.constants[p] = value + step;
    const double plus = derive::energy_density<3>(sum, H);
    sum.constants[p] = value - step;
    const double minus = derive::energy_density<3>(sum, H);
    sum.constants[p] = value;
    EXPECT_NEAR(slope, (plus - minus) / (2 * step),
                1e-6 * (std::abs(slope) + plus / (std::abs(value) + 1e-3)));
    if (p >= 3 || p == 0) {
      EXPECT_EQ(second, 0);
    }
  }
}

/// Another volumetric energy for a law with an isochoric-volumetric split.
TEST(SumOfLaws, LeavesOutModuliThatAreNotGiven) {
  const LawInfo& law = require_law("mooney_rivlin + neo_hookean_isochoric_log", "law");
  const std::map<std::string, double> given = {
      {"sum[0].c10", 3}, {"sum[0].c01", 1}, {"sum[1].bulk_modulus", 500}};
  const std::vector<double> constants = resolve_constants(law, given, "material");
  EXPECT_EQ(constants, (std::vector<double>{3, 1, 0, 0, 500}));
  const double s = 1.02, J = s * s * s;
  const Material rubber{&law, constants, {}};
  const double pressure = cauchy_stress<3>(rubber, Matrix<3>(s * Matrix<3>::Identity())).trace() / 3;
  EXPECT_NEAR(pressure, 500 * std::log(J) / J, 1e-10);
  const double j = J - 1;
  std::vector<Column> columns;
  for (const double& constant : constants) columns.push_back({&constant, 0});
  const VolumeSlopes slopes =
      volume_slopes(law, std::span(&j, 1), columns, preferred_instruction_set()).front();
  EXPECT_NEAR(slopes.pressure, 500 * std::log(J) / J, 1e-10);
}

std::string error_of(const std::string& law, const std::map<std::string, double>& given) {
  try {
    resolve_constants(require_law(law, "material.law"), given, "material");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(SumOfLaws, NamesThePartThatIsWrong) {
  EXPECT_NE(error_of("yeoh + exponential_fibre",
                     {{"sum[0].c10", 1}, {"sum[0].bulk_modulus", 1}, {"sum[1].fibre_modulus", 1}})
                .find("material.sum[1].fibre_stiffening"),
            std::string::npos);
  EXPECT_NE(error_of("yeoh + gent", {{"sum[0].c10", 1}, {"sum[1].limt", 1}}).find("sum[1].limt"),
            std::string::npos);
  EXPECT_NE(error_of("yeoh + gent", {{"sum[0].c10", 1}, {"sum[1].limit", 20}}).find("stable"),
            std::string::npos);  // nothing resists a change of volume
  EXPECT_NE(error_of("yeoh + yoeh", {}).find("material.law"), std::string::npos);
  EXPECT_NE(error_of("yeoh + gent", {{"youngs_modulus", 1}}).find("sum[0].c10"), std::string::npos);
  EXPECT_EQ(find_law("linear_elastic + yeoh"), nullptr);
  for (const char* name :
       {"+", " + ", "yeoh+gent", "yeoh +", "+ yeoh", "yeoh + ", "yeoh + + gent", "yeoh ++ gent"})
    EXPECT_EQ(find_law(name), nullptr) << name;
  std::string many = "yeoh";
  for (std::size_t i = 1; i < most_in_sum; ++i) many += " + yeoh";
  EXPECT_NE(find_law(many), nullptr);
  EXPECT_EQ(find_law(many + " + yeoh"), nullptr);
}

}  // namespace
}  // namespace resilin
