#include "resilin/linear/block_kernels.hpp"

namespace resilin::detail {

extern const BlockKernels block_kernels_baseline;
#ifdef RESILIN_X86_KERNELS
extern const BlockKernels block_kernels_avx2;
extern const BlockKernels block_kernels_avx512;
#endif

const BlockKernels& block_kernels() {
#ifdef RESILIN_X86_KERNELS
  static const BlockKernels& best = []() -> const BlockKernels& {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
      return block_kernels_avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return block_kernels_avx2;
    return block_kernels_baseline;
  }();
  return best;
#else
  return block_kernels_baseline;
#endif
}

}  // namespace resilin::detail
