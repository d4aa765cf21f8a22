#include "resilin/linear/block_kernels.hpp"

#include "resilin/linear/kernel_dispatch.hpp"
#include "resilin/linear/multigrid_kernels.hpp"

namespace resilin::detail {

extern const BlockKernels block_kernels_baseline;
extern const MultigridKernels multigrid_kernels_baseline;

#if defined(RESILIN_X86_KERNELS)
extern const BlockKernels block_kernels_avx2;
extern const BlockKernels block_kernels_avx512;
extern const MultigridKernels multigrid_kernels_avx2;
extern const MultigridKernels multigrid_kernels_avx512;
#else
static const BlockKernels& block_kernels_avx2 = block_kernels_baseline;
static const BlockKernels& block_kernels_avx512 = block_kernels_baseline;
static const MultigridKernels& multigrid_kernels_avx2 = multigrid_kernels_baseline;
static const MultigridKernels& multigrid_kernels_avx512 = multigrid_kernels_baseline;
#endif

const BlockKernels& block_kernels() {
  static const BlockKernels& best =
      choose_kernels(block_kernels_baseline, block_kernels_avx2, block_kernels_avx512);
  return best;
}

const MultigridKernels& multigrid_kernels() {
  static const MultigridKernels& best =
      choose_kernels(multigrid_kernels_baseline, multigrid_kernels_avx2, multigrid_kernels_avx512);
  return best;
}

}  // namespace resilin::detail
