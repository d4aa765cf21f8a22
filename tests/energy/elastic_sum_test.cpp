// Sums of laws on elements, and derivatives by their constants.
#include <gtest/gtest.h>

#include <cmath>

#include "element_mesh.hpp"
#include "every_element.hpp"
#include "resilin/core/error.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin {
namespace {

const Hooke sum_hooke = hooke_from_young_poisson(1, 0.45);
const Vector3 first_family(0.6, 0.8, 0), second_family(0.8, -0.6, 0);

struct SumOfLawsOnAnElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, SumOfLawsOnAnElement, ::testing::ValuesIn(elements()), name_of_element);

ElasticEnergy make_energy(const ElementInfo& element, const ElementMesh& mesh, const LawInfo& law,
                          std::span<const double> constants, const std::vector<Vector3>& fibres) {
  return {mesh.dim, {element.name, ""}, mesh.cells, mesh.X, law, constants, {fibres, fibres.size()}};
}

VectorX sum_gradient(const ElasticEnergy& energy, const VectorX& x) {
  VectorX g = VectorX::Zero(x.size());
  energy.add_gradient(x, {}, g);
  return g;
}

/// The same as the terms of its parts, each with the moduli that it has there.
TEST_P(SumOfLawsOnAnElement, IsTheSumOfTheTermsOfItsParts) {
  const ElementMesh mesh(element, 2, 0.05);
  const LawInfo& law = require_law("ogden + mooney_rivlin + holzapfel_gasser_ogden", "law");
  const std::vector<double> constants = law.constants_from(sum_hooke);
  // The second family of the only part with fibres is absent.
  const ElasticEnergy sum = make_energy(element, mesh, law, constants, {first_family, Vector3::Zero()});
  const VectorX x = mesh.moved(0.01);
  double value = 0;
  VectorX g = VectorX::Zero(x.size()), tangent_force = g, expected_force = g;
  const VectorX w = mesh.moved(0.02) - mesh.X;
  std::vector<double> densities;
  std::vector<Matrix<3>> stresses;
  for (const LawPart& part : parts_of(law)) {
    std::vector<Vector3> fibres;
    if (part.law->max_fibres > 0) fibres = {first_family};
    const ElasticEnergy own =
        make_energy(element, mesh, *find_law(part.law->name),
                    std::span(constants).subspan(part.first_constant, part.law->constants.size()), fibres);
    value += own.value(x, {});
    own.add_gradient(x, {}, g);
    own.add_tangent_forces(x, w, expected_force);
    const auto density = own.energy_densities(x);
    const auto stress = own.cauchy_stresses(x);
    densities.resize(density.size(), 0.0);
    stresses.resize(stress.size(), Matrix<3>::Zero());
    for (std::size_t i = 0; i < density.size(); ++i) {
      densities[i] += density[i];
      stresses[i] += stress[i];
    }
  }
  EXPECT_NEAR(sum.value(x, {}), value, 1e-13 * value);
  EXPECT_LT((sum_gradient(sum, x) - g).norm(), 1e-13 * g.norm());
  sum.add_tangent_forces(x, w, tangent_force);
  EXPECT_LT((tangent_force - expected_force).norm(), 1e-13 * expected_force.norm());
  const auto density = sum.energy_densities(x);
  const auto stress = sum.cauchy_stresses(x);
  for (std::size_t i = 0; i < density.size(); ++i) {
    EXPECT_NEAR(density[i], densities[i], 1e-13 * (std::abs(densities[i]) + 1e-6));
    EXPECT_LT((stress[i] - stresses[i]).norm(), 1e-12 * (stresses[i].norm() + 1e-6));
  }
  const Material material = sum.material(0);
  EXPECT_EQ(material.constants, constants);
  ASSERT_EQ(material.fibres.size(), 2U);
  EXPECT_EQ(material.fibres[0], first_family);
  EXPECT_EQ(material.fibres[1], Vector3(Vector3::Zero()));
}

/// d(g w)/dp of every constant against differences.
TEST_P(SumOfLawsOnAnElement, HasTheSlopesOfItsForcesByItsConstants) {
  const ElementMesh mesh(element, 1, 0.05);
  for (const char* name : {"ogden", "ogden + mooney_rivlin + holzapfel_gasser_ogden"}) {
    const LawInfo& law = require_law(name, "law");
    std::vector<double> constants = law.constants_from(sum_hooke);
    std::vector<Vector3> fibres;
    if (law.max_fibres > 0) fibres = {first_family, second_family};
    const VectorX x = mesh.moved(0.02), w = mesh.moved(0.03) - mesh.X;
    const ElasticEnergy energy = make_energy(element, mesh, law, constants, fibres);
    VectorX slopes = VectorX::Zero(static_cast<Eigen::Index>(constants.size())), energies = slopes;
    energy.add_parameter_slopes("constants", x, w, {}, slopes);
    energy.add_energy_slopes("constants", x, energies);
    for (std::size_t p = 0; p < constants.size(); ++p) {
      if (law.constants[p].name.ends_with("dispersion")) continue;  // at the end of its range
      const double value = constants[p], step = 1e-4 * (std::abs(value) + 1e-3);
      const auto at = [&](double c) {
        constants[p] = c;
        return make_energy(element, mesh, law, constants, fibres);
      };
      const ElasticEnergy plus = at(value + step), minus = at(value - step);
      constants[p] = value;
      const double slope = (sum_gradient(plus, x) - sum_gradient(minus, x)).dot(w) / (2 * step);
      const double scale = sum_gradient(energy, x).norm() * w.norm() / (std::abs(value) + 1e-3);
      const auto i = static_cast<Eigen::Index>(p);
      EXPECT_NEAR(slopes[i], slope, 1e-6 * scale) << law.constants[p].name;
      EXPECT_NEAR(energies[i], (plus.value(x, {}) - minus.value(x, {})) / (2 * step), 1e-6 * scale)
          << law.constants[p].name;
    }
  }
}

TEST(SumOfLawsInABody, RefusesFamiliesThatItsPartsDoNotHave) {
  const ElementMesh mesh(*find_element("P1", 3), 1, 0);
  const LawInfo& law = require_law("yeoh + holzapfel_gasser_ogden", "law");
  const std::vector<double> constants = law.constants_from(sum_hooke);
  EXPECT_THROW(
      make_energy(*find_element("P1", 3), mesh, law, constants, {first_family, second_family, first_family}),
      InputError);
  EXPECT_THROW(make_energy(*find_element("P1", 3), mesh, law, constants, {2 * first_family}), InputError);
  EXPECT_NO_THROW(make_energy(*find_element("P1", 3), mesh, law, constants, {Vector3::Zero(), first_family}));
}

}  // namespace
}  // namespace resilin
