#include "benchmarks.hpp"

#include "collision.hpp"
#include "damping.hpp"
#include "fit_laws.hpp"
#include "gradients.hpp"
#include "heap.hpp"
#include "kernel_benchmark.hpp"
#include "latency.hpp"
#include "live.hpp"
#include "skin.hpp"
#include "solver_benchmark.hpp"

namespace resilin::bench {
namespace {

/// Every linear solver on the matrix of a bar: seconds of factorisation and solve, by solver.
std::vector<Measurement> bench_solvers(const BenchOptions& options) {
  SolverBenchmarkOptions benchmark;
  if (options.n > 0) benchmark.bar.cells_per_height = options.n;
  if (options.dynamic) benchmark.bar.time_step = 1.0 / 60;
  std::vector<Measurement> measurements;
  for (const SolverTiming& timing : benchmark_solvers(benchmark)) {
    if (measurements.empty()) measurements.emplace_back("unknowns", timing.num_unknowns);
    measurements.emplace_back(timing.solver + "_analyze_seconds", timing.analyze);
    measurements.emplace_back(timing.solver + "_factorize_seconds", timing.factorize);
    measurements.emplace_back(timing.solver + "_solve_seconds", timing.solve);
    measurements.emplace_back(timing.solver + "_iterations", timing.iterations);
    measurements.emplace_back(timing.solver + "_true_residual", timing.true_residual);
  }
  return measurements;
}

/// Nanoseconds of thread time for each tetrahedron, on one thread.
std::vector<Measurement> bench_kernels(const BenchOptions& options) {
  KernelBenchmarkOptions benchmark;
  benchmark.element = options.element;
  benchmark.n = options.n > 0 ? options.n : options.element == "P1" ? 26 : 13;
  std::vector<Measurement> measurements;
  for (const KernelTiming& timing : benchmark_kernels(benchmark)) {
    measurements.emplace_back(timing.kernel + ", median ns", timing.median_ns);
    measurements.emplace_back(timing.kernel + ", least ns", timing.min_ns);
  }
  return measurements;
}

std::vector<Measurement> bench_bar(const BenchOptions& options) {
  return measure_bar(options.n > 0 ? options.n : 9, options.dynamic, options.element);
}

std::vector<Measurement> bench_cube(const BenchOptions& options) {
  return measure_cube(options.n > 0 ? options.n : 10);
}

std::vector<Measurement> bench_damping(const BenchOptions& options) {
  return measure_damping(options.n > 0 ? options.n : 10, options.element);
}

std::vector<Measurement> bench_collision(const BenchOptions& options) {
  return measure_collision(options.n > 0 ? options.n : 41);
}

std::vector<Measurement> bench_contact(const BenchOptions& options) {
  return measure_contact(options.n > 0 ? options.n : 10);
}

std::vector<Measurement> bench_seed001(const BenchOptions&) { return measure_seed001(); }

std::vector<Measurement> bench_view(const BenchOptions&) { return measure_view(); }

std::vector<Measurement> bench_fit(const BenchOptions&) { return measure_fits(); }

std::vector<Measurement> bench_gradients(const BenchOptions& options) {
  return measure_gradients(options.n, options.dynamic);
}

std::vector<Measurement> bench_heap(const BenchOptions&) { return measure_heap(); }

std::vector<Measurement> bench_latency(const BenchOptions&) { return measure_latency(); }

/// Milliseconds of a frame, by body.
std::vector<Measurement> bench_skin(const BenchOptions& options) {
  std::vector<Measurement> measurements;
  for (const SkinTiming& timing : measure_skins(options.n > 0 ? options.n : 10)) {
    measurements.emplace_back(timing.name + ", cells", timing.cells);
    measurements.emplace_back(timing.name + ", vertices of the skin", timing.vertices);
    measurements.emplace_back(timing.name + ", outside the cells, %", timing.outside_percent);
    measurements.emplace_back(timing.name + ", build ms", timing.build_ms);
    measurements.emplace_back(timing.name + ", apply ms", timing.apply_ms);
    measurements.emplace_back(timing.name + ", apply smooth ms", timing.smooth_apply_ms);
    measurements.emplace_back(timing.name + ", normals ms", timing.normals_ms);
    measurements.emplace_back(timing.name + ", von Mises ms", timing.field_ms);
    measurements.emplace_back(timing.name + ", encode ms", timing.encode_ms);
  }
  return measurements;
}

}  // namespace

const std::vector<Benchmark>& benchmarks() {
  static const std::vector<Benchmark> table = {
      {"solvers", "Every linear solver on the matrix of a bar: --n cells across, --dynamic with mass",
       bench_solvers},
      {"kernels", "Energy, forces and Hessians of 6 n^3 tetrahedra, assembled too: ns for each",
       bench_kernels},
      {"bar", "A clamped bar to its full load, --n cells across; --dynamic: 50 steps of falling", bench_bar},
      {"cube", "A cube with one held face falls for a second in 60 steps, --n cells along an edge",
       bench_cube},
      {"damping",
       "What material damping costs: that cube with and without it, --n cells along an edge, --element",
       bench_damping},
      {"collision", "Two surfaces of 12 n^2 triangles near each other: search, times of collision, barrier",
       bench_collision},
      {"contact",
       "A cube falls on the ground, and two on each other in line and not, --n cells along an edge",
       bench_contact},
      {"seed001", "627 tetrahedra dragged and let go, every step converged; needs RESILIN_SHARED",
       bench_seed001},
      {"view", "Dragging in real time: time of a step, and its distance to the solved step", bench_view},
      {"fit", "Six laws fitted to three tests of a rubber, with intervals and stability", bench_fit},
      {"gradients",
       "Going back for a gradient beside the run: a bar at rest, --n cells across; --dynamic: a cube and a "
       "bar",
       bench_gradients},
      {"heap", "Three soft creatures fall into a heap on the page: time of a step, and its parts",
       bench_heap},
      {"latency", "From moving the hand in the browser to the frame that shows it, through the page server",
       bench_latency},
      {"skin",
       "A fine skin in each frame: embedding, normals, colours, the page's bytes; --n cells along an edge",
       bench_skin},
  };
  return table;
}

}  // namespace resilin::bench
