// Thin walls full of fibres under pressure: what heart valves, arteries and membranes are made of.

#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

struct Leaflet {
  std::string name;
  std::vector<std::string> held;  ///< sides
  double pressure = 0;            ///< from below [Pa]
  double fibre_modulus = 0;       ///< [Pa]
  double fibre_stiffening = 0;
};

/// A sheet of 20 x 20 x 0.5 mm with two families of fibres, with the elements and the solver of the default.
Description scene_of(const Leaflet& leaflet) {
  Description scene;
  BodyDescription body;
  body.name = "leaflet";
  body.mesh = make_box({0.02, 0.02, 0.0005}, {8, 8, 1});
  body.material.law = "holzapfel_gasser_ogden";
  body.material.constants = {{"shear_modulus", 2e4},
                             {"bulk_modulus", 1e6},
                             {"fibre_modulus", leaflet.fibre_modulus},
                             {"fibre_stiffening", leaflet.fibre_stiffening}};
  body.material.fibres = {{Vector3(0.8, 0.6, 0)}, {Vector3(0.8, -0.6, 0)}};
  scene.bodies.push_back(std::move(body));
  for (const std::string& side : leaflet.held) {
    FixDescription fix;
    fix.name = side;
    fix.where.kind = Where::Kind::group;
    fix.where.group = side;
    scene.fixes.push_back(fix);
  }
  LoadDescription load;
  load.kind = "pressure";
  load.where.kind = Where::Kind::group;
  load.where.group = "z_min";
  load.pressure = leaflet.pressure;
  scene.loads.push_back(load);
  return scene;
}

/// Newton's iterations from no load to the whole one, those of steps that failed included.
int iterations_to_the_full_load(const Leaflet& leaflet) {
  Simulation simulation(scene_of(leaflet));
  int iterations = 0;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
    iterations += report.newton.iterations;
  }
  return iterations;
}

const std::vector<std::string> all_round = {"x_min", "x_max", "y_min", "y_max"};
const std::vector<std::string> at_three_sides = {"x_min", "y_min", "y_max"};
const std::vector<std::string> at_two_sides = {"x_min", "x_max"};

/// Steps let pass into the steep exponential of the fibres took hundreds of iterations before: their forces
/// overflowed, and the load step was halved again and again.
TEST(Tissue, ReachesItsFullLoadInAFewDozenIterations) {
  const std::vector<Leaflet> leaflets = {{"all round", all_round, 5e3, 5e5, 20},
                                         {"all round, soft", all_round, 1e4, 5e4, 5},
                                         {"all round, stiff", all_round, 1e4, 1e6, 50},
                                         {"three sides", at_three_sides, 5e3, 5e5, 20},
                                         {"three sides, light", at_three_sides, 1e2, 1e5, 10},
                                         {"two sides", at_two_sides, 5e3, 5e5, 20},
                                         {"two sides, soft", at_two_sides, 1e3, 5e4, 5},
                                         {"one side, light", {"x_min"}, 1, 1e5, 10}};
  for (const Leaflet& leaflet : leaflets) {
    SCOPED_TRACE(leaflet.name);
    EXPECT_LE(iterations_to_the_full_load(leaflet), 120);
  }
}

}  // namespace
}  // namespace resilin::testing
