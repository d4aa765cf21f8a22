// Derivatives of what rubs: on colliders of each kind and on bodies, at rest along the path of loads and in
// motion, the coefficients of friction among the parameters.

#include "derivative_checks.hpp"
#include "rubbing_scenes.hpp"

namespace resilin::testing {
namespace {

const std::vector<std::string> of_bars = {"collider.floor.friction",
                                          "contact.friction",
                                          "body.lower.material.youngs_modulus",
                                          "body.upper.material.poissons_ratio",
                                          "body.upper.density",
                                          "simulation.gravity"};

TEST(FrictionDerivatives, AreRightAtRestAndInMotion) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const std::string floor : {"half_space", "mesh"}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, " + floor + (is_dynamic ? ", in motion" : ", at rest"));
        const Description scene = rubbing_bars(dimension, is_dynamic, floor);
        expect_friction(scene);
        std::vector<std::string> names = of_bars;
        names.emplace_back(is_dynamic ? "fix.press.velocity" : "fix.press.displacement");
        if (is_dynamic) names.emplace_back("body.upper.initial_velocities");
        expect_right_derivatives(scene, names);
      }
}

/// Their own numbers have a part in it: a derivative that leaves them out is not right by being small.
TEST(FrictionDerivatives, ByCoefficientsAreNotNothing) {
  for (const bool is_dynamic : {false, true}) {
    const Description scene = rubbing_bars(2, is_dynamic, "half_space");
    const auto run = Derivatives::run(scene, {"collider.floor.friction", "contact.friction"});
    for (const VectorX& slope : run->transposed(random_slopes(*run))) EXPECT_GT(std::abs(slope[0]), 1e-5);
  }
}

TEST(FrictionDerivatives, AreRightOnEveryKindOfCollider) {
  for (const ShapeKind& kind : shape_kinds())
    for (const int dimension : {2, 3})
      for (const bool is_dynamic : {false, true}) {
        if (dimension == 2 && !kind.is_flat_too) continue;
        SCOPED_TRACE(std::string(kind.name) + ", " + std::to_string(dimension) + "D" +
                     (is_dynamic ? ", in motion" : ", at rest"));
        const Description scene = block_on(kind, dimension, is_dynamic);
        expect_friction(scene);
        expect_right_derivatives(scene, {"collider.under.friction", "body.block.material.youngs_modulus",
                                         is_dynamic ? "fix.press.velocity" : "fix.press.displacement"});
      }
}

/// By where colliders are and how they move: first of all kinds with friction, then without.
struct AColliderPlace : ::testing::TestWithParam<std::size_t> {};

TEST_P(AColliderPlace, AndMotionHaveRightDerivatives) {
  const auto& kinds = shape_kinds();
  const ShapeKind& kind = kinds[GetParam() % kinds.size()];
  const double friction = GetParam() < kinds.size() ? 0.4 : 0.0;
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      if (dimension == 2 && !kind.is_flat_too) continue;
      SCOPED_TRACE(std::string(kind.name) + ", " + std::to_string(dimension) + "D, friction " +
                   std::to_string(friction) + (is_dynamic ? ", in motion" : ", at rest"));
      Description scene = block_on(kind, dimension, is_dynamic);
      ColliderDescription& under = scene.colliders[0];
      under.friction = friction;
      under.velocity = 0.02 * Vector3::UnitX();
      under.displacement = 5e-4 * Vector3::Unit(dimension - 1);
      if (kind.name != "sphere") {
        under.rotate.emplace();
        under.rotate->axis = dimension == 3 ? Vector3::UnitY() : Vector3::UnitZ();
        under.rotate->degrees = 0.05;
        under.rotate->degrees_per_second = 0.5;
      }
      std::vector<std::string> names = {"collider.under.velocity", "collider.under.displacement"};
      const bool is_long = kind.name == "capsule" || kind.name == "cylinder";
      if (!is_long)
        names.push_back(std::string("collider.under.") + (kind.name == "half_space" ? "point"
                                                          : kind.name == "mesh"     ? "translate"
                                                                                    : "center"));
      expect_right_derivatives(scene, names, 1e-6, 2e-5);
    }
}
INSTANTIATE_TEST_SUITE_P(Kinds, AColliderPlace, ::testing::Range<std::size_t>(0, 2 * shape_kinds().size()));

/// A roller turns where it is, or comes along: only friction feels the one, and both feel the other.
TEST(FrictionDerivatives, AreRightOnCollidersThatTurnAndMove) {
  for (const ShapeKind& kind : shape_kinds())
    for (const int dimension : {2, 3}) {
      if (dimension == 2 && !kind.is_flat_too) continue;
      SCOPED_TRACE(std::string(kind.name) + ", " + std::to_string(dimension) + "D");
      Description scene = block_on(kind, dimension, true);
      ColliderDescription& under = scene.colliders[0];
      ColliderTurn turn;
      turn.axis = dimension == 3 ? Vector3::UnitY() : Vector3::UnitZ();
      turn.center = under.shape.center;
      turn.degrees_per_second = kind.name == "sphere" ? 60 : 1;
      under.rotate = turn;
      under.velocity = 0.05 * Vector3::UnitX();
      expect_friction(scene);
      expect_right_derivatives(scene,
                               {"collider.under.friction", "body.block.density", "fix.press.velocity"});
    }
}

TEST(FrictionDerivatives, OfABodyOnItselfAreRight) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + "D" + (is_dynamic ? ", in motion" : ", at rest"));
      Description scene = two_arms(dimension, is_dynamic);
      scene.contact.friction = 0.3;
      expect_friction(scene);
      expect_right_derivatives(scene,
                               {"contact.friction", "body.arms.material.youngs_modulus",
                                is_dynamic ? "fix.press.velocity" : "fix.press.displacement"},
                               1e-6, 1e-4);
    }
}

TEST(FrictionDerivatives, OfSkinsAreRight) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + "D" + (is_dynamic ? ", in motion" : ", at rest"));
      Description scene = rubbing_skins(dimension, is_dynamic);
      scene.end_time = 0.02;
      expect_friction(scene);
      expect_right_derivatives(scene,
                               {"contact.friction", "body.lower.material.youngs_modulus",
                                is_dynamic ? "fix.press.velocity" : "fix.press.displacement"},
                               1e-6, 4e-3);
    }
}

TEST(FrictionDerivatives, AreRightForEveryLaw) {
  for (const LawInfo* law : laws()) {
    SCOPED_TRACE(law->name);
    Description scene = rubbing_bars(2, false, "half_space");
    MaterialDescription& material = scene.bodies[0].material;
    material = material_of(*law);
    material.constants["youngs_modulus"] = 1e4;
    if (!material.constants.contains("poissons_ratio")) material.constants["poissons_ratio"] = 0.3;
    if (law->has_volume_energy) scene.bodies[0].element = "P2P0";
    std::vector<std::string> names = {"contact.friction"};
    for (const auto& [name, value] : material.constants)
      if (std::isnan(law->only_poissons_ratio) || name != "poissons_ratio")
        names.push_back("body.lower.material." + name);
    expect_right_derivatives(scene, names, 1e-6, 8e-4);
  }
}

const std::vector<std::string> of_block = {
    "collider.ground.friction", "body.block.material.youngs_modulus", "body.block.material.poissons_ratio",
    "body.block.density",       "body.block.initial_velocities",      "body.block.initial_positions",
    "simulation.gravity"};

TEST(FrictionDerivatives, OfABodyThatBouncesAreRight) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Vector3 velocity = Vector3::UnitX() - 2 * Vector3::Unit(dimension - 1);
    const Description scene = thrown_block(dimension, velocity, 0.01, 0.1);
    expect_friction(scene);
    const Simulation end = converged_end_of(scene);
    EXPECT_EQ(end.world().colliders[0]->value(end.state().positions, {}), 0);  // it has left the ground
    // Over a longer step contacts change between sticking and slipping, where slopes have kinks.
    expect_right_derivatives(scene, of_block, 1e-6, 2e-5);
  }
}

TEST(FrictionDerivatives, OfABodyThatSlidesAreRight) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Description scene = thrown_block(dimension, 0.4 * Vector3::UnitX(), 0.0004, 0.1);
    expect_friction(scene);
    expect_right_derivatives(scene, of_block);
  }
}

TEST(FrictionDerivatives, WithCheckpointsAreTheSameBits) {
  const Description scene = thrown_block(2, {1, -2, 0}, 0.01, 0.1);
  std::vector<std::vector<VectorX>> gradients;
  for (const int checkpoints : {0, 2}) {
    const auto run = Derivatives::run(scene, of_block, {.checkpoints = checkpoints, .goes_on = {}});
    gradients.push_back(run->transposed(random_slopes(*run)));
  }
  EXPECT_EQ(gradients[0], gradients[1]);
}

}  // namespace
}  // namespace resilin::testing
