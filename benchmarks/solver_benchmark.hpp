#pragma once

#include <string>
#include <vector>

#include "bar_problem.hpp"

namespace resilin {

struct SolverBenchmarkOptions {
  BarOptions bar;
  std::vector<std::string> solvers;  ///< empty: every solver of the catalogue
  double relative_tolerance = 1e-8;
  int repeats = 3;  ///< the least of so many times is reported
};

/// Times of one solver [s]: CPU time of the calling thread, so that other work on the machine does not count;
/// use one thread.
struct SolverTiming {
  std::string solver;
  Index num_unknowns = 0;
  double analyze = 0;    ///< first analysis, and what the first factorisation adds to it
  double factorize = 0;  ///< new values on the same pattern
  double solve = 0;
  int iterations = 0;
  double true_residual = 0;  ///< |b - A x| / |b| by a product of its own
  double memory_MiB = 0;     ///< taken by the solver: growth of the heap in use; 0 where it is not known
  std::string failure;       ///< empty, or what went wrong
};

std::vector<SolverTiming> benchmark_solvers(const SolverBenchmarkOptions& options);

}  // namespace resilin
