// The laws that a viscoelastic material may have: scaling their shear moduli scales the isochoric stress and
// leaves the pressure alone.

#include <gtest/gtest.h>

#include "resilin/energy/viscoelastic.hpp"
#include "resilin/material/derive.hpp"
#include "sample_fibres.hpp"

namespace resilin::testing {
namespace {

TEST(IsochoricSplit, OfEveryLawWithABulkModulusIsScaledByItsOtherModuli) {
  int count = 0;
  for (const LawInfo* law : laws()) {
    if (!has_isochoric_split(*law)) continue;
    ++count;
    SCOPED_TRACE(law->name);
    const Hooke hooke = hooke_from_young_poisson(1e5, 0.4);
    const auto fibres = fibres_for(*law, {Vector3(1, 1, 0).normalized(), Vector3(1, -1, 0).normalized()});
    const Material material{law, law->constants_from(hooke), {fibres.begin(), fibres.end()}};
    Material scaled = material;
    const std::vector<double> factors = relaxing_factors(*law, ViscoelasticForm::simo, {.shape = 0.37});
    for (std::size_t k = 0; k < factors.size(); ++k) scaled.constants[k] *= factors[k];
    Matrix<3> F;
    F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.15, 0.1, -0.03, 1.05;
    const Matrix<3> sigma = cauchy_stress<3>(material, F), softer = cauchy_stress<3>(scaled, F);
    const Matrix<3> pressure = sigma.trace() / 3 * Matrix<3>::Identity();
    EXPECT_NEAR(softer.trace(), sigma.trace(), 1e-12 * sigma.norm());
    EXPECT_LT((softer - pressure - 0.37 * (sigma - pressure)).norm(), 1e-12 * sigma.norm());
  }
  EXPECT_EQ(count, 14);
}

}  // namespace
}  // namespace resilin::testing
