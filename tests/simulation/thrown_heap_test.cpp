// Boxes of very different softness dropped on each other, fast for their size: corners that hit corners.

#include <gtest/gtest.h>

#include <random>

#include "resilin/contact/crossing.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

struct Box {
  double width, height;
  std::array<int, 2> cells;
  double youngs_modulus, poissons_ratio, density;
  double degrees, x;
};

/// One above the other, 0.55 m and then each 0.95 m higher, over the ground.
Description dropped(const std::vector<Box>& boxes, double friction, double time_step) {
  Description scene;
  scene.dimension = 2;
  scene.is_dynamic = true;
  scene.time_step = time_step;
  scene.end_time = 1;
  scene.gravity = {0, -9.81, 0};
  scene.contact.friction = friction;
  for (const Box& box : boxes) {
    BodyDescription body;
    body.name = "box " + std::to_string(scene.bodies.size());
    body.element = "P1";
    body.mesh = make_rectangle({box.width, box.height}, box.cells, {-box.width / 2, -box.height / 2});
    body.rotate = Rotation{.degrees = box.degrees};
    body.translate = {box.x, 0.55 + 0.95 * static_cast<double>(scene.bodies.size()), 0};
    body.material.density = box.density;
    body.material.constants = {{"youngs_modulus", box.youngs_modulus},
                               {"poissons_ratio", box.poissons_ratio}};
    scene.bodies.push_back(body);
  }
  ColliderDescription ground;
  ground.name = "ground";
  ground.kind = "half_space";
  ground.shape.normal = {0, 1, 0};
  ground.friction = friction;
  scene.colliders.push_back(ground);
  return scene;
}

/// @return how many steps were taken in parts
int run_to_the_end(const Description& scene, int seed) {
  Simulation simulation(scene);
  const SurfaceContact& contact = *simulation.world().contact;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << seed << ": " << report.reason;
    EXPECT_FALSE(first_crossing(contact.surface().parts, contact.meetings(),
                                contact.surface().places(simulation.state().positions))
                     .has_value())
        << seed << ", t = " << simulation.state().time;
    if (report.status != StepReport::Status::converged) break;
    EXPECT_NEAR(simulation.state().time, simulation.state().step * scene.time_step, 1e-12);
  }
  return simulation.state().divided_steps;
}

TEST(AThrownHeap, LandsWithEveryStepConverged) {
  const std::vector<Box> boxes = {
      {0.43507292432953915, 0.3906088984630921, {3, 2}, 865710, 0.4, 1000, 71.262, 0.1192},
      {0.49901134001822245, 0.2948810366082182, {4, 3}, 28625.1, 0.45, 1000, 9.765, 0.0081},
      {0.26016513111899536, 0.37625111116250554, {7, 3}, 103189, 0.45, 300, 34.690, 0.0262},
      {0.37671054473434074, 0.2897914683576633, {3, 3}, 340782, 0.45, 300, 31.992, -0.1512}};
  int divided = 0;
  for (int seed = 0; seed < 8; ++seed) {
    std::mt19937 generator(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Box> heap = boxes;
    if (seed > 0) {
      for (Box& box : heap) {
        box.degrees = 90 * uniform(generator);
        box.youngs_modulus = std::pow(10, 4 + 2 * uniform(generator));
      }
    }
    divided += run_to_the_end(dropped(heap, 0.8, seed % 2 == 0 ? 1.0 / 60 : 0.02), seed);
  }
  EXPECT_GT(divided, 0) << "too calm to show steps that are taken in parts";
}

}  // namespace
}  // namespace resilin::testing
