#include "solver_benchmark.hpp"

#include <time.h>

#include <algorithm>
#include <limits>

#include "resilin/core/memory.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double seconds_of(const Work& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

SolverTiming time_solver(const std::string& name, const BarProblem& bar,
                         const SolverBenchmarkOptions& options) {
  SolverTiming timing;
  timing.solver = name;
  timing.num_unknowns = bar.matrix.num_unknowns();
  const bool is_dynamic = options.bar.time_step > 0;
  const double heap_before = heap_bytes();
  const auto solver = make_linear_solver({.kind = name, .is_dynamic = is_dynamic, .max_iterations = 5000},
                                         timing.num_unknowns);
  LinearReport report;
  timing.analyze = seconds_of([&] {
    solver->analyze(bar.matrix, bar.node_positions);
    report = solver->factorize(bar.matrix);
  });
  timing.factorize = timing.solve = std::numeric_limits<double>::infinity();
  VectorX x, residual;
  for (int repeat = 0; repeat < options.repeats && report.status == LinearReport::Status::ok; ++repeat) {
    solver->begin_search();  // or the factors of the same matrix would be kept
    timing.factorize =
        std::min(timing.factorize, seconds_of([&] { report = solver->factorize(bar.matrix); }));
    x.setZero(timing.num_unknowns);
    const double solve = seconds_of(
        [&] { report = solver->solve(bar.matrix, bar.right_side, x, options.relative_tolerance); });
    timing.solve = std::min(timing.solve, solve);
  }
  timing.analyze = std::max(timing.analyze - timing.factorize, 0.0);
  timing.memory_MiB = (heap_bytes() - heap_before) / (1024.0 * 1024.0);
  timing.iterations = report.iterations;
  switch (report.status) {
    case LinearReport::Status::ok:
      break;
    case LinearReport::Status::indefinite:
      timing.failure = "found the matrix indefinite";
      break;
    case LinearReport::Status::not_converged:
      timing.failure = "did not converge";
      break;
    case LinearReport::Status::out_of_memory:
      timing.failure = "ran out of memory";
      break;
  }
  if (timing.failure.empty()) {
    multiply(bar.matrix, x, residual);
    timing.true_residual = (bar.right_side - residual).norm() / bar.right_side.norm();
  }
  return timing;
}

}  // namespace

std::vector<SolverTiming> benchmark_solvers(const SolverBenchmarkOptions& options) {
  const BarProblem bar = make_bar_problem(options.bar);
  const std::vector<std::string> names = options.solvers.empty() ? linear_solver_names() : options.solvers;
  std::vector<SolverTiming> timings;
  for (const std::string& name : names) timings.push_back(time_solver(name, bar, options));
  return timings;
}

}  // namespace resilin
