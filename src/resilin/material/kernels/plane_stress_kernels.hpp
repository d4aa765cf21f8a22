#pragma once

#include "resilin/core/instruction_set.hpp"
#include "resilin/material/kernels/law_kernels.hpp"

namespace resilin {

/// The kernels of a law in plane stress, made of those of the law in three dimensions. They take the
/// variables of plane strain, F33 = 1, and minimise Psi over the thickness stretch:
/// docs/theory/plane_stress.md. Psi no longer depends on d2 then.
struct PlaneStressKernels {
  void (*energy)(LawKind, const LawKernels& solid, const LawBatch&);
  void (*gradient)(LawKind, const LawKernels& solid, const LawBatch&);
  void (*curvature)(LawKind, const LawKernels& solid, const LawBatch&);
  void (*constant_gradient)(LawKind, const LawKernels& solid, const LawBatch&, int p);
  void (*constant_curvature)(LawKind, const LawKernels& solid, const LawBatch&, int p, int q);
  /// Per block: F33 - 1; not a number where no thickness is free of stress.
  void (*thickness_strain)(LawKind, const LawKernels& solid, const LawBatch&);
};

const PlaneStressKernels& plane_stress_kernels(InstructionSet set);

template <InstructionSet set>
const PlaneStressKernels& compiled_plane_stress_kernels();

}  // namespace resilin
