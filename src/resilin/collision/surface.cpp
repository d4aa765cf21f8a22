#include "resilin/collision/surface.hpp"

#include <algorithm>
#include <array>

namespace resilin {

Index add_body(CollisionSurface& surface, Index num_vertices, std::span<const Index> facets) {
  const auto first = static_cast<Index>(surface.num_vertices());
  const Index body = surface.bodies.empty() ? 0 : surface.bodies.back() + 1;
  surface.bodies.insert(surface.bodies.end(), static_cast<std::size_t>(num_vertices), body);
  for (Index v = 0; v < num_vertices; ++v) surface.points.push_back(first + v);
  const auto corners = static_cast<std::size_t>(surface.dim);
  std::vector<std::array<Index, 2>> edges;
  for (std::size_t i = 0; i + corners <= facets.size(); i += corners) {
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = first + facets[i + k], b = first + facets[i + (k + 1) % corners];
      if (a != b || surface.dim == 2) edges.push_back({std::min(a, b), std::max(a, b)});
      if (surface.dim == 3) surface.triangles.push_back(a);
    }
  }
  std::ranges::sort(edges);
  const auto repeated = std::ranges::unique(edges);
  edges.erase(repeated.begin(), repeated.end());
  for (const auto& [a, b] : edges) surface.edges.insert(surface.edges.end(), {a, b});
  return first;
}

}  // namespace resilin
