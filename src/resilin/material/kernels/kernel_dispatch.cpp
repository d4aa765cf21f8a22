#include "resilin/core/kernel_dispatch.hpp"
#include "resilin/material/catalog.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/kernels/point_kernels.hpp"

namespace resilin {

const LawKernels& law_kernels(int law_index, InstructionSet set) {
  return *CompiledSets::kernels(set, [law_index]<InstructionSet s>() {
#define RESILIN_KERNELS_OF(Law) compiled_law_kernels<Law, s>,
    constexpr const LawKernels& (*kernels_of[])() = {RESILIN_LAWS(RESILIN_KERNELS_OF)};
#undef RESILIN_KERNELS_OF
    return &kernels_of[law_index]();
  });
}

const PointKernels& point_kernels(int dim, InstructionSet set) {
  return *CompiledSets::kernels(set, [dim]<InstructionSet s>() { return &compiled_point_kernels<s>(dim); });
}

}  // namespace resilin
