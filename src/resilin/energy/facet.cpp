#include "resilin/energy/facet.hpp"

namespace resilin {

Vector3 node_position(int dim, Index node, const VectorX& x) {
  Vector3 position = Vector3::Zero();
  position.head(dim) = x.segment(Eigen::Index{node} * dim, dim);
  return position;
}

Vector3 area_vector(int dim, const LoadedFacet& facet, const VectorX& x) {
  const Vector3 first = node_position(dim, facet.nodes[0], x);
  const Vector3 edge = node_position(dim, facet.nodes[1], x) - first;
  if (dim == 2) return {edge.y(), -edge.x(), 0};
  return 0.5 * edge.cross(node_position(dim, facet.nodes[2], x) - first);
}

}  // namespace resilin
