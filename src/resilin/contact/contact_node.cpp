#include "resilin/contact/contact_node.hpp"

#include <array>
#include <map>

namespace resilin {

std::vector<ContactNode> contact_nodes(int dim, const CellBlock& facets, const VectorX& rest_positions,
                                       double stiffness) {
  std::map<Index, double> areas;
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets.cell(facet);
    std::array<double, 6> squares{};
    double area = 0, sum = 0;
    for (const FacetPoint& point : facet_points(facets.kind)) {
      const double weight = point.weight * area_vector(dim, point, nodes, rest_positions).norm();
      area += weight;
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const double square = weight * point.values[a] * point.values[a];
        squares[a] += square;
        sum += square;
      }
    }
    if (!(sum > 0)) continue;  // a facet without area has no share
    for (std::size_t a = 0; a < nodes.size(); ++a) areas[nodes[a]] += area * squares[a] / sum;
  }
  std::vector<ContactNode> result;
  for (const auto& [node, area] : areas) result.push_back({node, stiffness * area});
  return result;
}

}  // namespace resilin
