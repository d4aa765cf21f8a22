#include "benchmarks.hpp"

#include "resilin/linear/solver_benchmark.hpp"

namespace resilin::cli {
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

}  // namespace

const std::vector<Benchmark>& benchmarks() {
  static const std::vector<Benchmark> table = {
      {"solvers", "Every linear solver on the matrix of a bar: --n cells across, --dynamic with mass",
       bench_solvers},
  };
  return table;
}

}  // namespace resilin::cli
