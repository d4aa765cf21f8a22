// Rest shapes of bodies that are drawn just above a floor, pressed on it or standing on it.

#include "derivative_checks.hpp"
#include "resilin/core/error.hpp"
#include "resilin/sensitivity/rest_shape.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

ColliderDescription floor_below(int dimension, double gap, const std::string& kind = "half_space") {
  const int up = dimension - 1;
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = kind;
  floor.shape.point = -gap * Vector3::Unit(up);
  floor.shape.normal = Vector3::Unit(up);
  floor.shape.size = {4, 4, 4};
  floor.shape.size[up] = 0.2;
  floor.shape.center = Vector3(0.503, dimension == 3 ? 0.107 : 0, 0);  // no edge is under a corner
  floor.shape.center[up] = -gap - 0.1;
  return floor;
}

/// A beam held at one end, its underside at the height 0.
Description beam_over_floor(int dimension, double thickness, double gap,
                            const std::string& kind = "half_space") {
  Description scene = small_bar(dimension, false);
  scene.probes.clear();
  scene.bodies[0].name = "beam";
  scene.bodies[0].mesh =
      dimension == 3 ? make_box({0.8, 0.2, thickness}, {6, 1, 1}) : make_rectangle({0.8, thickness}, {8, 1});
  scene.bodies[0].material.constants["youngs_modulus"] = 1e6;
  scene.colliders.push_back(floor_below(dimension, gap, kind));
  return scene;
}

/// A block that stands on a floor; one side is kept from sliding.
Description standing_block(int dimension, double gap, double modulus) {
  Description scene = beam_over_floor(dimension, 0.1, gap);
  scene.bodies[0].name = "block";
  scene.bodies[0].mesh =
      dimension == 3 ? make_box({0.2, 0.2, 0.1}, {3, 3, 2}) : make_rectangle({0.2, 0.1}, {4, 2});
  scene.bodies[0].material.constants["youngs_modulus"] = modulus;
  scene.fixes[0].components = {true, dimension == 3, false};
  return scene;
}

/// Error of the run of a scene that has nothing of the search but its meshes: the largest distance of a
/// vertex from its place as drawn, moved along one axis.
double end_beside(const RestShape& found, const Description& drawn, const Vector3& moved) {
  Description scene = found.scene;
  scene.newton.tolerance = 1e-11;
  const Simulation end = converged_end_of(scene);
  double largest = 0;
  for (std::size_t v = 0; v < drawn.bodies[0].mesh.vertices.size(); ++v) {
    const Vector3 at = end.world().place_of(static_cast<Index>(v), end.state().positions);
    largest = std::max(largest, (at - drawn.bodies[0].mesh.vertices[v] - moved).norm());
  }
  return largest;
}

double lowest(const RestShape& found, int dimension) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = dimension - 1; i < found.bodies[0].rest.size(); i += dimension)
    least = std::min(least, found.bodies[0].rest[i]);
  return least;
}

TEST(RestShapeAboveAFloor, IsThatWithoutAFloorWhichIsThenKeptOff) {
  for (const int dimension : {2, 3})
    for (const double thickness : {0.06, 0.1})
      for (const double gap : {1e-4, 1e-3, 3e-3}) {
        if (dimension == 3 && (thickness == 0.1) != (gap == 1e-3)) continue;  // half of them tell it
        SCOPED_TRACE(std::to_string(dimension) + "D, thickness " + std::to_string(thickness) + ", gap " +
                     std::to_string(gap));
        Description scene = beam_over_floor(dimension, thickness, gap, gap == 1e-3 ? "box" : "half_space");
        const RestShape found = find_rest_shape(scene);
        EXPECT_LT(end_beside(found, scene, Vector3::Zero()), 1e-8 * found.size);
        ASSERT_EQ(found.kept_off.size(), 1U);
        EXPECT_EQ(found.kept_off[0].first, "floor");
        EXPECT_LT(found.kept_off[0].second, gap);
        ASSERT_GE(found.warnings.size(), 1U);
        EXPECT_NE(found.warnings[0].find("times the weight"), std::string::npos) << found.warnings[0];
        scene.colliders.clear();
        const RestShape free = find_rest_shape(scene);
        EXPECT_LT((free.bodies[0].rest - found.bodies[0].rest).cwiseAbs().maxCoeff(), 1e-8 * found.size);
      }
}

TEST(RestShapeAboveAFloor, IsRefusedWithTheForceWhereTheSceneSaysHowFarTheFloorIsFelt) {
  Description scene = beam_over_floor(2, 0.1, 1e-3);
  scene.colliders[0].activation_distance = 4e-3;
  try {
    find_rest_shape(scene);
    FAIL() << "found";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("the collider \"floor\" presses with"), std::string::npos) << text;
    EXPECT_NE(text.find("with an activation_distance below 0.001 m"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST(RestShapeOnAFloor, LiesInsideOfItWhereABlockIsHeldPressed) {
  for (const int dimension : {2, 3})
    for (const double gap : {4e-4, 6e-4, 7e-4}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, gap " + std::to_string(gap));
      Description scene = standing_block(dimension, gap, 1e5);
      scene.fixes[0].components = {true, true, true};
      scene.fixes[0].where.axis = dimension - 1;
      scene.fixes[0].where.at = 0.1;
      scene.colliders[0].activation_distance = 1e-3;
      const RestShape found = find_rest_shape(scene);
      EXPECT_LE(found.iterations, 12);  // second order
      EXPECT_LT(end_beside(found, scene, Vector3::Zero()), 1e-8 * found.size);
      EXPECT_LT(lowest(found, dimension), -gap);
      ASSERT_EQ(found.warnings.size(), 1U);
      EXPECT_NE(found.warnings[0].find("inside of the collider \"floor\""), std::string::npos);
      EXPECT_FALSE(found.scene.bodies[0].initial_positions.empty());
    }
}

TEST(RestShapeOnAFloor, StandsWhereTheFloorBearsItsWeight) {
  for (const int dimension : {2, 3})
    for (const double gap : {1e-4, 5e-4, 9e-4})
      for (const double modulus : {2e4, 1e5}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, gap " + std::to_string(gap) + ", E " +
                     std::to_string(modulus));
        const Description scene = standing_block(dimension, gap, modulus);
        const RestShape found = find_rest_shape(scene);
        const int up = dimension - 1;
        Vector3 moved = Vector3::Zero();
        moved[up] = found.bodies[0].deformed[up] - scene.bodies[0].mesh.vertices[0][up];
        EXPECT_LT(std::abs(moved[up]), 2e-3);
        EXPECT_LT(end_beside(found, scene, moved), 1e-8 * found.size);
        const Simulation end = converged_end_of(found.scene);
        const Reaction reaction =
            *end.world().colliders[0]->reaction(end.state().positions, end.world().at_load(1));
        const double weight = 9.81 * end.world().bodies[0].mass;
        EXPECT_NEAR(reaction.force[up], weight, 1e-6 * weight);
      }
}

}  // namespace
}  // namespace resilin::testing
