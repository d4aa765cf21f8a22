#include "resilin/linear/kernel_dispatch.hpp"

#include <initializer_list>

#include "resilin/linear/block_kernels.hpp"
#include "resilin/linear/multigrid_kernels.hpp"

namespace resilin::detail {

extern const BlockKernels block_kernels_baseline;
extern const MultigridKernels multigrid_kernels_baseline;
#ifdef RESILIN_X86_KERNELS
extern const BlockKernels block_kernels_avx2;
extern const BlockKernels block_kernels_avx512;
extern const MultigridKernels multigrid_kernels_avx2;
extern const MultigridKernels multigrid_kernels_avx512;
#endif

namespace {

bool runs_here(InstructionSet set) {
#ifdef RESILIN_X86_KERNELS
  __builtin_cpu_init();
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  switch (set) {
    case InstructionSet::baseline:
      return true;
    case InstructionSet::avx2:
      return has_avx2;
    case InstructionSet::avx512:
      return has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl");
  }
#endif
  return set == InstructionSet::baseline;
}

template <class Kernels>
const Kernels& best(const Kernels* (*kernels_for)(InstructionSet)) {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2})
    if (const Kernels* kernels = kernels_for(set)) return *kernels;
  return *kernels_for(InstructionSet::baseline);
}

}  // namespace

const BlockKernels* block_kernels_for(InstructionSet set) {
  if (!runs_here(set)) return nullptr;
#ifdef RESILIN_X86_KERNELS
  if (set == InstructionSet::avx512) return &block_kernels_avx512;
  if (set == InstructionSet::avx2) return &block_kernels_avx2;
#endif
  return &block_kernels_baseline;
}

const MultigridKernels* multigrid_kernels_for(InstructionSet set) {
  if (!runs_here(set)) return nullptr;
#ifdef RESILIN_X86_KERNELS
  if (set == InstructionSet::avx512) return &multigrid_kernels_avx512;
  if (set == InstructionSet::avx2) return &multigrid_kernels_avx2;
#endif
  return &multigrid_kernels_baseline;
}

const BlockKernels& block_kernels() {
  static const BlockKernels& chosen = best(block_kernels_for);
  return chosen;
}

const MultigridKernels& multigrid_kernels() {
  static const MultigridKernels& chosen = best(multigrid_kernels_for);
  return chosen;
}

}  // namespace resilin::detail
