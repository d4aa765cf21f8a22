#include "resilin/collision/feature.hpp"

#include <utility>

namespace resilin {
namespace {

/// Vertices of one part that have a share, rising.
struct FeaturePart {
  std::array<Index, 3> vertices{-1, -1, -1};
  std::size_t count = 0;

  FeaturePart(std::span<const Index> all, const double* weights) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (weights[i] == 0) continue;
      std::size_t place = count++;
      for (; place > 0 && vertices[place - 1] > all[i]; --place) vertices[place] = vertices[place - 1];
      vertices[place] = all[i];
    }
  }
};

}  // namespace

Feature closest_feature(PairKind kind, std::span<const Index> vertices,
                        const std::array<double, most_pair_vertices>& weights) {
  const auto split = static_cast<std::size_t>(num_first(kind));
  FeaturePart a(vertices.first(split), weights.data());
  FeaturePart b(vertices.subspan(split), weights.data() + split);
  if (b.count < a.count || (b.count == a.count && b.vertices < a.vertices)) std::swap(a, b);
  Feature feature;
  feature.kind = b.count == 3   ? PairKind::point_triangle
                 : a.count == 2 ? PairKind::edge_edge
                 : b.count == 2 ? PairKind::point_edge
                                : PairKind::point_point;
  std::size_t next = 0;
  for (const FeaturePart* part : {&a, &b})
    for (std::size_t i = 0; i < part->count; ++i) feature.vertices[next++] = part->vertices[i];
  return feature;
}

}  // namespace resilin
