#include "resilin/mesh/surface_places.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "resilin/core/parallel.hpp"
#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/quality.hpp"

namespace resilin {
namespace {

constexpr std::size_t places_per_chunk = 128;
constexpr std::size_t overlap_samples = 4000;
constexpr double overlap_share =
    0.002;  // largest share of samples that lie inside: more tell of shells that overlap
constexpr double voxel_share = 0.4;  // voxel by the distance of points from the surface: free of it there
constexpr double step_off = 1e-4;    // relative to the extent: from the surface to where a side is asked for

std::vector<Box> boxes_of(const Mesh& mesh, const CellBlock& triangles) {
  std::vector<Box> boxes(static_cast<std::size_t>(triangles.num_cells()));
  for (Index t = 0; t < triangles.num_cells(); ++t)
    for (const Index node : triangles.cell(t))
      boxes[static_cast<std::size_t>(t)].add(mesh.vertices[static_cast<std::size_t>(node)]);
  return boxes;
}

std::vector<std::array<Vector3, 3>> corners_of(const SolidSurface& surface) {
  std::vector<std::array<Vector3, 3>> corners;
  for (Index t = 0; t < surface.triangles().num_cells(); ++t) {
    const auto nodes = surface.triangles().cell(t);
    const auto X = [&](std::size_t i) { return surface.mesh.vertices[static_cast<std::size_t>(nodes[i])]; };
    corners.push_back({X(0), X(1), X(2)});
  }
  return corners;
}

/// A number in [0, 1) for each count: the same on every machine.
double scattered(std::uint64_t count) {
  std::uint64_t z = (count + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

SurfacePlaces::SurfacePlaces(const SolidSurface& surface)
    : surface_(surface),
      corners_(corners_of(surface)),
      areas_(triangle_area_vectors(surface.mesh, surface.triangles())),
      tree_(boxes_of(surface.mesh, surface.triangles())),
      winding_(surface.mesh, surface.triangles()),
      volume_(surface.volume) {
  const BoundingBox box = bounding_box(surface.mesh);
  extent_ = (box.max - box.min).norm();
  const Vector3 middle = 0.5 * (box.min + box.max);
  double signed_volume = 0;
  for (std::size_t t = 0; t < areas_.size(); ++t)
    signed_volume += (corners_[t][0] - middle).dot(areas_[t]) / 3;
  if (signed_volume < 0)
    for (Vector3& area : areas_) area = -area;
  const std::vector<SurfacePlace> samples = spread(overlap_samples);
  std::vector<std::uint8_t> is_at_rim(samples.size());
  parallel_for(samples.size(), places_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) is_at_rim[i] = static_cast<std::uint8_t>(is_rim(samples[i]));
  });
  // V = 1/3 sum_rim (X . n) dA, so that the samples inside are taken off the sum over all.
  double inner = 0;
  std::size_t num_inner = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_at_rim[i] != 0) continue;
    ++num_inner;
    inner += (samples[i].X - middle).dot(samples[i].normal);
  }
  const auto count = static_cast<double>(samples.size());
  has_overlaps_ = static_cast<double>(num_inner) > overlap_share * count;
  if (has_overlaps_) volume_ = std::max(0.0, volume_ - inner * surface.area / count / 3);
}

void SurfacePlaces::expect_points(double distance) {
  grid_ = InsideGrid(surface_, voxel_share * distance,
                     [&](const Vector3& p) { return std::abs(winding_(p)) > 0.5; });
}

Vector3 SurfacePlaces::nearest_on(Index triangle, const Vector3& p) const {
  const auto& [a, b, c] = corners(triangle);
  const auto shares = closest_on_triangle(p, a, b, c);
  return shares[0] * a + shares[1] * b + shares[2] * c;
}

SurfacePlace SurfacePlaces::nearest(const Vector3& p, Index hint) const {
  const Index triangle =
      tree_.nearest(p, [&](Index t) { return (nearest_on(t, p) - p).squaredNorm(); }, hint);
  return {nearest_on(triangle, p), areas_[static_cast<std::size_t>(triangle)].normalized(), triangle};
}

bool SurfacePlaces::is_near(const Vector3& p, double distance) const {
  bool is_found = false;
  const double square = distance * distance;
  tree_.visit_where([&](const Box& box) { return !is_found && box.squared_distance(p) < square; },
                    [&](Index t) { is_found = is_found || (nearest_on(t, p) - p).squaredNorm() < square; });
  return is_found;
}

std::vector<SurfacePlace> SurfacePlaces::spread(std::size_t count) const {
  std::vector<SurfacePlace> places;
  const double step = surface_.area / static_cast<double>(count);
  double passed = 0;
  for (Index t = 0; t < surface_.triangles().num_cells(); ++t) {
    const Vector3& area = areas_[static_cast<std::size_t>(t)];
    passed += area.norm();
    const auto& [a, b, c] = corners(t);
    while ((static_cast<double>(places.size()) + 0.5) * step < passed && places.size() < count) {
      const std::uint64_t number = 2 * places.size();
      double u = scattered(number), v = scattered(number + 1);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      places.push_back({a + u * (b - a) + v * (c - a), area.normalized(), t});
    }
  }
  return places;
}

bool SurfacePlaces::is_rim(const SurfacePlace& place) const {
  const Vector3 step = step_off * extent_ * place.normal;
  return is_inside(place.X - step) != is_inside(place.X + step);
}

double SurfacePlaces::thickness(const SurfacePlace& place) const {
  const Vector3 way = -place.normal;
  const double start = 1e-9 * extent_;
  double least = std::numeric_limits<double>::infinity();
  const auto is_met = [&](const Box& box) {
    double from = start, to = least;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(way[i]) < 1e-15) {
        if (place.X[i] < box.min[i] || place.X[i] > box.max[i]) return false;
        continue;
      }
      double a = (box.min[i] - place.X[i]) / way[i], b = (box.max[i] - place.X[i]) / way[i];
      if (a > b) std::swap(a, b);
      from = std::max(from, a - start);
      to = std::min(to, b + start);
      if (from > to) return false;
    }
    return true;
  };
  tree_.visit_where(is_met, [&](Index t) {
    const auto& [a, b, c] = corners(t);
    const Vector3 u = b - a, v = c - a, across = way.cross(v);
    const double divisor = u.dot(across);
    if (divisor == 0) return;
    const Vector3 w = place.X - a;
    const double s = w.dot(across) / divisor, r = way.dot(w.cross(u)) / divisor;
    if (s < 0 || r < 0 || s + r > 1) return;
    const double depth = v.dot(w.cross(u)) / divisor;
    if (depth > start) least = std::min(least, depth);
  });
  return least;
}

}  // namespace resilin
