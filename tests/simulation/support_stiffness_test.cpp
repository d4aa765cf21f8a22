// Tangent stiffnesses of supports: the slopes of reactions over prescribed displacements and turns.
#include "resilin/simulation/support_stiffness.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "every_element.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar that is stretched and sheared by its right end, far beyond small strain.
Description pulled_bar(int dimension, const Vector3& displacement) {
  Description scene = small_bar(dimension, false);
  scene.bodies[0].material.law = "neo_hookean";
  scene.newton.tolerance = 1e-12;
  FixDescription grip;
  grip.name = "grip";
  grip.place = "fix[1]";
  grip.where.kind = Where::Kind::plane;
  grip.where.at = 1;
  grip.displacement = displacement;
  grip.reports_stiffness = true;
  scene.fixes.push_back(grip);
  return scene;
}

Vector3 reaction_at(int dimension, const Vector3& displacement) {
  return converged_end_of(pulled_bar(dimension, displacement)).frame().reactions.at(1).second;
}

TEST(SupportStiffness, IsTheSlopeOfTheReaction) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Vector3 displacement(0.2, 0.1, dimension == 3 ? -0.05 : 0);
    Simulation simulation = converged_end_of(pulled_bar(dimension, displacement));
    const VectorX before = simulation.state().positions;
    const std::vector<SupportStiffness> found = support_stiffness(simulation);
    EXPECT_EQ(simulation.state().positions, before);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].name, "grip");
    const auto dim = static_cast<std::size_t>(dimension);
    ASSERT_EQ(found[0].by_displacement.size(), dim * dim);
    EXPECT_FALSE(found[0].by_rotation);
    constexpr double h = 1e-4;
    for (int column = 0; column < dimension; ++column) {
      const Vector3 change = h * Vector3::Unit(column);
      const Vector3 slope =
          (reaction_at(dimension, displacement + change) - reaction_at(dimension, displacement - change)) /
          (2 * h);
      for (int row = 0; row < dimension; ++row)
        EXPECT_NEAR(
            found[0].by_displacement[static_cast<std::size_t>(row) * dim + static_cast<std::size_t>(column)],
            slope[row], 1e-5 * slope.norm())
            << row << " " << column;
    }
  }
}

/// Both ends slide between parallel guides: the stiffness of a bar without lateral strain is E A / L.
TEST(SupportStiffness, IsThatOfABarAtSmallStrain) {
  Description scene = pulled_bar(3, Vector3(1e-6, 0, 0));
  scene.gravity.setZero();
  scene.bodies[0].material.constants["youngs_modulus"] = 2e5;
  scene.bodies[0].material.constants["poissons_ratio"] = 0;
  Simulation simulation = converged_end_of(scene);
  EXPECT_NEAR(support_stiffness(simulation).at(0).by_displacement[0], 2e5 * 0.25 * 0.25, 0.1);
}

/// The moment of a turn about the bar's axis, by the energies of three runs: M' = (E+ - 2 E + E-) / angle^2.
TEST(SupportStiffness, OfATurnIsTheCurvatureOfTheEnergy) {
  const auto twisted = [](double degrees) {
    Description scene = pulled_bar(3, Vector3::Zero());
    scene.gravity.setZero();
    scene.fixes[1].rotate =
        Rotation{.axis = Vector3::UnitX(), .center = {1, 0.125, 0.125}, .degrees = degrees};
    return scene;
  };
  const auto energy = [&](double degrees) {
    return converged_end_of(twisted(degrees)).frame().elastic_energy;
  };
  constexpr double h = 0.5, angle = h * std::numbers::pi / 180;
  Simulation simulation = converged_end_of(twisted(30));
  const std::optional<double> found = support_stiffness(simulation).at(0).by_rotation;
  ASSERT_TRUE(found);
  const double curvature = (energy(30 + h) - 2 * energy(30) + energy(30 - h)) / (angle * angle);
  EXPECT_NEAR(*found, curvature, 2e-3 * curvature);
}

TEST(SupportStiffness, IsNotThereInMotion) {
  Description scene = pulled_bar(2, Vector3::Zero());
  scene.is_dynamic = true;
  Simulation simulation(scene);
  EXPECT_TRUE(support_stiffness(simulation).empty());
}

}  // namespace
}  // namespace resilin::testing
