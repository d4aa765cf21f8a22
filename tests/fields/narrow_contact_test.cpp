// Contact between the nodes of a body, which no estimate of the discretisation error sees.

#include "resilin/fields/narrow_contact.hpp"

#include <gtest/gtest.h>

#include <string>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A block of 1 m on its base, into which a ball or a plate is pressed from above.
Description pressed_block(int dimension, int cells, const std::string& kind) {
  Description scene = small_bar(dimension, false);
  scene.gravity.setZero();
  scene.probes.clear();
  scene.bodies[0].mesh =
      dimension == 3 ? make_box({1, 1, 1}, {cells, cells, cells}) : make_rectangle({1, 1}, {cells, cells});
  scene.fixes[0].where.axis = 1;
  ColliderDescription collider;
  collider.name = collider.kind = kind;
  collider.activation_distance = 0.004;
  collider.displacement = {0, -0.034, 0};
  collider.shape.radius = 2;
  collider.shape.center = {0.5, 3.004, dimension == 3 ? 0.5 : 0};
  collider.shape.point = {0, 1.004, 0};
  collider.shape.normal = {0, -1, 0};
  scene.colliders = {collider};
  return scene;
}

TEST(NarrowContact, IsThatOfABallOnACell) {
  const auto is_told = [](int dimension, int cells, const std::string& kind) {
    const Simulation simulation = run_all(pressed_block(dimension, cells, kind));
    return !narrow_contact_texts(simulation.world(), simulation.state()).empty();
  };
  for (const int dimension : {2, 3}) {
    EXPECT_TRUE(is_told(dimension, 1, "sphere")) << dimension << "D";
    EXPECT_FALSE(is_told(dimension, 1, "half_space")) << dimension << "D";
    EXPECT_FALSE(is_told(dimension, 2, "half_space")) << dimension << "D";
  }
  EXPECT_FALSE(is_told(2, 24, "sphere"));
}

TEST(NarrowContact, IsNotToldWithoutContact) {
  const Simulation simulation = run_all(small_bar(2, false));
  EXPECT_TRUE(narrow_contact_texts(simulation.world(), simulation.state()).empty());
}

}  // namespace
}  // namespace resilin::testing
