#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin::testing {

/// A ball of triangles: an octahedron, each triangle of which is cut into four so many times.
inline Mesh ball_surface(double radius, const Vector3& center, int num_cuts) {
  Mesh mesh;
  mesh.vertices = {Vector3::UnitX(),  -Vector3::UnitX(), Vector3::UnitY(),
                   -Vector3::UnitY(), Vector3::UnitZ(),  -Vector3::UnitZ()};
  std::vector<Index> facets = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (int cut = 0; cut < num_cuts; ++cut) {
    std::map<std::array<Index, 2>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [found, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<Index>(mesh.vertices.size()));
      if (is_new)
        mesh.vertices.push_back(
            (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)])
                .normalized());
      return found->second;
    };
    std::vector<Index> finer;
    for (std::size_t t = 0; t < facets.size(); t += 3) {
      const Index a = facets[t], b = facets[t + 1], c = facets[t + 2];
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    facets = finer;
  }
  for (Vector3& X : mesh.vertices) X = center + radius * X;
  mesh.block(CellKind::triangle).nodes = facets;
  return mesh;
}

}  // namespace resilin::testing
