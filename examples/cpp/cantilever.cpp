// A soft beam held at one end sags under its weight; prints where its tip comes to rest.
#include <iostream>

#include "resilin/mesh/generators.hpp"
#include "resilin/simulation/simulation.hpp"

int main() {
  resilin::BodyDescription beam;
  beam.mesh = resilin::make_box({1, 0.2, 0.2}, {10, 2, 2});  // sizes [m], cells
  beam.material = {.law = "neo_hookean", .constants = {{"youngs_modulus", 5e5}, {"poissons_ratio", 0.3}}};

  resilin::FixDescription wall;
  wall.where = {.kind = resilin::Where::Kind::plane, .axis = 0, .at = 0};

  resilin::Description scene;
  scene.gravity = {0, 0, -9.81};
  scene.bodies = {beam};
  scene.fixes = {wall};
  scene.probes = {{.name = "tip", .at = {1, 0.1, 0.1}}};

  resilin::Simulation simulation(scene);
  while (!simulation.is_finished()) {
    const resilin::StepReport report = simulation.step();
    if (report.status != resilin::StepReport::Status::converged) {
      std::cerr << report.reason << '\n';
      return 2;
    }
  }
  std::cout << "tip: " << simulation.frame().probes.front().displacement.z() << " m\n";
}
