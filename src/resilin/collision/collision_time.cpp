#include "resilin/collision/collision_time.hpp"

#include <algorithm>

#include "resilin/collision/kernels/pair_kernels.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t pairs_per_chunk = 4096;

/// Calls `body(kernels, batch, begin)` for chunks of the candidates.
template <class Body>
void for_batches(const CandidateList& candidates, InstructionSet set, const Body& body) {
  const PairKernels& kernels = pair_kernels(candidates.kind, set);
  parallel_for(candidates.pairs.size(), pairs_per_chunk, [&](std::size_t begin, std::size_t end) {
    const PairBatch batch = {candidates.pairs[begin].data(), end - begin, candidates.first_vertices.data(),
                             candidates.second_vertices.data()};
    body(kernels, batch, begin);
  });
}

AdvancementLimits limits_of(const CollisionTimeOptions& options) {
  return {options.share_left, options.tolerance, options.max_iterations};
}

}  // namespace

void collision_times(const CandidateList& candidates, std::span<const MovingPoint> points,
                     std::span<double> times, const CollisionTimeOptions& options, InstructionSet set) {
  for_batches(candidates, set, [&](const PairKernels& kernels, const PairBatch& batch, std::size_t begin) {
    kernels.collision_times(batch, points.data(), limits_of(options), &times[begin]);
  });
}

double earliest_collision_time(const CandidateList& candidates, std::span<const MovingPoint> points,
                               const CollisionTimeOptions& options, InstructionSet set) {
  std::vector<double> earliest((candidates.pairs.size() + pairs_per_chunk - 1) / pairs_per_chunk, 1);
  for_batches(candidates, set, [&](const PairKernels& kernels, const PairBatch& batch, std::size_t begin) {
    earliest[begin / pairs_per_chunk] =
        kernels.collision_times(batch, points.data(), limits_of(options), nullptr);
  });
  return earliest.empty() ? 1 : *std::ranges::min_element(earliest);
}

void squared_distances(const CandidateList& candidates, std::span<const MovingPoint> points,
                       std::span<double> squares, InstructionSet set) {
  for_batches(candidates, set, [&](const PairKernels& kernels, const PairBatch& batch, std::size_t begin) {
    kernels.squared_distances(batch, points.data(), &squares[begin]);
  });
}

}  // namespace resilin
