#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Normals at the vertices of triangles, weighted by area. Each vertex gathers from its triangles in their
/// order, so that the result has the same bits on any number of threads.
class VertexNormals {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  VertexNormals() = default;
  VertexNormals(std::span<const Triangle> triangles, Index num_vertices);

  /// @param positions  3 per vertex [m]
  /// @param out        3 per vertex, of length 1; (0, 0, 1) where there is no area
  void evaluate(std::span<const float> positions, std::span<float> out) const;

 private:
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_;  ///< by vertex, into triangles_at_
  std::vector<std::uint32_t> triangles_at_;
};

}  // namespace resilin
