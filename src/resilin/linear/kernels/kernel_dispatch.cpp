#include "resilin/core/kernel_dispatch.hpp"

#include "resilin/linear/kernels/block_kernels.hpp"
#include "resilin/linear/kernels/multigrid_kernels.hpp"

namespace resilin::detail {

const BlockKernels& block_kernels(InstructionSet set) {
  return *CompiledSets::kernels(set, []<InstructionSet s>() { return &compiled_block_kernels<s>(); });
}

const MultigridKernels& multigrid_kernels(InstructionSet set) {
  return *CompiledSets::kernels(set, []<InstructionSet s>() { return &compiled_multigrid_kernels<s>(); });
}

const BlockKernels& block_kernels() {
  static const BlockKernels& chosen = block_kernels(preferred_instruction_set());
  return chosen;
}

const MultigridKernels& multigrid_kernels() {
  static const MultigridKernels& chosen = multigrid_kernels(preferred_instruction_set());
  return chosen;
}

}  // namespace resilin::detail
