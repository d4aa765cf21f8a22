#include "resilin/mesh/depth.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace resilin {
namespace {

/// Three Gauss points, exact to degree 5.
std::vector<FacetPoint> gauss_points_of_line(CellKind kind) {
  const double offset = 0.5 * std::sqrt(0.6);
  std::vector<FacetPoint> points;
  for (int q = 0; q < 3; ++q) {
    const double xi = 0.5 + (q - 1) * offset, weight = q == 1 ? 4.0 / 9 : 2.5 / 9;
    if (kind == CellKind::line)
      points.push_back({weight, {1 - xi, xi}, {-1, 0, 1, 0}});
    else
      points.push_back({weight,
                        {(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)},
                        {4 * xi - 3, 0, 4 * xi - 1, 0, 4 - 8 * xi, 0}});
  }
  return points;
}

}  // namespace

double Depth::at(double r) const {
  if (!is_turned) return thickness;
  return is_on_axis(r) ? 0 : 2 * std::numbers::pi * r;
}

const std::vector<FacetPoint>& facet_points(CellKind kind, const Depth& depth) {
  static const std::map<CellKind, std::vector<FacetPoint>> turned = {
      {CellKind::line, gauss_points_of_line(CellKind::line)},
      {CellKind::line3, gauss_points_of_line(CellKind::line3)}};
  return depth.is_turned ? turned.at(kind) : facet_points(kind);
}

double depth_at(int dim, const FacetPoint& point, std::span<const Index> nodes, const VectorX& rest_positions,
                const Depth& depth) {
  double r = 0;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    r += point.values[a] * rest_positions[Eigen::Index{nodes[a]} * dim];
  return depth.at(r);
}

}  // namespace resilin
