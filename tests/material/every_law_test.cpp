// Properties that every law of the catalogue has, in 2D and in 3D.
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/material/derive.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

using testing::random_rotation;
using testing::sample_gradients;
using testing::sample_hooke;
using testing::sample_material;
namespace derive = from_displacement_gradient;

/// Calls `check.template operator()<dim>(law, material)` for every law in both dimensions.
template <class Check>
void for_every_law(const Check& check) {
  for (const LawInfo* law : laws()) {
    SCOPED_TRACE(law->name);
    check.template operator()<2>(*law, sample_material(*law));
    check.template operator()<3>(*law, sample_material(*law));
  }
}

/// A scale for stresses: the shear modulus times the size of what is differentiated.
double stiffness() { return sample_hooke().mu; }

TEST(EveryLaw, StressIsTheSlopeOfTheEnergy) {
  for_every_law([]<int dim>(const LawInfo& law, const Material& material) {
    for (const Matrix<dim>& H : sample_gradients<dim>(law)) {
      const Matrix<dim> P = derive::first_piola_kirchhoff_stress<dim>(material, H);
      for (int i = 0; i < dim * dim; ++i) {
        const double step = 1e-5;  // central difference: error about step^2, round-off 1e-16 / step
        Matrix<dim> plus = H, minus = H;
        plus(i) += step;
        minus(i) -= step;
        const double slope =
            (derive::energy_density<dim>(material, plus) - derive::energy_density<dim>(material, minus)) /
            (2 * step);
        EXPECT_NEAR(slope, P(i), 1e-6 * (P.norm() + stiffness())) << "dim " << dim << "\n" << H;
      }
    }
  });
}

TEST(EveryLaw, TangentIsTheSlopeOfTheStress) {
  for_every_law([]<int dim>(const LawInfo& law, const Material& material) {
    for (const Matrix<dim>& H : sample_gradients<dim>(law)) {
      const TangentMatrix<dim> A = derive::stress_tangent<dim>(material, H);
      for (int i = 0; i < dim * dim; ++i) {
        const double step = 1e-5;
        Matrix<dim> plus = H, minus = H;
        plus(i) += step;
        minus(i) -= step;
        const Matrix<dim> slope = (derive::first_piola_kirchhoff_stress<dim>(material, plus) -
                                   derive::first_piola_kirchhoff_stress<dim>(material, minus)) /
                                  (2 * step);
        const Eigen::Map<const Eigen::Matrix<double, dim * dim, 1>> expected(slope.data());
        EXPECT_LT((A.col(i) - expected).norm(), 1e-6 * (A.norm() + stiffness())) << "dim " << dim << "\n"
                                                                                 << H;
      }
    }
  });
}

TEST(EveryLaw, IgnoresRotationsOfSpaceAndOfTheMaterial) {
  std::mt19937 random(3);
  for_every_law([&]<int dim>(const LawInfo& law, const Material& material) {
    if (law.kind == LawKind::small_strain) return;  // rotations strain it, by design
    const bool is_isotropic = law.max_fibres == 0;
    for (const Matrix<dim>& H : sample_gradients<dim>(law)) {
      const Matrix<dim> F = Matrix<dim>::Identity() + H, Q = random_rotation<dim>(random);
      const double psi = energy_density<dim>(material, F), scale = std::abs(psi) + stiffness();
      const Matrix<dim> P = first_piola_kirchhoff_stress<dim>(material, F);
      EXPECT_NEAR(energy_density<dim>(material, Q * F), psi, 1e-12 * scale);
      if (is_isotropic) {
        EXPECT_NEAR(energy_density<dim>(material, F * Q), psi, 1e-12 * scale);
      }
      EXPECT_LT((first_piola_kirchhoff_stress<dim>(material, Q * F) - Q * P).norm(),
                1e-12 * (P.norm() + scale));
    }
  });
}

TEST(EveryLaw, HasNoEnergyAndNoStressAtRest) {
  for_every_law([]<int dim>(const LawInfo&, const Material& material) {
    const Matrix<dim> zero = Matrix<dim>::Zero();
    EXPECT_EQ(derive::energy_density<dim>(material, zero), 0);
    EXPECT_EQ(derive::first_piola_kirchhoff_stress<dim>(material, zero).norm(), 0);
  });
}

TEST(EveryLaw, IsHookeanAtRestForTheGivenYoungsModulusAndPoissonsRatio) {
  for (const double wished : {-0.4, 0.0, 0.3, 0.495}) {
    for (const LawInfo* law : laws()) {
      const double only = law->only_poissons_ratio, poissons_ratio = std::isnan(only) ? wished : only;
      const Hooke hooke = hooke_from_young_poisson(1e5, poissons_ratio);
      const Material material = testing::material_for(*law, hooke);
      const TangentMatrix<3> A = derive::stress_tangent<3>(material, Matrix<3>::Zero());
      for (int column = 0; column < 9; ++column) {
        Matrix<3> dF = Matrix<3>::Zero();
        dF(column) = 1;
        const Matrix<3> expected =
            hooke.mu * (dF + dF.transpose()) + hooke.lambda * dF.trace() * Matrix<3>::Identity();
        const Eigen::Map<const Eigen::Matrix<double, 9, 1>> vector(expected.data());
        EXPECT_LT((A.col(column) - vector).norm(), 1e-13 * A.norm()) << law->name << " nu " << poissons_ratio;
      }
    }
  }
}

TEST(EveryLaw, KeepsItsDigitsAtAStrainOfOneInABillion) {
  for_every_law([]<int dim>(const LawInfo& law, Material material) {
    std::mt19937 random(11);
    const Hooke hooke = testing::hooke_of(law);
    material.fibres.clear();  // in tension they add to Hooke's law
    const Matrix<dim> H = 1e-9 * testing::random_matrix<dim>(random), eps = 0.5 * (H + H.transpose());
    const double psi = hooke.mu * eps.squaredNorm() + 0.5 * hooke.lambda * eps.trace() * eps.trace();
    const Matrix<dim> sigma = 2 * hooke.mu * eps + hooke.lambda * eps.trace() * Matrix<dim>::Identity();
    // Hooke's law itself is off by the strain.
    EXPECT_NEAR(derive::energy_density<dim>(material, H), psi, 1e-7 * psi);
    EXPECT_LT((derive::first_piola_kirchhoff_stress<dim>(material, H) - sigma).norm(), 1e-7 * sigma.norm());
  });
}

TEST(EveryLaw, HasASymmetricTangentAndAPositiveProjectedOne) {
  for_every_law([]<int dim>(const LawInfo& law, const Material& material) {
    for (const Matrix<dim>& H : sample_gradients<dim>(law)) {
      const TangentMatrix<dim> A = derive::stress_tangent<dim>(material, H);
      EXPECT_LE((A - A.transpose()).norm(), 1e-13 * A.norm());
      for (const Projection projection : {Projection::clamp, Projection::absolute}) {
        const TangentMatrix<dim> B = derive::stress_tangent<dim>(material, H, projection);
        const Eigen::SelfAdjointEigenSolver<TangentMatrix<dim>> eigen(B);
        EXPECT_GE(eigen.eigenvalues()[0], -1e-13 * A.norm());
      }
    }
  });
}

TEST(EveryLaw, SaysSoOutsideItsDomain) {
  for_every_law([]<int dim>(const LawInfo& law, const Material& material) {
    Matrix<dim> flat = Matrix<dim>::Identity(), inverted = flat;
    flat(dim - 1, dim - 1) = 0;
    inverted(dim - 1, dim - 1) = -1;
    for (const Matrix<dim>& F : {flat, inverted, Matrix<dim>(0.3 * flat)}) {
      // The reflection has no unique rotation, which laws of stretches need.
      const double psi = energy_density<dim>(material, F);
      const Matrix<dim> P = first_piola_kirchhoff_stress<dim>(material, F);
      if (law.needs_positive_J) {
        EXPECT_EQ(psi, std::numeric_limits<double>::infinity());
        EXPECT_TRUE(std::isnan(P(0, 0)));
      } else {
        const bool has_rotation = law.kind != LawKind::stretches || F(dim - 1, dim - 1) == 0;
        EXPECT_EQ(std::isfinite(psi), has_rotation) << F;
        EXPECT_EQ(P.allFinite(), has_rotation) << F;
      }
    }
  });
}

}  // namespace
}  // namespace resilin
