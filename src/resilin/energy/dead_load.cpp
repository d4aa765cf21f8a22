#include "resilin/energy/dead_load.hpp"

#include <cmath>

#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/shape_integrals.hpp"

namespace resilin {

bool ActiveTime::contains(double time) const {
  const double slack = time_slack(time);
  return time > from + slack && time <= until + slack;
}

double larger_work(const Energy& term, const VectorX& from, const Conditions& before, const VectorX& to,
                   const Conditions& after) {
  return std::max(term.value(from, after) - term.value(from, before),
                  term.value(to, after) - term.value(to, before));
}

std::optional<double> DeadLoad::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                            const Conditions& after) const {
  if (active_.is_always()) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

double DeadLoad::value(const VectorX& x, const Conditions& c) const {
  return -factor(c) * forces_.dot(x - rest_positions_);
}

double DeadLoad::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  return -factor(c) * forces_.dot(to - from);
}

void DeadLoad::add_gradient(const VectorX&, const Conditions& c, VectorX& gradient) const {
  gradient -= factor(c) * forces_;
}

void DeadLoad::add_gradient_magnitude(const VectorX&, const Conditions& c, VectorX& magnitude) const {
  magnitude += std::abs(factor(c)) * forces_.cwiseAbs();
}

void add_traction(int dim, const CellBlock& facets, const VectorX& rest_positions, const Vector3& traction,
                  VectorX& nodal_forces) {
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets.cell(facet);
    for (const FacetPoint& point : facet_points(facets.kind)) {
      const double area = point.weight * area_vector(dim, point, nodes, rest_positions).norm();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        nodal_forces.segment(Eigen::Index{nodes[a]} * dim, dim) +=
            point.values[a] * area * traction.head(dim);
    }
  }
}

void add_body_force(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                    const Vector3& force, VectorX& nodal_forces) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> X, shares(n);
  for (std::size_t first = 0; first < cells.size(); first += n) {
    const std::span<const Index> nodes = cells.subspan(first, n);
    cell_positions(element.dim, nodes, rest_positions, X);
    integrals.of_values(X, shares);
    for (std::size_t a = 0; a < n; ++a)
      nodal_forces.segment(Eigen::Index{nodes[a]} * element.dim, element.dim) +=
          shares[a] * force.head(element.dim);
  }
}

}  // namespace resilin
