#pragma once

#include <array>
#include <compare>
#include <span>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// The closest features of a pair by their vertices, in one order whatever pair they were found in: a point
/// that is nearest to a corner shared by six triangles gives six equal features.
struct Feature {
  PairKind kind =
      PairKind::point_point;  ///< kind of the closest features: those parts' vertices, the first part first
  std::array<Index, most_pair_vertices> vertices{-1, -1, -1, -1};

  auto operator<=>(const Feature&) const = default;
};

/// The feature of a pair: its vertices with a share in the closest points. Rising within each part; the part
/// with fewer vertices first, of two points or edges that with the lower vertex.
/// @param vertices  of the pair, as many as its kind has
/// @param weights   of `PairDistance`
Feature closest_feature(PairKind kind, std::span<const Index> vertices,
                        const std::array<double, most_pair_vertices>& weights);

}  // namespace resilin
