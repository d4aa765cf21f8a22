#pragma once

#include <array>
#include <span>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// Two parts of surfaces that may be near each other, by their numbers.
using Candidate = std::array<Index, 2>;

/// Candidates of one kind and where the vertices of their parts stand: `num_first(kind)` and
/// `num_second(kind)` numbers for each part.
struct CandidateList {
  PairKind kind;
  std::span<const Candidate> pairs;
  std::span<const Index> first_vertices, second_vertices;

  /// The vertices of a candidate, those of the first part first; as many as the kind has.
  std::array<Index, most_pair_vertices> vertices(const Candidate& pair) const {
    const int m = num_first(kind), n = num_second(kind);
    std::array<Index, most_pair_vertices> all{-1, -1, -1, -1};
    for (int i = 0; i < m; ++i)
      all[static_cast<std::size_t>(i)] = first_vertices[static_cast<std::size_t>(pair[0] * m + i)];
    for (int j = 0; j < n; ++j)
      all[static_cast<std::size_t>(m + j)] = second_vertices[static_cast<std::size_t>(pair[1] * n + j)];
    return all;
  }
};

}  // namespace resilin
