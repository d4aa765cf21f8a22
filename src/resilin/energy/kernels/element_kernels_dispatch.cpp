#include "resilin/energy/kernels/element_kernels.hpp"
#include "resilin/energy/kernels/quadrature_kernels.hpp"

namespace resilin {

const ElementKernels& element_kernels(int dim, InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512::element_kernels(dim);
  if (set == InstructionSet::avx2) return avx2::element_kernels(dim);
#endif
  static_cast<void>(set);
  return baseline::element_kernels(dim);
}

const QuadratureKernels& quadrature_kernels(int dim, int num_nodes, InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512::quadrature_kernels(dim, num_nodes);
  if (set == InstructionSet::avx2) return avx2::quadrature_kernels(dim, num_nodes);
#endif
  static_cast<void>(set);
  return baseline::quadrature_kernels(dim, num_nodes);
}

}  // namespace resilin
