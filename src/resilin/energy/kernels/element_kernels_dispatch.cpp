#include "resilin/energy/kernels/element_kernels.hpp"

namespace resilin {

const ElementKernels& element_kernels(int dim, InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512::element_kernels(dim);
  if (set == InstructionSet::avx2) return avx2::element_kernels(dim);
#endif
  static_cast<void>(set);
  return baseline::element_kernels(dim);
}

}  // namespace resilin
