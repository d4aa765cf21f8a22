#include <gtest/gtest.h>

#include <random>

#include "every_element.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/simulation.hpp"
#include "small_scenes.hpp"

namespace resilin {
namespace {

/// A bar that is drawn out, turned at its end, pulled and blown at, of one law.
Description worked_bar(const std::string& law, const ElementInfo& element) {
  Description scene = testing::small_bar(element.dim, false);
  if (element.shape == CellShape::hexahedron)
    scene.bodies[0].mesh = make_hexahedron_box({1, 0.25, 0.25}, {6, 2, 2});
  if (element.shape == CellShape::quadrilateral)
    scene.bodies[0].mesh = make_quadrilateral_rectangle({1, 0.25}, {6, 2});
  scene.bodies[0].element = element.name;
  scene.bodies[0].material.law = law;
  FixDescription end;
  end.name = "end";
  end.where.kind = Where::Kind::plane;
  end.where.at = 1;
  end.displacement = {0.05, 0.02, 0};
  scene.fixes.push_back(end);
  LoadDescription wind;
  wind.name = "wind";
  wind.kind = "traction";
  wind.value = {0, 300, 0};
  wind.where.kind = Where::Kind::plane;
  wind.where.axis = 1;
  scene.loads.push_back(wind);
  return scene;
}

WorkBalance balance_along(const Simulation& simulation, const World& energies, const VectorX& displacement) {
  const VectorX& x = simulation.state().positions;
  const Potential potential = Potential::at(simulation.world(), {.time = 0, .load = 1}, x);
  VectorX gradient;
  potential.gradient(x, gradient);
  World world = simulation.world();
  world.bodies[0].domains = energies.bodies[0].domains;
  const std::vector<VectorX> acting = potential.gradients_without(EnergyCategory::elastic, x);
  return measure_work(world, potential, x, gradient, acting, displacement)[0];
}

WorkBalance balance_at(const Simulation& simulation, const World& energies) {
  return balance_along(simulation, energies,
                       simulation.state().positions - simulation.world().rest_positions);
}

struct WorkOnEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, WorkOnEveryElement, ::testing::ValuesIn(elements()), name_of_element);

TEST_P(WorkOnEveryElement, IsTheChangeOfTheStrainEnergy) {
  for (const std::string law : {"stable_neo_hookean", "neo_hookean", "mooney_rivlin"}) {
    const Simulation simulation = testing::run_all(worked_bar(law, element));
    ASSERT_TRUE(simulation.is_finished()) << law;
    const WorkBalance right = balance_at(simulation, simulation.world());
    EXPECT_GT(right.scale, 0) << law;
    EXPECT_LT(right.gap(), 1e-6 * right.scale) << law;
  }
}

/// Stresses of a body that is one percent stiffer than its energy says.
TEST_P(WorkOnEveryElement, ShowsStressesThatAreNotThoseOfTheEnergy) {
  Description scene = worked_bar("stable_neo_hookean", element);
  const Simulation simulation = testing::run_all(scene);
  scene.bodies[0].material.constants["youngs_modulus"] *= 1.01;
  const WorkBalance wrong = balance_at(simulation, World(scene));
  EXPECT_GT(wrong.gap(), 5e-3 * wrong.scale);
}

/// In a body that has come to rest only the last digits of its positions still move.
TEST_P(WorkOnEveryElement, IsBalancedAlongDisplacementsOfAnySize) {
  const Simulation simulation = testing::run_all(worked_bar("stable_neo_hookean", element));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> component(-1, 1);
  for (int exponent = -2; exponent >= -17; --exponent) {
    VectorX displacement = simulation.state().positions;
    for (double& value : displacement) value = std::pow(10, exponent) * component(random);
    const WorkBalance balance = balance_along(simulation, simulation.world(), displacement);
    EXPECT_LT(balance.gap(), 1e-4 * balance.scale + balance.rounding) << exponent;
  }
}

}  // namespace
}  // namespace resilin
