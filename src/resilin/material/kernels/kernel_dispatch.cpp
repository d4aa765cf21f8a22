#include "resilin/core/kernel_dispatch.hpp"
#include "law_headers.hpp"  // made by CMakeLists.txt from the catalogue
#include "resilin/material/catalog.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/kernels/plane_stress_kernels.hpp"
#include "resilin/material/kernels/point_kernels.hpp"

namespace resilin {
namespace {

/// The kernels of a law's twin in plane stress.
template <template <class> class Law, InstructionSet s>
const LawKernels& twin_kernels() {
  constexpr LawKind kind = Law<double>::kind;
  static constexpr LawKernels kernels = {
      [](const LawBatch& batch) {
        compiled_plane_stress_kernels<s>().energy(kind, compiled_law_kernels<Law, s>(), batch);
      },
      [](const LawBatch& batch) {
        compiled_plane_stress_kernels<s>().gradient(kind, compiled_law_kernels<Law, s>(), batch);
      },
      [](const LawBatch& batch) {
        compiled_plane_stress_kernels<s>().curvature(kind, compiled_law_kernels<Law, s>(), batch);
      },
      nullptr,
      [](const LawBatch& batch, int p) {
        compiled_plane_stress_kernels<s>().constant_gradient(kind, compiled_law_kernels<Law, s>(), batch, p);
      },
      [](const LawBatch& batch, int p, int q) {
        compiled_plane_stress_kernels<s>().constant_curvature(kind, compiled_law_kernels<Law, s>(), batch, p,
                                                              q);
      }};
  return kernels;
}

}  // namespace

const LawKernels& law_kernels(int law_index, InstructionSet set) {
  return *CompiledSets::kernels(set, [law_index]<InstructionSet s>() {
#define RESILIN_KERNELS_OF(Law) compiled_law_kernels<Law, s>,
#define RESILIN_TWIN_KERNELS_OF(Law) twin_kernels<Law, s>,
    constexpr const LawKernels& (*kernels_of[])() = {RESILIN_LAWS(RESILIN_KERNELS_OF)
                                                         RESILIN_LAWS(RESILIN_TWIN_KERNELS_OF)};
#undef RESILIN_TWIN_KERNELS_OF
#undef RESILIN_KERNELS_OF
    return &kernels_of[law_index]();
  });
}

const PlaneStressKernels& plane_stress_kernels(InstructionSet set) {
  return *CompiledSets::kernels(set, []<InstructionSet s>() { return &compiled_plane_stress_kernels<s>(); });
}

const PointKernels& point_kernels(int dim, InstructionSet set) {
  return *CompiledSets::kernels(set, [dim]<InstructionSet s>() { return &compiled_point_kernels<s>(dim); });
}

}  // namespace resilin
