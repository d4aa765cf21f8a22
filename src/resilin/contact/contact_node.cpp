#include "resilin/contact/contact_node.hpp"

#include <array>
#include <map>

#include "resilin/contact/facing_area.hpp"

namespace resilin {

std::vector<ContactNode> contact_nodes(int dim, const CellBlock& facets, const VectorX& rest_positions,
                                       double stiffness, const Depth& depth) {
  // By one point, N_a and its square share linear lines alike.
  const auto share = [&](double N) { return facets.kind == CellKind::line ? N : N * N; };
  std::map<Index, std::vector<FacetShare>> shares;
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets.cell(facet);
    std::array<double, 6> squares{};
    Vector3 whole = Vector3::Zero();
    double area = 0, sum = 0;
    for (const FacetPoint& point : facet_points(facets.kind, depth)) {
      const Vector3 vector = point.weight * area_vector(dim, point, nodes, rest_positions);
      const double weight = depth_at(dim, point, nodes, rest_positions, depth) * vector.norm();
      whole += vector;
      area += weight;
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const double square = weight * share(point.values[a]);
        squares[a] += square;
        sum += square;
      }
    }
    if (!(sum > 0)) continue;  // a facet without area has no share
    for (std::size_t a = 0; a < nodes.size(); ++a)
      shares[nodes[a]].push_back({whole.normalized(), area * squares[a] / sum});
  }
  std::vector<ContactNode> result;
  for (const auto& [node, of_node] : shares) result.push_back({node, stiffness * facing_area(of_node)});
  return result;
}

}  // namespace resilin
