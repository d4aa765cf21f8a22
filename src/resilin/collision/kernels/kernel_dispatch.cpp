#include "resilin/core/kernel_dispatch.hpp"

#include "resilin/collision/kernels/box_kernels.hpp"
#include "resilin/collision/kernels/pair_kernels.hpp"

namespace resilin {

const PairKernels& pair_kernels(PairKind kind, InstructionSet set) {
  return *CompiledSets::kernels(set, [kind]<InstructionSet s>() { return &compiled_pair_kernels<s>(kind); });
}

const BoxKernels& box_kernels(InstructionSet set) {
  return *CompiledSets::kernels(set, []<InstructionSet s>() { return &compiled_box_kernels<s>(); });
}

}  // namespace resilin
