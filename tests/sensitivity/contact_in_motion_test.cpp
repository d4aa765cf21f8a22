// Derivatives of bodies that touch in motion, by every scheme of the catalogue: their impulses act at the
// ends of stages, and differences of motions and accelerations are without them.

#include "derivative_checks.hpp"
#include "every_integrator.hpp"
#include "rubbing_scenes.hpp"

namespace resilin::testing {
namespace {

struct ContactByEveryIntegrator : WithEveryIntegrator {
  /// Steps of the scheme that add no energy, with damping.
  Description by_integrator(Description scene) const {
    scene.integrator = integrator;
    scene.time_step = 0.002;
    scene.end_time = 0.012;
    for (BodyDescription& body : scene.bodies) body.damping = {.mass = 1, .stiffness = 0.01};
    return scene;
  }
};

/// Led along the ground, reactions of its support among the results.
TEST_P(ContactByEveryIntegrator, OfABlockThatIsPressedIsDifferentiated) {
  for (const int dimension : {2, 3})
    for (const double friction : {0.0, 0.4}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, friction " + std::to_string(friction));
      Description scene = by_integrator(block_on(*find_shape_kind("half_space"), dimension, true));
      Vector3& velocity = scene.bodies[0].velocity;
      velocity[0] = 2;
      velocity[dimension - 1] = -0.15;
      scene.fixes[0].velocity = velocity;
      scene.colliders[0].friction = friction;
      scene.colliders[0].shape.point[dimension - 1] -= 0.0013;  // from beyond the reach of its barrier
      scene.bodies[0].mass = dimension == 2 ? MassKind::consistent : MassKind::lumped;
      std::vector<std::string> names = {"body.block.material.youngs_modulus", "fix.press.velocity",
                                        "collider.under.displacement", "body.block.density",
                                        "body.block.initial_positions"};
      if (friction > 0) {
        expect_friction(scene);
        names.emplace_back("collider.under.friction");
      }
      expect_right_derivatives(scene, names, 1e-6, 1e-4);
    }
}

/// Thrown at the ground, which it leaves again.
TEST_P(ContactByEveryIntegrator, OfABlockThatBouncesIsDifferentiated) {
  for (const double friction : {0.0, 0.3}) {
    SCOPED_TRACE(friction);
    Description scene = by_integrator(thrown_block(2, {1, -2, 0}, 0.004, 0.05));
    scene.end_time = 0.03;
    scene.colliders[0].friction = friction;
    std::vector<std::string> names = {"body.block.density", "body.block.initial_velocities",
                                      "body.block.material.poissons_ratio", "simulation.gravity"};
    if (friction > 0) names.emplace_back("collider.ground.friction");
    expect_right_derivatives(scene, names, 1e-6, 2e-5);
  }
}

/// Bodies on each other and on facets; a load begins while they touch, where accelerations begin anew.
TEST_P(ContactByEveryIntegrator, OfTwoBodiesIsDifferentiated) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    Description scene = by_integrator(rubbing_bars(dimension, true, "mesh"));
    scene.colliders[0].shape.translate = {0.031, dimension == 3 ? 0.017 : 0,
                                          0};  // no edge of it is under a corner of a bar
    LoadDescription push;
    push.name = "push";
    push.kind = "body_force";
    push.body = "upper";
    push.value = {300, 0, 0};
    push.from = 0.006;
    scene.loads.push_back(push);
    expect_friction(scene);
    expect_right_derivatives(scene,
                             {"contact.friction", "collider.floor.translate", "load.push.value",
                              "body.lower.material.youngs_modulus", "body.upper.initial_velocities"},
                             1e-6, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, ContactByEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

}  // namespace
}  // namespace resilin::testing
