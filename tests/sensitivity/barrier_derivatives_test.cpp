// Derivatives by materials where barriers have the stiffness that follows them: nothing is said of it in the
// scene.

#include "derivative_checks.hpp"
#include "pressed_bars.hpp"
#include "resilin/sensitivity/barrier_links.hpp"
#include "rubbing_scenes.hpp"

namespace resilin::testing {
namespace {

const std::vector<std::string> constants_of_both = {
    "body.lower.material.youngs_modulus", "body.lower.material.poissons_ratio",
    "body.upper.material.youngs_modulus", "body.upper.material.poissons_ratio"};

TEST(BarrierDerivatives, AreRightAtRestAndInMotion) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const std::string floor : {"half_space", "mesh"}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, " + floor + (is_dynamic ? ", in motion" : ", at rest"));
        const Description scene = pressed_bars(dimension, is_dynamic, floor);
        expect_contact(scene);
        expect_right_derivatives(scene, constants_of_both);
      }
}

/// By every constant that a law can be given, of the softer body, on which the layers depend.
TEST(BarrierDerivatives, AreRightForEveryLaw) {
  for (const LawInfo* law : laws()) {
    SCOPED_TRACE(law->name);
    Description scene = pressed_bars(2, false);
    MaterialDescription& material = scene.bodies[0].material;
    material = material_of(*law);
    material.constants["youngs_modulus"] = 1e4;
    if (!material.constants.contains("poissons_ratio")) material.constants["poissons_ratio"] = 0.3;
    if (law->has_volume_energy) scene.bodies[0].element = "P2P0";
    std::vector<std::string> names;
    for (const auto& [name, value] : material.constants)
      if (std::isnan(law->only_poissons_ratio) || name != "poissons_ratio")
        names.push_back("body.lower.material." + name);
    expect_right_derivatives(scene, names);
  }
}

/// The layers follow the means over the cells.
TEST(BarrierDerivatives, ByFieldsAreRight) {
  Description scene = pressed_bars(2, false);
  const std::size_t num_cells = scene.bodies[0].mesh.find_solid(2)->nodes.size() / 3;
  MaterialDescription& material = scene.bodies[0].material;
  material.constants.erase("youngs_modulus");
  for (const double noise : random_numbers(static_cast<Eigen::Index>(num_cells), 5))
    material.cell_constants["youngs_modulus"].push_back(1e4 * (1 + 0.2 * noise));
  expect_right_derivatives(scene, constants_of_both);
}

TEST(BarrierDerivatives, OfABodyThatMeetsItselfAreRight) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Description scene = two_arms(dimension, false);
    expect_contact(scene);
    expect_right_derivatives(scene,
                             {"body.arms.material.youngs_modulus", "body.arms.material.poissons_ratio"});
  }
}

/// Where two bodies are alike, the layer between them has a kink: the derivative is the mean of the two.
TEST(BarrierDerivatives, OfBodiesThatAreAlikeAreTheMeanOfBothSides) {
  Description scene = pressed_bars(2, false);
  scene.bodies[1].material.constants["youngs_modulus"] = 1e4;
  const std::string name = "body.upper.material.youngs_modulus";
  std::vector<double> slopes;
  for (const double factor : {1.0, 1 - 1e-8, 1 + 1e-8}) {
    Description near = scene;
    near.bodies[1].material.constants["youngs_modulus"] *= factor;
    const auto run = Derivatives::run(near, {name});
    EXPECT_EQ(run->warnings().size(), factor == 1 ? 1 : 0);
    slopes.push_back(run->transposed(random_slopes(*run))[0][0]);
  }
  EXPECT_GT(std::abs(slopes[1] - slopes[2]), 1e-4 * std::abs(slopes[0]));
  EXPECT_NEAR(slopes[0], 0.5 * (slopes[1] + slopes[2]), 1e-6 * std::abs(slopes[0]));
}

/// Beside the worlds that are made of changed constants.
TEST(BarrierLinks, FollowWhatAWorldWouldHave) {
  for (const LawInfo* law : laws()) {
    Description scene = pressed_bars(3, false, "mesh");
    scene.colliders.push_back(scene.colliders[0]);
    scene.colliders[1].kind = "half_space";
    scene.bodies[0].material = material_of(*law);
    for (const ConstantText& constant : law->constants)  // inside of its range
      if (constant.is_free && constant.fallback == 0)
        scene.bodies[0].material.constants[std::string(constant.name)] = 0.1;
    const World world{Description(scene)};
    const BarrierLinks links(world);
    ASSERT_EQ(links.all().size(), 3);
    const std::vector<double> constants =
        resolve_constants(*law, scene.bodies[0].material.constants, "material");
    scene.bodies[0].material.constants.clear();
    for (std::size_t k = 0; k < constants.size(); ++k)
      scene.bodies[0].material.constants[std::string(law->constants[k].name)] = constants[k];
    const World by_formula{Description(scene)};
    for (const ConstantText& constant : law->constants) {
      const std::string name = "body.lower.material." + std::string(constant.name);
      SCOPED_TRACE(std::string(law->name) + ", " + name);
      const Parameter parameter = find_parameter(by_formula, name);
      WorldChange change(by_formula);
      parameter.ask(change);
      parameter.spread(VectorX::Ones(1), change);
      const double h = 1e-4 * (parameter.value[0] == 0 ? 1 : std::abs(parameter.value[0]));
      std::vector<std::vector<BarrierLinks::Barrier>> sides;
      for (const double way : {h, -h}) {
        Description changed = scene;
        parameter.set(parameter.value + VectorX::Constant(1, way), changed);
        sides.push_back(BarrierLinks(World{std::move(changed)}).all());
      }
      for (std::size_t b = 0; b < sides[0].size(); ++b) {
        const BarrierLinks::Barrier& barrier = links.all()[b];
        ASSERT_TRUE(links.moves(barrier, change));
        VectorX slopes = VectorX::Zero(barrier.stiffness.size());
        links.spread(barrier, change, slopes);
        const VectorX differences = (sides[0][b].stiffness - sides[1][b].stiffness) / (2 * h);
        EXPECT_LE((slopes - differences).norm(),
                  1e-6 * differences.norm() + 1e-9 * barrier.stiffness.norm() / h);
        const VectorX w = random_numbers(slopes.size(), 3);
        WorldChange gathered(by_formula);
        parameter.ask(gathered);
        links.gather(barrier, w, gathered);
        VectorX by_number = VectorX::Zero(1);
        parameter.gather(gathered, by_number);
        EXPECT_NEAR(by_number[0], w.dot(slopes), 1e-12 * w.norm() * slopes.norm());
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
