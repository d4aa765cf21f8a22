#include "resilin/core/kernel_dispatch.hpp"
#include "resilin/energy/kernels/axisymmetric_kernels.hpp"
#include "resilin/energy/kernels/element_kernels.hpp"
#include "resilin/energy/kernels/overstress_kernels.hpp"
#include "resilin/energy/kernels/quadrature_kernels.hpp"
#include "resilin/energy/kernels/viscous_kernels.hpp"

namespace resilin {

const ElementKernels& element_kernels(int dim, InstructionSet set) {
  return *CompiledSets::kernels(set, [dim]<InstructionSet s>() { return &compiled_element_kernels<s>(dim); });
}

const QuadratureKernels& quadrature_kernels(int dim, int num_nodes, InstructionSet set) {
  return *CompiledSets::kernels(
      set, [dim, num_nodes]<InstructionSet s>() { return &compiled_quadrature_kernels<s>(dim, num_nodes); });
}

const QuadratureKernels& axisymmetric_kernels(int num_nodes, InstructionSet set) {
  return *CompiledSets::kernels(
      set, [num_nodes]<InstructionSet s>() { return &compiled_axisymmetric_kernels<s>(num_nodes); });
}

const ViscousKernels& viscous_kernels(int dim, int num_nodes, InstructionSet set) {
  return *CompiledSets::kernels(
      set, [dim, num_nodes]<InstructionSet s>() { return &compiled_viscous_kernels<s>(dim, num_nodes); });
}

const OverstressKernels& overstress_kernels(int dim, int num_nodes, InstructionSet set) {
  return *CompiledSets::kernels(
      set, [dim, num_nodes]<InstructionSet s>() { return &compiled_overstress_kernels<s>(dim, num_nodes); });
}

const OverstressKernels& axisymmetric_overstress_kernels(int num_nodes, InstructionSet set) {
  return *CompiledSets::kernels(set, [num_nodes]<InstructionSet s>() {
    return &compiled_axisymmetric_overstress_kernels<s>(num_nodes);
  });
}

}  // namespace resilin
