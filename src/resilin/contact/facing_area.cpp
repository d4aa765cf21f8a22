#include "resilin/contact/facing_area.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "resilin/mesh/facet.hpp"

namespace resilin {

double facing_area(std::span<const FacetShare> shares) {
  double most = 0;
  for (const FacetShare& face : shares) {
    double seen = 0;
    for (const FacetShare& other : shares) seen += other.area * std::max(0.0, face.normal.dot(other.normal));
    most = std::max(most, seen);
  }
  return most;
}

std::vector<double> facing_areas(const CollisionSurface& parts, const VectorX& places, const Depth& depth) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  const auto way = [&](Index from, Index to) {
    return Vector3(node_position(parts.dim, to, places) - node_position(parts.dim, from, places));
  };
  std::vector<std::vector<FacetShare>> shares(parts.num_vertices());
  for (std::size_t k = 0; k < parts.triangles.size(); k += 3) {
    const Index* v = &parts.triangles[k];
    const Vector3 doubled = way(v[0], v[1]).cross(way(v[0], v[2]));
    const double size = doubled.norm();
    if (!(size > 0)) continue;
    for (int i = 0; i < 3; ++i) shares[at(v[i])].push_back({doubled / size, size / 6});
  }
  for (std::size_t k = 0; parts.dim == 2 && k < parts.edges.size(); k += 2)
    for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
      const Vector3 out = way(parts.edges[k + end], parts.edges[k + 1 - end]);
      const double length = out.norm();
      if (!(length > 0)) continue;
      // Two edges of a vertex turn their normals to one side: the second one goes on where the first came
      // from.
      std::vector<FacetShare>& of_vertex = shares[at(parts.edges[k + end])];
      const double side = of_vertex.size() == 1 ? -1 : 1;
      // The integral of N_a times the depth, which is linear along the edge.
      const double own = depth.at(std::abs(places[2 * Eigen::Index{parts.edges[k + end]}])),
                   other = depth.at(std::abs(places[2 * Eigen::Index{parts.edges[k + 1 - end]}]));
      of_vertex.push_back(
          {side / length * Vector3(-out.y(), out.x(), 0), length / 2 * ((2 * own + other) / 3)});
    }
  std::vector<double> areas;
  for (const std::vector<FacetShare>& of_vertex : shares) areas.push_back(facing_area(of_vertex));
  return areas;
}

}  // namespace resilin
