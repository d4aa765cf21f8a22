#pragma once

namespace resilin {

/// Instruction sets for which kernels can be compiled, the slowest first. The names are those of the
/// namespaces of the kernels (core/simd.hpp) and of cmake/ResilinKernels.cmake.
enum class InstructionSet {
  baseline,  ///< whatever the compiler targets without flags: 2 lanes of doubles
  avx2,      ///< AVX2 and FMA: 4 lanes
  avx512,    ///< AVX-512 F, CD, DQ, VL, BW: 8 lanes
};

/// Whether this processor runs them. The one test of the processor: the build's choice of `native` asks it
/// too.
inline bool processor_runs(InstructionSet set) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (set == InstructionSet::avx2) return has_avx2;
  if (set == InstructionSet::avx512)
    return has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512bw");
#endif
  return set == InstructionSet::baseline;
}

}  // namespace resilin
