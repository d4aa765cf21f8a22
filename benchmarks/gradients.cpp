#include "gradients.hpp"

#include <algorithm>
#include <memory>

#include "clock.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/sensitivity/derivatives.hpp"

namespace resilin::bench {
namespace {

constexpr int num_repetitions = 3;

double median(std::vector<double> times) {
  std::ranges::sort(times);
  return times[times.size() / 2];
}

/// Young's modulus of each cell, named so that it can be differentiated by.
void name_cell_moduli(Description& scene) {
  BodyDescription& body = scene.bodies[0];
  const std::size_t num_cells = body.mesh.find_solid(scene.dimension)->nodes.size() / 4;
  body.material.cell_constants["youngs_modulus"].assign(num_cells,
                                                        body.material.constants.at("youngs_modulus"));
  body.material.constants.erase("youngs_modulus");
  for (LoadDescription& load : scene.loads) load.name = "load";
}

std::string of_body(const Description& scene, const std::string& key) {
  return "body." + scene.bodies[0].name + "." + key;
}

/// The height of the vertex that is farthest along the body.
std::vector<FrameChange> slopes_of_corner(const Derivatives& run) {
  const VectorX& rest = run.world().rest_positions;
  Eigen::Index corner = 0;
  for (Eigen::Index node = 0; node < rest.size() / 3; ++node)
    if (rest.segment<3>(3 * node).sum() > rest.segment<3>(3 * corner).sum()) corner = node;
  std::vector<FrameChange> slopes(static_cast<std::size_t>(run.num_frames()));
  slopes.back().positions = VectorX::Unit(rest.size(), 3 * corner + 2);
  return slopes;
}

/// A run without derivatives: seconds, and Newton iterations.
struct PlainRun {
  double seconds = 0;
  int newton = 0;
  Index unknowns = 0;
};

PlainRun run_plain(const Description& scene) {
  PlainRun plain;
  const double start = cpu_seconds();
  Simulation simulation(scene);
  while (!simulation.is_finished()) plain.newton += simulation.step().newton.iterations;
  plain.seconds = cpu_seconds() - start;
  plain.unknowns = simulation.world().num_free_unknowns();
  return plain;
}

/// Seconds of the first time back and of those after it.
struct BackwardTimes {
  double first = 0, again = 0;
};

BackwardTimes time_backward(Derivatives& run) {
  const std::vector<FrameChange> slopes = slopes_of_corner(run);
  BackwardTimes found;
  std::vector<double> times;
  for (int k = 0; k <= num_repetitions; ++k) {
    const double start = cpu_seconds();
    run.transposed(slopes);
    (k == 0 ? found.first : times.emplace_back()) = cpu_seconds() - start;
  }
  found.again = median(times);
  return found;
}

/// Runs and goes back, in turn with runs that keep nothing.
void add_gradient(const std::string& name, const Description& scene, const std::vector<std::string>& wrt,
                  std::vector<Measurement>& measurements) {
  PlainRun plain;
  std::vector<double> plain_times, kept_times, first_times, times;
  for (int k = 0; k < num_repetitions; ++k) {
    plain = run_plain(scene);
    plain_times.push_back(plain.seconds);
    const double start = cpu_seconds();
    const std::unique_ptr<Derivatives> run = Derivatives::run(scene, wrt);
    kept_times.push_back(cpu_seconds() - start);
    const BackwardTimes backward = time_backward(*run);
    first_times.push_back(backward.first);
    times.push_back(backward.again);
  }
  const double run = median(plain_times);
  const auto add = [&](const std::string& what, double value) {
    measurements.emplace_back(name + ", " + what, value);
  };
  add("unknowns", plain.unknowns);
  add("run ms", 1e3 * run);
  add("run that keeps its way, ms", 1e3 * median(kept_times));
  add("Newton iterations", plain.newton);
  add("backward ms", 1e3 * median(first_times));
  add("backward again ms", 1e3 * median(times));
  add("backward / run", median(first_times) / run);
  add("backward / Newton iteration", median(first_times) / run * plain.newton);
}

void add_statics(int n, std::vector<Measurement>& measurements) {
  for (const std::string solver : {"multifrontal", "cg_amg"}) {
    Description scene = bar(n, false, "P1");
    name_cell_moduli(scene);
    scene.solver.kind = solver;
    const std::string modulus = of_body(scene, "material.youngs_modulus");
    add_gradient(solver, scene, {modulus}, measurements);
    add_gradient(solver + ", five kinds", scene,
                 {modulus, of_body(scene, "rest_positions"), "load.load.value", of_body(scene, "density"),
                  of_body(scene, "material.poissons_ratio")},
                 measurements);
  }
}

/// Memory on the heap that each further step keeps, for each vertex.
double bytes_per_vertex_and_step(Description scene, const std::vector<std::string>& wrt) {
  double bytes[2] = {0, 0};
  int steps[2] = {0, 0};
  Index nodes = 1;
  for (int k = 0; k < 2; ++k) {
    const double before = heap_bytes();
    const std::unique_ptr<Derivatives> run = Derivatives::run(scene, wrt);
    bytes[k] = heap_bytes() - before;
    steps[k] = run->num_frames() - 1;
    nodes = run->world().num_nodes();
    scene.end_time *= 2;
  }
  return (bytes[1] - bytes[0]) / (nodes * (steps[1] - steps[0]));
}

void add_motion(const std::string& name, Description scene, std::vector<Measurement>& measurements) {
  name_cell_moduli(scene);
  const std::string modulus = of_body(scene, "material.youngs_modulus");
  for (const std::string solver : {"cg_ic0", "multifrontal"}) {
    scene.solver.kind = solver;
    add_gradient(name + ", " + solver, scene, {modulus}, measurements);
  }
  measurements.emplace_back(name + ", bytes for a vertex and step",
                            bytes_per_vertex_and_step(scene, {modulus}));
}

}  // namespace

std::vector<Measurement> measure_gradients(int n, bool is_dynamic) {
  std::vector<Measurement> measurements;
  if (is_dynamic) {
    add_motion("cube", cube(n > 0 ? n : 10), measurements);
    add_motion("bar", bar(9, true, "P1"), measurements);
  } else {
    add_statics(n > 0 ? n : 11, measurements);
  }
  return measurements;
}

}  // namespace resilin::bench
