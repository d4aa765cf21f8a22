// Derivatives by the rest places of bodies that touch: what barriers bear, and from how far, is held.

#include "derivative_checks.hpp"
#include "resilin/sensitivity/rest_shape.hpp"
#include "rubbing_scenes.hpp"

namespace resilin::testing {
namespace {

TEST(RestPositionsInContact, OnCollidersHaveRightDerivatives) {
  for (const std::string kind : {"half_space", "sphere", "mesh"})
    for (const int dimension : {2, 3})
      for (const bool is_dynamic : {false, true}) {
        SCOPED_TRACE(kind + ", " + std::to_string(dimension) + "D" +
                     (is_dynamic ? ", in motion" : ", at rest"));
        Description scene = block_on(*find_shape_kind(kind), dimension, is_dynamic);
        scene.colliders[0].shape.translate[0] = 0.031;  // no edge of a mesh is under a corner
        expect_friction(scene);
        expect_right_derivatives(scene, {"body.block.rest_positions"}, 1e-6, 2e-5);
      }
}

TEST(RestPositionsInContact, OfBodiesOnEachOtherHaveRightDerivatives) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + "D" + (is_dynamic ? ", in motion" : ", at rest"));
      const Description scene = rubbing_bars(dimension, is_dynamic, "half_space");
      expect_friction(scene);
      expect_right_derivatives(scene, {"body.lower.rest_positions", "body.upper.rest_positions"}, 1e-6, 2e-5);
    }
}

TEST(RestPositionsInContact, OfABodyThatMeetsItselfHaveRightDerivatives) {
  for (const int dimension : {2, 3})
    for (const double friction : {0.0, 0.3}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, friction " + std::to_string(friction));
      Description scene = two_arms(dimension, false);
      scene.contact.friction = friction;
      expect_right_derivatives(scene, {"body.arms.rest_positions"}, 1e-6, 2e-5);
    }
}

TEST(RestPositionsInContact, OfSkinsHaveRightDerivatives) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Description scene = rubbing_skins(dimension, false);
    expect_friction(scene);
    expect_right_derivatives(scene, {"body.lower.rest_positions", "body.upper.rest_positions"}, 1e-6, 2e-5);
  }
}

/// A bar on a ground, as drawn: it lies on it and sags beside it. Judged by a run of a scene that has nothing
/// of the search but a mesh.
TEST(RestShapeInContact, DeformsIntoWhatWasDrawn) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const int up = dimension - 1;
    Description scene = small_bar(dimension, false);
    scene.bodies[0].name = "bar";
    ColliderDescription ball;
    ball.name = "ball";
    ball.kind = "sphere";
    ball.shape.radius = 0.5;
    ball.shape.center = Vector3(0.62, dimension == 3 ? 0.12 : 0, 0) - 0.5047 * Vector3::Unit(up);
    if (dimension == 2) ball.shape.center = Vector3(0.62, -0.5047, 0);
    scene.colliders.push_back(ball);
    scene.bodies[0].material.constants["youngs_modulus"] = 5e6;
    const RestShape found = find_rest_shape(scene);
    EXPECT_LE(found.distance, 1e-8 * found.size);
    std::vector<Vector3>& vertices = scene.bodies[0].mesh.vertices;
    const std::vector<Vector3> target = vertices;
    double change = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      vertices[v].head(dimension) =
          found.bodies[0].rest.segment(static_cast<Eigen::Index>(v) * dimension, dimension);
      change = std::max(change, (vertices[v] - target[v]).norm());
    }
    EXPECT_GT(change, 1e-3);
    scene.newton.tolerance = 1e-11;
    const Simulation end = converged_end_of(scene);
    EXPECT_GT(end.world().colliders[0]->value(end.state().positions, end.world().at_load(1)), 0);
    for (std::size_t v = 0; v < target.size(); ++v)
      EXPECT_LT((end.world().place_of(static_cast<Index>(v), end.state().positions) - target[v]).norm(),
                1e-8 * found.size);
  }
}

}  // namespace
}  // namespace resilin::testing
