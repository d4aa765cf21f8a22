#include "resilin/simulation/body_space.hpp"

#include <Eigen/LU>

namespace resilin {

template <int dim>
void BodySpace<dim>::form_cells(const Domain& domain, std::size_t first, std::size_t last, const VectorX& x,
                                const DistributedLoads& loads, const Vector3& body_force,
                                std::vector<double>& cell_residuals) {
  constexpr int square = dim * dim;
  const ElasticEnergy& elastic = *domain.energy;
  const ElementInfo& element = elastic.element();
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const std::vector<Index>& nodes = body_.cells;
  const std::size_t n = columns_ / dim, count = rows_ / dim, num_points = points.size();
  const std::size_t num_functions = space_.functions().size();
  std::vector<double> values;   // values of the functions on the reference cell, [point][function]
  std::vector<Vector3> slopes;  // likewise
  for (const QuadraturePoint& point : points)
    for (std::size_t f = 0; f < num_functions; ++f) {
      values.push_back(space_.value(f, point.xi));
      slopes.push_back(space_.gradient(f, point.xi));
    }
  std::vector<double> H((last - first) * num_points * square), P(H.size()), A(H.size() * square);
  std::vector<PointGeometry> geometries((last - first) * num_points);
  std::vector<double> constants;
  std::vector<Vector3> fibres;
  std::size_t num_fibres = 0;
  for (std::size_t cell = first; cell < last; ++cell) {
    const Material material = elastic.material(static_cast<Index>(cell));
    num_fibres = material.fibres.size();
    for (std::size_t q = 0; q < num_points; ++q) {
      constants.insert(constants.end(), material.constants.begin(), material.constants.end());
      fibres.insert(fibres.end(), material.fibres.begin(), material.fibres.end());
    }
  }
  parallel_for(last - first, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<double> rest(n * dim);
    for (std::size_t i = begin; i < end; ++i) {
      const Index* const local =
          nodes.data() + static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i))) * n;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t k = 0; k < dim; ++k)
          rest[a * dim + k] =
              world_.rest_positions[Eigen::Index{local[a]} * dim + static_cast<Eigen::Index>(k)];
      for (std::size_t q = 0; q < num_points; ++q) {
        PointGeometry& geometry = geometries[i * num_points + q];
        geometry = point_geometry(element, points[q], rest);
        Eigen::Map<Eigen::Matrix<double, dim, dim, Eigen::RowMajor>> gradient(H.data() +
                                                                              (i * num_points + q) * square);
        gradient.setZero();
        for (std::size_t a = 0; a < n; ++a) {
          const auto node = Eigen::Index{local[a]} * dim;
          gradient += (x.segment<dim>(node) - world_.rest_positions.segment<dim>(node)) *
                      Eigen::Map<const Eigen::Matrix<double, 1, dim>>(geometry.gradients.data() + a * dim);
        }
      }
    }
  });
  StateBatch<double> states{.law = &elastic.law(),
                            .dim = dim,
                            .count = (last - first) * num_points,
                            .deformation_gradients = H.data(),
                            .holds_displacement_gradients = true,
                            .constants = {},
                            .fibres = fibres.empty() ? nullptr : fibres.front().data(),
                            .num_fibres = num_fibres,
                            .fibre_stride = 3 * num_fibres,
                            .instruction_set = elastic.instruction_set()};
  const std::size_t num_constants = elastic.law().constants.size();
  for (std::size_t k = 0; k < num_constants; ++k)
    states.constants.push_back({constants.data() + k, num_constants});
  first_piola_kirchhoff_stresses(states, P.data());
  stress_tangents(states, Projection::none, A.data());
  std::vector<double> stiffnesses;
  if (is_mixed()) stiffnesses = replace_pressures(domain, first, last, x, states, P, A);

  parallel_for(last - first, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Matrix<double, dim, 1>> gradients(count + n);
    Eigen::Matrix<double, dim, Eigen::Dynamic, Eigen::RowMajor> products(
        dim, static_cast<Eigen::Index>(rows_ + columns_));
    products.setZero();
    for (std::size_t i = begin; i < end; ++i) {
      const auto cell = static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i)));
      Vector3 density = body_force;
      if (!loads.cells.empty()) {
        const auto found = loads.cells.find({nodes.begin() + static_cast<std::ptrdiff_t>(cell * n),
                                             nodes.begin() + static_cast<std::ptrdiff_t>((cell + 1) * n)});
        if (found != loads.cells.end()) density += found->second;
      }
      double* const K = matrices_.data() + cell * rows_ * (rows_ + columns_);
      for (std::size_t q = 0; q < num_points; ++q) {
        const PointGeometry& geometry = geometries[i * num_points + q];
        const double weight = geometry.weight;
        for (std::size_t f = 0; f < num_functions; ++f)
          gradients[f] = (geometry.dxi_dX.transpose() * slopes[q * num_functions + f]).template head<dim>();
        for (std::size_t a = 0; a < n; ++a)
          gradients[count + a] =
              Eigen::Map<const Eigen::Matrix<double, dim, 1>>(geometry.gradients.data() + a * dim);
        const std::size_t state = i * num_points + q;
        const Eigen::Map<const Eigen::Matrix<double, dim, dim, Eigen::RowMajor>> stress(P.data() +
                                                                                        state * square);
        for (std::size_t f = 0; f < num_functions; ++f)
          for (int k = 0; k < dim; ++k)
            cell_residuals[cell * rows_ + f * dim + static_cast<std::size_t>(k)] +=
                weight * (values[q * num_functions + f] * density[k] - stress.row(k).dot(gradients[f]));
        // K_ai,bk = G_aj A_ij,kl G_bl: A G of all functions b first, [j, (b, k)] for each i
        const Eigen::Map<const Eigen::Matrix<double, square, square, Eigen::RowMajor>> tangent(
            A.data() + state * square * square);
        for (int row = 0; row < dim; ++row) {
          for (int k = 0; k < dim; ++k) {
            const Square block = weight * tangent.template block<dim, dim>(row * dim, k * dim);
            for (std::size_t b = 0; b < count + n; ++b)
              if (b < num_functions || b >= count)
                products.col(static_cast<Eigen::Index>(b) * dim + k) = block * gradients[b];
          }
          for (std::size_t f = 0; f < num_functions; ++f) {
            Eigen::Map<Eigen::RowVectorXd> out(
                K + (f * dim + static_cast<std::size_t>(row)) * (rows_ + columns_),
                static_cast<Eigen::Index>(rows_ + columns_));
            if constexpr (dim == 3)
              out += gradients[f][0] * products.row(0) + gradients[f][1] * products.row(1) +
                     gradients[f][2] * products.row(2);
            else
              out += gradients[f][0] * products.row(0) + gradients[f][1] * products.row(1);
          }
        }
      }
    }
  });
  for (std::size_t i = 0; i < last - first; ++i) {
    const auto cell = static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i)));
    add_diagonal(cell);
    if (is_mixed())
      add_pressures(cell, std::span(geometries).subspan(i * num_points, num_points), slopes,
                    H.data() + i * num_points * square, stiffnesses[i], cell_residuals.data() + cell * rows_);
  }
}

template <int dim>
void BodySpace<dim>::form_preconditioner() {
  const auto invert = [](Square& block) { block = block.inverse().eval(); };
  const std::size_t count = rows_ / dim, p = space_.functions().size();
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (keys_[i][0] != pressures) invert(inverses_[i]);
  if (!is_mixed()) return;
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(num_cells()); ++cell) {
    const auto row = static_cast<Eigen::Index>(p) * dim;
    Square block = -matrix(cell).template block<dim, dim>(row, row);
    for (std::size_t f = 0; f < p; ++f) {
      const auto number = static_cast<std::size_t>(numbers_[cell * count + f]);
      Square coupling = matrix(cell).template block<dim, dim>(row, static_cast<Eigen::Index>(f) * dim);
      for (int k = 0; k < dim; ++k)
        if (is_fixed_[number * dim + static_cast<std::size_t>(k)] != 0) coupling.col(k).setZero();
      block += coupling * inverses_[number] * coupling.transpose();
    }
    invert(block);
    inverses_[static_cast<std::size_t>(numbers_[cell * count + p])] = block;
  }
}

template void BodySpace<2>::form_cells(const Domain& domain, std::size_t first, std::size_t last,
                                       const VectorX& x, const DistributedLoads& loads,
                                       const Vector3& body_force, std::vector<double>& cell_residuals);
template void BodySpace<3>::form_cells(const Domain& domain, std::size_t first, std::size_t last,
                                       const VectorX& x, const DistributedLoads& loads,
                                       const Vector3& body_force, std::vector<double>& cell_residuals);
template void BodySpace<2>::form_preconditioner();
template void BodySpace<3>::form_preconditioner();

}  // namespace resilin
