#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "clock.hpp"
#include "resilin/core/error.hpp"
#include "resilin/simulation/simulation.hpp"
#include "scenes.hpp"

namespace resilin::bench {
namespace {

struct Run {
  double cpu = 0, wall = 0;      ///< processor and wall time of all steps [s]
  std::vector<double> step_cpu;  ///< processor time of each step [s]
  int newton = 0, linear_solves = 0, linear = 0, projected = 0;
  int not_converged = 0;
  double worst_residual = 0;  ///< relative
};

Run run(Simulation& simulation) {
  Run run;
  while (!simulation.is_finished()) {
    const double cpu = cpu_seconds();
    const double wall = wall_seconds();
    const StepReport report = simulation.step();
    run.step_cpu.push_back(cpu_seconds() - cpu);
    run.cpu += run.step_cpu.back();
    run.wall += wall_seconds() - wall;
    run.newton += report.newton.iterations;
    run.linear_solves += report.newton.linear_solves;
    run.linear += report.newton.linear_iterations;
    run.projected += report.newton.projected_solves;
    run.worst_residual = std::max(run.worst_residual, simulation.frame().residual);
    if (report.status != StepReport::Status::converged) {
      ++run.not_converged;
      if (!simulation.world().is_dynamic) break;
    }
  }
  return run;
}

/// Peak memory of the process [bytes]: every benchmark is a process of its own.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr double kilobyte = 1024;  // unit of "kB" in the kernel
  return kilobyte * static_cast<double>(usage.ru_maxrss);
}

std::vector<Measurement> summary(const Simulation& simulation, const Run& run, double setup) {
  std::vector<double> sorted = run.step_cpu;
  std::sort(sorted.begin(), sorted.end());
  const auto steps = static_cast<double>(sorted.size());
  return {{"unknowns", simulation.world().num_free_unknowns()},
          {"setup_seconds", setup},
          {"steps", steps},
          {"cpu_seconds", run.cpu},
          {"wall_seconds", run.wall},
          {"mean_cpu_milliseconds_per_step", 1e3 * run.cpu / steps},
          {"median_cpu_milliseconds_per_step", 1e3 * sorted[sorted.size() / 2]},
          {"largest_cpu_milliseconds_per_step", 1e3 * sorted.back()},
          {"assembly_seconds", simulation.timing().assembly},
          {"solve_seconds", simulation.timing().solve},
          {"newton_iterations", run.newton},
          {"linear_solves", run.linear_solves},
          {"linear_iterations", run.linear},
          {"projected_solves", run.projected},
          {"peak_bytes_per_unknown", peak_memory() / simulation.world().num_free_unknowns()},
          {"steps_not_converged", run.not_converged},
          {"worst_relative_residual", run.worst_residual}};
}

}  // namespace

std::vector<Measurement> measure_bar(int n, bool is_dynamic, const std::string& element) {
  const double start = cpu_seconds();
  Simulation simulation(bar(n, is_dynamic, element));
  const double setup = cpu_seconds() - start;
  const Run result = run(simulation);
  std::vector<Measurement> measurements = summary(simulation, result, setup);
  const Vector3& tip = simulation.frame().probes[0].displacement;
  measurements.emplace_back("tip_x", tip.x());
  measurements.emplace_back("tip_y", tip.y());
  measurements.emplace_back("tip_z", tip.z());
  return measurements;
}

std::vector<Measurement> measure_cube(int n) {
  const double start = cpu_seconds();
  Simulation simulation(cube(n));
  const double setup = cpu_seconds() - start;
  const Run result = run(simulation);
  std::vector<Measurement> measurements = summary(simulation, result, setup);
  // Sags after one second: of the mean of all vertices, and of the lowest vertex below the lowest rest
  // corner.
  const VectorX& x = simulation.state().positions;
  double mean = 0;
  double lowest = 0;
  for (Index i = 0; i < simulation.world().num_nodes(); ++i) {
    mean += simulation.world().rest_positions[3 * i + 2] - x[3 * i + 2];
    lowest = std::min(lowest, x[3 * i + 2]);
  }
  measurements.emplace_back("mean_sag", mean / simulation.world().num_nodes());
  measurements.emplace_back("lowest_sag", -lowest);
  return measurements;
}

namespace {

void add_contact(const std::string& name, const Description& scene, std::vector<Measurement>& measurements) {
  Simulation simulation(scene);
  const Run result = run(simulation);
  const auto steps = static_cast<double>(result.step_cpu.size());
  const auto add = [&](const std::string& what, double value) {
    measurements.emplace_back(name + ", " + what, value);
  };
  add("mean ms per step", 1e3 * result.cpu / steps);
  add("largest ms per step", 1e3 * *std::ranges::max_element(result.step_cpu));
  add("Newton iterations per step", result.newton / steps);
  add("linear solves per step", result.linear_solves / steps);
  add("projected solves per step", result.projected / steps);
  add("linear iterations per step", result.linear / steps);
  add("assembly %", 100 * simulation.timing().assembly / result.wall);
  add("solving %", 100 * simulation.timing().solve / result.wall);
  if (const SurfaceContact* contact = simulation.world().contact.get()) {
    add("search %", 100 * contact->timing().search / result.wall);
    add("detection %", 100 * contact->timing().detection / result.wall);
    add("barrier %", 100 * contact->timing().barrier / result.wall);
  }
  add("steps not converged", result.not_converged);
  double height = 0;
  const Body& top = simulation.world().bodies.back();
  for (Index node = top.first_node; node < top.first_node + top.num_nodes; ++node)
    height += simulation.state().positions[3 * node + 2] / top.num_nodes;
  add("height of the top body at the end", height);
}

}  // namespace

std::vector<Measurement> measure_contact(int n) {
  std::vector<Measurement> measurements;
  for (const double friction : {0.0, 0.3}) {
    const std::string suffix = friction > 0 ? " with friction" : "";
    add_contact("dropped cube" + suffix, with_friction(friction, dropped_cube(n)), measurements);
    add_contact("two cubes" + suffix, with_friction(friction, two_cubes(n, false)), measurements);
    add_contact("two cubes in line" + suffix, with_friction(friction, two_cubes(n, true)), measurements);
  }
  return measurements;
}

std::filesystem::path shared_mesh(const std::string& name) {
  const char* folder = std::getenv("RESILIN_SHARED");
  return std::filesystem::path(folder == nullptr ? "../shared" : folder) / "meshes" / name;
}

std::vector<Measurement> measure_seed001() {
  const std::filesystem::path mesh = shared_mesh("armadillo_coarse.node");
  if (!std::filesystem::exists(mesh)) {
    throw InputError(
        "bench seed001", "the mesh armadillo_coarse.node", "none at " + mesh.string(),
        "its licence does not let us ship it: set RESILIN_SHARED to the folder that holds meshes/");
  }
  const double start = cpu_seconds();
  Simulation simulation(seed001(mesh));
  const double setup = cpu_seconds() - start;
  const Run result = run(simulation);
  std::vector<Measurement> measurements = summary(simulation, result, setup);
  measurements.emplace_back("ear_displacement", simulation.frame().probes[0].displacement.norm());
  return measurements;
}

}  // namespace resilin::bench
