#include "derivative_checks.hpp"
#include "resilin/core/error.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal_of_derivatives(const Description& scene, const std::vector<std::string>& wrt) {
  try {
    const auto run = Derivatives::run(scene, wrt);
    std::vector<FrameChange> slopes(static_cast<std::size_t>(run->num_frames()));
    slopes.back().positions = VectorX::Ones(run->world().rest_positions.size());
    run->transposed(slopes);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Parameters, ThatAreUnknownAreRefusedWithTheNearest) {
  EXPECT_THAT(refusal_of_derivatives(small_bar(3, false), {"body.body.material.young_modulus"}),
              HasSubstr("body.body.material.youngs_modulus"));
}

TEST(Parameters, StandWhereTheSceneHasThem) {
  const Description scene = small_bar(3, true);
  const World world{Description(scene)};
  for (const std::string& name : parameter_names(world)) {
    const Parameter parameter = find_parameter(world, name);
    Description copy = scene;
    parameter.set(parameter.value, copy);
    const World other{Description(copy)};
    EXPECT_LE((find_parameter(other, name).value - parameter.value).norm(),
              1e-15 * (1 + parameter.value.norm()))
        << name;
    EXPECT_LE((other.start_positions - world.start_positions).norm(), 1e-14) << name;
    EXPECT_EQ(other.start_velocities, world.start_velocities) << name;
  }
}

/// A column pressed beyond its load of buckling stays straight, if nothing pushes it aside.
TEST(StaticDerivatives, AreRefusedAtAnEquilibriumThatIsNotStable) {
  Description scene = small_bar(2, false);
  scene.gravity = {0, 0, 0};
  scene.bodies[0].mesh = make_rectangle({1, 0.1}, {20, 2}, {0, -0.05});
  FixDescription top;
  top.name = "top";
  top.where.kind = Where::Kind::plane;
  top.where.at = 1;
  top.displacement = {-0.1, 0, 0};
  scene.fixes.push_back(top);
  scene.probes.clear();
  scene.bodies[0].mesh = make_rectangle({1, 0.1}, {20, 2}, {0, -0.05}, TrianglePattern::alternating);
  EXPECT_THAT(refusal_of_derivatives(scene, {"fix.top.displacement"}),
              AllOf(HasSubstr("stable"), HasSubstr("unstable mode")));
}

/// The true error of the gradient lies within a factor of three of what is said.
TEST(StaticDerivatives, OfALooseEquilibriumComeWithAnEstimateOfTheirError) {
  Description scene = small_bar(3, false);
  scene.solver.kind = "cholesky";
  const std::string name = "body.body.material.youngs_modulus";
  std::vector<double> gradients;
  std::vector<std::string> warnings;
  for (const double asked : {1e-3, 1e-12}) {
    scene.newton.tolerance = asked;
    const auto run = Derivatives::run(scene, {name});
    std::vector<FrameChange> slopes(static_cast<std::size_t>(run->num_frames()));
    slopes.back().positions = VectorX::Ones(run->world().rest_positions.size());
    gradients.push_back(run->transposed(slopes)[0][0]);
    warnings.insert(warnings.end(), run->warnings().begin(), run->warnings().end());
  }
  ASSERT_EQ(warnings.size(), 1);
  const std::string text = warnings[0], before = "off by ";
  const double estimate = std::stod(text.substr(text.find(before) + before.size()));
  const double error = std::abs(gradients[0] / gradients[1] - 1);
  EXPECT_GT(estimate, error / 3) << text;
  EXPECT_LT(estimate, 3 * error) << text;
}

TEST(Derivatives, AreRefusedInWordsWhereThereAreNone) {
  Description scene = small_bar(3, true);
  scene.adaptive = AdaptiveSteps{};
  EXPECT_THAT(refusal_of_derivatives(scene, {"body.body.density"}), HasSubstr("adaptive time steps"));
  scene.adaptive.reset();
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = "half_space";
  floor.shape.point = {0, 0, -0.05};
  floor.shape.normal = {0, 0, 1};
  scene.colliders.push_back(floor);
  EXPECT_THAT(refusal_of_derivatives(scene, {"collider.floor.friction"}), HasSubstr("a small value"));
}

}  // namespace
}  // namespace resilin::testing
