#pragma once

namespace resilin::detail {

/// The best set of kernels that this machine runs: each of `block_kernels`, `multigrid_kernels` comes in
/// three.
template <class Kernels>
const Kernels& choose_kernels(const Kernels& baseline, [[maybe_unused]] const Kernels& avx2,
                              [[maybe_unused]] const Kernels& avx512) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2;
#endif
  return baseline;
}

}  // namespace resilin::detail
