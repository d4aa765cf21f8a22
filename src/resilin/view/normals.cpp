#include "resilin/view/normals.hpp"

#include <cmath>
#include <numeric>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t triangles_per_chunk = 4096;
constexpr std::size_t vertices_per_chunk = 2048;

/// Twice the area vector of a triangle, and a number to spare, so that it fills a register.
using AreaVector = Eigen::Vector4f;

AreaVector area_vector(const VertexNormals::Triangle& triangle, const float* positions) {
  const float *a = positions + 3 * std::size_t{triangle[0]}, *b = positions + 3 * std::size_t{triangle[1]},
              *c = positions + 3 * std::size_t{triangle[2]};
  const float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const float vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx, 0};
}

}  // namespace

VertexNormals::VertexNormals(std::span<const Triangle> triangles, Index num_vertices)
    : triangles_(triangles.begin(), triangles.end()),
      first_(static_cast<std::size_t>(num_vertices) + 1, 0),
      triangles_at_(3 * triangles.size()) {
  for (const Triangle& triangle : triangles_)
    for (const std::uint32_t vertex : triangle) ++first_[vertex + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t vertex : triangles_[t])
      triangles_at_[next[vertex]++] = static_cast<std::uint32_t>(t);
}

void VertexNormals::evaluate(std::span<const float> positions, std::span<float> out) const {
  std::vector<AreaVector> areas(triangles_.size());
  parallel_for(triangles_.size(), triangles_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) areas[t] = area_vector(triangles_[t], positions.data());
  });
  parallel_for(first_.size() - 1, vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      AreaVector sum = AreaVector::Zero();
      for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) sum += areas[triangles_at_[i]];
      const float length = std::sqrt(sum.squaredNorm());
      float* normal = out.data() + 3 * v;
      const bool is_none = !(length > 0);
      normal[0] = is_none ? 0 : sum[0] / length;
      normal[1] = is_none ? 0 : sum[1] / length;
      normal[2] = is_none ? 1 : sum[2] / length;
    }
  });
}

}  // namespace resilin
