#include "resilin/energy/dead_load.hpp"

#include <cmath>

#include "resilin/energy/facet.hpp"

namespace resilin {

bool ActiveTime::contains(double time) const {
  const double slack = 1e-9 * std::max(1.0, std::abs(time));
  return time > from + slack && time <= until + slack;
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

void add_traction(int dim, std::span<const LoadedFacet> facets, const VectorX& rest_positions,
                  const Vector3& traction, VectorX& nodal_forces) {
  for (const LoadedFacet& facet : facets) {
    const double share = area_vector(dim, facet, rest_positions).norm() / dim;
    for (int a = 0; a < dim; ++a) {
      nodal_forces.segment(Eigen::Index{facet.nodes[static_cast<std::size_t>(a)]} * dim, dim) +=
          share * traction.head(dim);
    }
  }
}

}  // namespace resilin
