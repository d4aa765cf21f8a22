#pragma once

#include <string>
#include <vector>

#include "resilin/core/cpu.hpp"

namespace resilin::bench {

/// Thread-CPU time of one kernel on one thread, in nanoseconds for each tetrahedron.
struct KernelTiming {
  std::string kernel;
  double min_ns;
  double median_ns;
};

struct KernelBenchmarkOptions {
  int n = 26;                       ///< cube of n^3 cells of 6 tetrahedra each
  std::string law = "neo_hookean";  ///< with nu = 0.45
  std::string element = "P1";       ///< P1, P2 or P2P0
  int repetitions = 21;
  InstructionSet instruction_set = preferred_instruction_set();
};

/// Times energy, forces, element Hessians without and with projection, and both assembled (the matrix set to
/// zero each time), on a cube whose vertices are moved by 0.08 of its mesh size at random, so that most
/// Hessians are indefinite. The whole path counts: displacements from positions, gathering, law, scattering.
std::vector<KernelTiming> benchmark_kernels(const KernelBenchmarkOptions& options = {});

}  // namespace resilin::bench
