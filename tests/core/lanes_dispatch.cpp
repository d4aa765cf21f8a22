#include "lanes_probe.hpp"
#include "resilin/core/kernel_dispatch.hpp"

namespace resilin::testing {

const LanesProbe& lanes_probe(InstructionSet set) {
  return *CompiledSets::kernels(set, []<InstructionSet s>() { return &compiled_lanes_probe<s>(); });
}

}  // namespace resilin::testing
