// Whole runs end in the same bits for 1, 2, 3, 4 and 8 threads: at rest and in motion, with every element and
// every solver, in contact with friction. The large ones are cut into chunks and halves in all their loops.

#include <gtest/gtest.h>

#include <string>

#include "every_element.hpp"
#include "resilin/linear/catalog.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// 4,641 nodes: nineteen chunks of cells, a sweep in several chunks of two colours, and incomplete Cholesky
/// in two halves.
Description large_bar(bool is_dynamic) {
  Description scene = small_bar(3, is_dynamic);
  scene.bodies[0].mesh = make_box({1, 0.25, 0.25}, {40, 10, 10});
  scene.gravity *= 0.1;
  scene.end_time = 2 * scene.time_step;
  return scene;
}

TEST(AnyNumberOfThreads, GivesTheSameBitsAtRestAndInMotion) {
  for (const bool is_dynamic : {false, true})
    for (const std::string solver : {"cg_amg", "cg_ic0", "multifrontal"}) {
      SCOPED_TRACE(solver + (is_dynamic ? " in motion" : " at rest"));
      Description scene = large_bar(is_dynamic);
      scene.solver.kind = solver;
      expect_same_bits_for_any_number_of_threads(scene);
    }
}

TEST(AnyNumberOfThreads, GivesTheSameBitsWithEverySolver) {
  for (const int dimension : {2, 3})
    for (const std::string& solver : linear_solver_names()) {
      SCOPED_TRACE(solver + " in " + std::to_string(dimension) + "D");
      Description scene = small_bar(dimension, false);
      scene.solver.kind = solver;
      expect_same_bits_for_any_number_of_threads(scene);
    }
}

struct EveryElementOnThreads : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementOnThreads, ::testing::ValuesIn(elements()), name_of_element);

TEST_P(EveryElementOnThreads, GivesTheSameBitsAtRestAndInMotion) {
  const bool is_of_simplices = !element.name.starts_with("Q");
  for (const bool is_dynamic : {false, true}) {
    SCOPED_TRACE(is_dynamic ? "in motion" : "at rest");
    Description scene = small_bar(element.dim, is_dynamic);
    BodyDescription& body = scene.bodies[0];
    body.element = element.name;
    if (element.dim == 3) {
      body.mesh = is_of_simplices ? make_box({1, 0.25, 0.25}, {12, 4, 4})
                                  : make_hexahedron_box({1, 0.25, 0.25}, {12, 4, 4});
    } else {
      body.mesh = is_of_simplices ? make_rectangle({1, 0.25}, {40, 12})
                                  : make_quadrilateral_rectangle({1, 0.25}, {40, 12});
    }
    scene.gravity *= 0.1;
    scene.end_time = 2 * scene.time_step;
    expect_same_bits_for_any_number_of_threads(scene);
  }
}

/// A block slides on another, which slides on the ground.
TEST(AnyNumberOfThreads, GivesTheSameBitsInContactWithFriction) {
  Description scene = small_bar(3, true);
  scene.fixes.clear();
  scene.time_step = 0.01;
  scene.end_time = 0.1;
  scene.contact.friction = 0.3;
  scene.bodies[0].mesh = make_box({0.4, 0.4, 0.2}, {10, 10, 5});
  scene.bodies[0].name = "lower";
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "upper";
  scene.bodies[1].translate = {0.05, 0.03, 0.205};
  scene.bodies[1].velocity = {1, 0.5, -0.5};
  scene.bodies[0].translate = {0, 0, 0.002};
  scene.probes[0].body = "upper";
  ColliderDescription ground;
  ground.name = "ground";
  ground.shape.normal = Vector3::UnitZ();
  ground.friction = 0.2;
  scene.colliders.push_back(ground);
  expect_same_bits_for_any_number_of_threads(scene);
}

}  // namespace
}  // namespace resilin::testing
