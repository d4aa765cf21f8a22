#include "damping.hpp"

#include "clock.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin::bench {
namespace {

constexpr double stiffness_damping = 3e-3;  ///< [s]; the cube swings with about 33 rad/s

/// A scene and what its steps have taken.
struct Course {
  Simulation simulation;
  double cpu = 0;  ///< [s]
  int steps = 0, newton = 0, linear = 0;

  void step() {
    const double start = cpu_seconds();
    const StepReport report = simulation.step();
    cpu += cpu_seconds() - start;
    ++steps;
    newton += report.newton.iterations;
    linear += report.newton.linear_iterations;
  }
  void add_to(std::vector<Measurement>& measurements, const std::string& name) const {
    measurements.emplace_back(name + "_cpu_milliseconds_per_step", 1e3 * cpu / steps);
    measurements.emplace_back(name + "_newton_iterations", newton);
    measurements.emplace_back(name + "_linear_iterations", linear);
  }
};

}  // namespace

std::vector<Measurement> measure_damping(int n, const std::string& element) {
  Description scene = cube(n);
  scene.bodies[0].element = element;
  Course plain{Simulation(scene)};
  scene.bodies[0].damping.stiffness = stiffness_damping;
  Course damped{Simulation(scene)};
  while (!plain.simulation.is_finished()) {
    plain.step();
    damped.step();
  }
  std::vector<Measurement> measurements = {{"unknowns", plain.simulation.world().num_free_unknowns()}};
  plain.add_to(measurements, "undamped");
  damped.add_to(measurements, "damped");
  measurements.emplace_back("ratio", damped.cpu / plain.cpu);
  measurements.emplace_back("dissipated_joules", damped.simulation.frame().dissipated_energy);
  return measurements;
}

}  // namespace resilin::bench
