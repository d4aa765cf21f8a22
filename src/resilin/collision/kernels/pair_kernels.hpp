#pragma once

#include <cstddef>
#include <cstdint>

#include "resilin/collision/moving_point.hpp"
#include "resilin/collision/pair_kind.hpp"
#include "resilin/core/instruction_set.hpp"

namespace resilin {

/// Candidates of one kind: two numbers of parts each, and the vertices of the parts
/// (collision/candidates.hpp).
struct PairBatch {
  const std::int32_t* pairs;
  std::size_t count;
  const std::int32_t* first_vertices;
  const std::int32_t* second_vertices;
};

/// See CollisionTimeOptions.
struct AdvancementLimits {
  double share_left, tolerance;
  int max_iterations;
};

/// Loops over candidates of one kind, as many at once as there are lanes.
struct PairKernels {
  /// The least time. `times`, one for each candidate, or null: then no candidate is followed further than the
  /// least so far.
  double (*collision_times)(const PairBatch&, const MovingPoint*, const AdvancementLimits&, double* times);
  void (*squared_distances)(const PairBatch&, const MovingPoint*, double* squares);
};

const PairKernels& pair_kernels(PairKind kind, InstructionSet set);

template <InstructionSet set>
const PairKernels& compiled_pair_kernels(PairKind kind);

}  // namespace resilin
