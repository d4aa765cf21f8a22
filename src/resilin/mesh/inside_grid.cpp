#include "resilin/mesh/inside_grid.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/mesh/edit.hpp"

namespace resilin {
namespace {

constexpr double piece = 0.7;       // longest edge of the pieces that are marked by their boxes, in voxels
constexpr double clearance = 1e-6;  // boxes of triangles are enlarged by it, in voxels
constexpr double hole_radii = 2;    // from the middle of a hole to voxels whose side is remembered
constexpr double free_rim = 1.5;    // free voxels around the surface
constexpr double growth = 1.1;      // growth of voxels that are too many

}  // namespace

InsideGrid::InsideGrid(const SolidSurface& surface, double voxel_size,
                       const std::function<bool(const Vector3&)>& is_inside)
    : size_(voxel_size) {
  const Mesh& mesh = surface.mesh;
  const CellBlock& triangles = surface.triangles();
  const BoundingBox box = bounding_box(mesh);
  const auto count = [&](int axis) {
    return std::ceil((box.max[axis] - box.min[axis]) / size_ + 2 * free_rim);
  };
  while (count(0) * count(1) * count(2) > static_cast<double>(most_voxels)) size_ *= growth;
  for (int axis = 0; axis < 3; ++axis)
    counts_[static_cast<std::size_t>(axis)] = static_cast<int>(count(axis));
  low_ = box.min - Vector3::Constant(free_rim * size_);
  voxels_.assign(number(0, 0, counts_[2]), Voxel::unseen);

  std::vector<Corners> pieces;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto nodes = triangles.cell(t);
    const auto X = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(nodes[i])]; };
    mark({X(0), X(1), X(2)}, pieces);
  }
  for (const OpenRim& hole : open_rims(mesh, triangles)) {
    const Vector3 reach = Vector3::Constant(hole_radii * hole.radius);
    mark(hole.center - reach, hole.center + reach);
  }
  std::vector<std::size_t> stack;
  if (voxels_[0] == Voxel::unseen) fill(0, Voxel::outside, stack);
  for (std::size_t v = 0; v < voxels_.size(); ++v)
    if (voxels_[v] == Voxel::unseen) fill(v, is_inside(middle(v)) ? Voxel::inside : Voxel::outside, stack);
}

std::size_t InsideGrid::number(int i, int j, int k) const {
  const auto n = [](int count) { return static_cast<std::size_t>(count); };
  return n(i) + n(counts_[0]) * (n(j) + n(counts_[1]) * n(k));
}

Vector3 InsideGrid::middle(std::size_t voxel) const {
  const auto row = static_cast<std::size_t>(counts_[0]), columns = static_cast<std::size_t>(counts_[1]);
  const std::size_t column = voxel / row % columns, layer = voxel / row / columns;
  const Vector3 place(static_cast<double>(voxel % row), static_cast<double>(column),
                      static_cast<double>(layer));
  return low_ + size_ * (place + Vector3::Constant(0.5));
}

/// Bisects the triangle until the boxes of its pieces are about as large as a voxel.
void InsideGrid::mark(const Corners& triangle, std::vector<Corners>& stack) {
  stack = {triangle};
  while (!stack.empty()) {
    const Corners corners = stack.back();
    stack.pop_back();
    std::size_t longest = 0;
    std::array<double, 3> squares{};
    for (std::size_t i = 0; i < 3; ++i) {
      squares[i] = (corners[(i + 1) % 3] - corners[i]).squaredNorm();
      if (squares[i] > squares[longest]) longest = i;
    }
    if (squares[longest] > piece * piece * size_ * size_) {
      const Vector3 &a = corners[longest], &b = corners[(longest + 1) % 3], &c = corners[(longest + 2) % 3];
      const Vector3 halfway = 0.5 * (a + b);
      stack.push_back({a, halfway, c});
      stack.push_back({halfway, b, c});
      continue;
    }
    mark(corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
         corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]));
  }
}

std::array<int, 3> InsideGrid::voxel_at(const Vector3& X, double shift) const {
  std::array<int, 3> voxel{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    voxel[i] = static_cast<int>(
        std::clamp(std::floor((X[axis] - low_[axis]) / size_ + shift), 0.0, counts_[i] - 1.0));
  }
  return voxel;
}

/// Marks the voxels that a box touches.
void InsideGrid::mark(const Vector3& low, const Vector3& high) {
  const auto first = voxel_at(low, -clearance), last = voxel_at(high, clearance);
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) voxels_[number(i, j, k)] = Voxel::unknown;
}

/// Gives a side to all unseen voxels that hang together with the first one.
void InsideGrid::fill(std::size_t first, Voxel side, std::vector<std::size_t>& stack) {
  const auto row = static_cast<std::size_t>(counts_[0]), columns = static_cast<std::size_t>(counts_[1]),
             layer = row * columns;
  stack = {first};
  voxels_[first] = side;
  const auto visit = [&](std::size_t voxel) {
    if (voxels_[voxel] != Voxel::unseen) return;
    voxels_[voxel] = side;
    stack.push_back(voxel);
  };
  while (!stack.empty()) {
    const std::size_t voxel = stack.back();
    stack.pop_back();
    const std::size_t i = voxel % row, j = voxel / row % columns;
    if (i > 0) visit(voxel - 1);
    if (i + 1 < row) visit(voxel + 1);
    if (j > 0) visit(voxel - row);
    if (j + 1 < columns) visit(voxel + row);
    if (voxel >= layer) visit(voxel - layer);
    if (voxel + layer < voxels_.size()) visit(voxel + layer);
  }
}

InsideGrid::Side InsideGrid::side(const Vector3& X) const {
  if (voxels_.empty()) return Side::unknown;
  std::array<int, 3> place{};
  for (int axis = 0; axis < 3; ++axis) {
    const double at = (X[axis] - low_[axis]) / size_;
    const auto i = static_cast<std::size_t>(axis);
    if (!(at >= 0 && at < counts_[i])) return Side::outside;
    place[i] = static_cast<int>(at);
  }
  switch (voxels_[number(place[0], place[1], place[2])]) {
    case Voxel::inside:
      return Side::inside;
    case Voxel::outside:
      return Side::outside;
    case Voxel::unknown:
    case Voxel::unseen:
      break;
  }
  return Side::unknown;
}

}  // namespace resilin
