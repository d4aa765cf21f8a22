#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "resilin/mesh/solid_surface.hpp"

namespace resilin {

/// Remembers which voxels lie inside a surface.
///
/// The winding number of a closed surface is the same at all points that can be joined without crossing it.
/// One query is therefore enough for all voxels that no triangle touches and that are connected by their
/// sides. A hole changes the winding number by the solid angle of its lid, by 4 pi; from twice the radius of
/// its rim on that is a sixteenth at most for a flat lid. Nearer voxels stay unknown.
class InsideGrid {
 public:
  enum class Side : std::uint8_t { unknown, inside, outside };
  static constexpr std::size_t most_voxels = std::size_t{1} << 22;

  /// Knows no side.
  InsideGrid() = default;

  /// @param voxel_size  side of a voxel [m], > 0; larger where `most_voxels` would not do
  /// @param is_inside   whether a point off the surface lies inside, by its winding number
  InsideGrid(const SolidSurface& surface, double voxel_size,
             const std::function<bool(const Vector3&)>& is_inside);

  /// Unknown for voxels that a triangle touches or comes close to.
  Side side(const Vector3& X) const;

 private:
  enum class Voxel : std::uint8_t { unknown, inside, outside, unseen };
  using Corners = std::array<Vector3, 3>;

  std::size_t number(int i, int j, int k) const;
  Vector3 middle(std::size_t voxel) const;
  std::array<int, 3> voxel_at(const Vector3& X, double shift) const;
  void mark(const Vector3& low, const Vector3& high);
  void mark(const Corners& triangle, std::vector<Corners>& stack);
  void fill(std::size_t first, Voxel side, std::vector<std::size_t>& stack);

  Vector3 low_ = Vector3::Zero();  ///< corner of the first voxel
  double size_ = 1;                ///< side of a voxel [m]
  std::array<int, 3> counts_{};
  std::vector<Voxel> voxels_;
};

}  // namespace resilin
