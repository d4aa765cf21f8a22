#include "resilin/element/element.hpp"

namespace resilin {

PointGeometry point_geometry(const ElementInfo& element, const QuadraturePoint& point,
                             std::span<const double> rest_positions) {
  const auto dim = static_cast<std::size_t>(element.dim),
             num_nodes = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> reference(dim * num_nodes);
  element.shape_gradients(point.xi, reference);
  // dX/dxi, in 2D with the unit thickness as third direction
  Matrix<3> dX_dxi = Matrix<3>::Zero();
  if (element.dim == 2) dX_dxi(2, 2) = 1;
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t k = 0; k < dim; ++k)
        dX_dxi(static_cast<int>(i), static_cast<int>(k)) +=
            rest_positions[a * dim + i] * reference[a * dim + k];
  const Matrix<3> dxi_dX = dX_dxi.inverse();
  PointGeometry geometry{point.weight * dX_dxi.determinant(), std::vector<double>(dim * num_nodes, 0.0)};
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t k = 0; k < dim; ++k)
      for (std::size_t i = 0; i < dim; ++i)
        geometry.gradients[a * dim + i] +=
            reference[a * dim + k] * dxi_dX(static_cast<int>(k), static_cast<int>(i));
  return geometry;
}

}  // namespace resilin
