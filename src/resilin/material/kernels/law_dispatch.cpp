#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/kernels/point_kernels.hpp"

namespace resilin {

const LawKernels& law_kernels(int law_index, InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512::law_kernels(law_index);
  if (set == InstructionSet::avx2) return avx2::law_kernels(law_index);
#endif
  static_cast<void>(set);
  return baseline::law_kernels(law_index);
}

const PointKernels& point_kernels(int dim, InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512::point_kernels(dim);
  if (set == InstructionSet::avx2) return avx2::point_kernels(dim);
#endif
  static_cast<void>(set);
  return baseline::point_kernels(dim);
}

}  // namespace resilin
