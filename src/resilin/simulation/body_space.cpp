#include "resilin/simulation/body_space.hpp"

#include <Eigen/LU>

namespace resilin {

template <int dim>
void BodySpace<dim>::tabulate() {
  const ElementInfo& element = body_.domains.element();
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const auto rows = static_cast<Eigen::Index>(points.size()) * dim;
  const auto count = static_cast<Eigen::Index>(num_functions()), n = static_cast<Eigen::Index>(num_nodes());
  slopes_.resize(rows, count);
  nodal_slopes_.resize(rows, n);
  outer_slopes_.resize(rows * dim, count);
  values_.resize(static_cast<Eigen::Index>(points.size()), count);
  std::vector<double> gradients(num_nodes() * dim);
  for (Eigen::Index q = 0; q < values_.rows(); ++q) {
    const Vector3& xi = points[static_cast<std::size_t>(q)].xi;
    for (Eigen::Index f = 0; f < count; ++f) {
      const Point slope = space_.gradient(static_cast<std::size_t>(f), xi).template head<dim>();
      slopes_.template block<dim, 1>(q * dim, f) = slope;
      for (int J = 0; J < dim; ++J)
        outer_slopes_.template block<dim, 1>(q * square + Eigen::Index{J} * dim, f) = slope[J] * slope;
      values_(q, f) = space_.value(static_cast<std::size_t>(f), xi);
    }
    element.shape_gradients(xi, gradients);
    for (Eigen::Index a = 0; a < n; ++a)
      nodal_slopes_.template block<dim, 1>(q * dim, a) = Eigen::Map<const Point>(gradients.data() + a * dim);
  }
}

template <int dim>
bool BodySpace<dim>::form(const VectorX& x, const DistributedLoads& loads, const Vector3& body_force) {
  residual_.setZero(num_unknowns());
  is_convex_ = true;
  rows_ = num_local() * dim;
  const auto num_cells = static_cast<std::size_t>(this->num_cells());
  const std::size_t num_numbers = num_cells * num_points() * square * square;
  if (is_mixed()) {
    mixed_tangents_.resize(num_numbers);
    pressures_.resize(num_cells);
  } else {
    tangents_.resize(num_numbers);
  }
  std::vector<double> cell_residuals(num_cells * rows_, 0.0);
  inverses_.assign(keys_.size(), Square::Zero());
  Batch batch;
  for (const Domain& domain : body_.domains) {
    const auto count = static_cast<std::size_t>(domain.energy->num_cells());
    for (std::size_t first = 0; first < count; first += cells_per_batch)
      form_cells(domain, first, std::min(first + cells_per_batch, count), x, loads,
                 body_force + domain.density * loads.acceleration, batch, cell_residuals);
  }
  gather(cell_residuals, residual_);
  for (const FacetForce& facet : loads.facets) add_facet(facet);
  set_fixed_to_zero(residual_);
  form_preconditioner();
  return is_convex_ && residual_.allFinite();
}

template <int dim>
BodySpace<dim>::Columns BodySpace<dim>::nodal_values(std::size_t begin, std::size_t end,
                                                     const VectorX& values) const {
  const std::size_t n = num_nodes();
  Columns made(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin) * dim);
  for (std::size_t cell = begin; cell < end; ++cell)
    for (std::size_t a = 0; a < n; ++a)
      made.template block<1, dim>(static_cast<Eigen::Index>(a),
                                  static_cast<Eigen::Index>(cell - begin) * dim) =
          values.segment<dim>(Eigen::Index{body_.cells[cell * n + a]} * dim).transpose();
  return made;
}

template <int dim>
BodySpace<dim>::Columns BodySpace<dim>::function_values(std::size_t begin, std::size_t end,
                                                        const Eigen::Ref<const VectorX>& v) const {
  const std::size_t count = num_functions();
  Columns made(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(end - begin) * dim);
  for (std::size_t cell = begin; cell < end; ++cell)
    for (std::size_t f = 0; f < count; ++f) {
      const std::size_t place = cell * num_local() + f;
      made.template block<1, dim>(static_cast<Eigen::Index>(f),
                                  static_cast<Eigen::Index>(cell - begin) * dim) =
          signs_[place] * v.segment<dim>(Eigen::Index{numbers_[place]} * dim).transpose();
    }
  return made;
}

template <int dim>
void BodySpace<dim>::multiply_by_tangents(std::size_t begin, Columns& gradients) const {
  const std::size_t first = begin * num_points() * square * square;
  if (is_mixed())
    multiply_by(mixed_tangents_.data() + first, gradients);
  else
    multiply_by(tangents_.data() + first, gradients);
}

template <int dim>
template <class Number>
void BodySpace<dim>::multiply_by(const Number* tangents, Columns& gradients) {
  for (Eigen::Index column = 0; column < gradients.cols(); column += dim)
    for (Eigen::Index row = 0; row < gradients.rows(); row += dim, tangents += square * square) {
      std::array<Number, square> h{}, t{};
      for (int i = 0; i < dim; ++i)
        for (int J = 0; J < dim; ++J)
          h[static_cast<std::size_t>(i * dim + J)] = static_cast<Number>(gradients(row + J, column + i));
      for (int b = 0; b < square; ++b)  // the tangent is symmetric
        for (int a = 0; a < square; ++a)
          t[static_cast<std::size_t>(a)] += tangents[b * square + a] * h[static_cast<std::size_t>(b)];
      for (int i = 0; i < dim; ++i)
        for (int J = 0; J < dim; ++J)
          gradients(row + J, column + i) = static_cast<double>(t[static_cast<std::size_t>(i * dim + J)]);
    }
}

template <int dim>
void BodySpace<dim>::apply(const Eigen::Ref<const VectorX>& v, Eigen::Ref<VectorX> image,
                           VectorX& forces) const {
  const std::size_t n = num_nodes(), count = num_functions();
  std::vector<double> own(static_cast<std::size_t>(num_cells()) * rows_),
      others(static_cast<std::size_t>(num_cells()) * n * dim);
  for_each_chunk([&](std::size_t begin, std::size_t end) {
    const Columns functions = function_values(begin, end, v);
    Columns at_points = dense::product(slopes_, functions);
    multiply_by_tangents(begin, at_points);
    const Columns on_functions = dense::transposed_product(slopes_, at_points),
                  on_nodes = dense::transposed_product(nodal_slopes_, at_points);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto column = static_cast<Eigen::Index>(cell - begin) * dim;
      Eigen::Map<RowMajor> on_own(own.data() + cell * rows_, static_cast<Eigen::Index>(count), dim),
          on_others(others.data() + cell * n * dim, static_cast<Eigen::Index>(n), dim);
      on_own = on_functions.template middleCols<dim>(column);
      on_others = on_nodes.template middleCols<dim>(column);
      if (!is_mixed()) continue;
      const Pressures& mixed = pressures_[cell];
      const Eigen::Index split = on_own.size();
      const RowMajor by_rows = functions.template middleCols<dim>(column);
      const Eigen::Map<const VectorX> u(by_rows.data(), split);
      const Point p = v.segment<dim>(Eigen::Index{numbers_[cell * num_local() + count]} * dim);
      VectorX added = mixed.stiffness * mixed.volume.head(split).dot(u) * mixed.volume;
      added += mixed.G.transpose() * p;
      Eigen::Map<VectorX>(on_own.data(), split) += added.head(split);
      Eigen::Map<VectorX>(on_others.data(), on_others.size()) += added.tail(on_others.size());
      Eigen::Map<Point>(on_own.data() + split) = mixed.G.leftCols(split) * u - mixed.compliance * p;
    }
  });
  VectorX sum = VectorX::Zero(num_unknowns());
  gather(own, sum);
  set_fixed_to_zero(sum);
  image = sum;
  for (std::size_t i = 0; i < others.size(); i += dim)
    forces.segment<dim>(Eigen::Index{body_.cells[i / dim]} * dim) +=
        Eigen::Map<const Point>(others.data() + i);
}

template <int dim>
void BodySpace<dim>::subtract_coupling(const VectorX& z, Eigen::Ref<VectorX> image) const {
  const std::size_t count = num_functions();
  std::vector<double> own(static_cast<std::size_t>(num_cells()) * rows_);
  for_each_chunk([&](std::size_t begin, std::size_t end) {
    const Columns nodal = nodal_values(begin, end, z);
    Columns at_points = dense::product(nodal_slopes_, nodal);
    multiply_by_tangents(begin, at_points);
    const Columns on_functions = dense::transposed_product(slopes_, at_points);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto column = static_cast<Eigen::Index>(cell - begin) * dim;
      Eigen::Map<RowMajor> on_own(own.data() + cell * rows_, static_cast<Eigen::Index>(count), dim);
      on_own = on_functions.template middleCols<dim>(column);
      if (!is_mixed()) continue;
      const Pressures& mixed = pressures_[cell];
      const Eigen::Index split = on_own.size();
      const RowMajor by_rows = nodal.template middleCols<dim>(column);
      const Eigen::Map<const VectorX> u(by_rows.data(), by_rows.size());
      Eigen::Map<VectorX>(on_own.data(), split) +=
          mixed.stiffness * mixed.volume.tail(u.size()).dot(u) * mixed.volume.head(split);
      Eigen::Map<Point>(on_own.data() + split) = mixed.G.rightCols(u.size()) * u;
    }
  });
  VectorX sum = VectorX::Zero(num_unknowns());
  gather(own, sum);
  set_fixed_to_zero(sum);
  image -= sum;
}

template <int dim>
void BodySpace<dim>::form_cells(const Domain& domain, std::size_t first, std::size_t last, const VectorX& x,
                                const DistributedLoads& loads, const Vector3& body_force, Batch& batch,
                                std::vector<double>& cell_residuals) {
  const ElasticEnergy& elastic = *domain.energy;
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const std::size_t count = num_functions(), n = num_nodes(), size = last - first;
  const std::size_t num_states = size * points.size();
  batch.H.resize(num_states * square);
  batch.P.resize(num_states * square);
  batch.A.resize(num_states * square * square);
  batch.dxi_dX.resize(num_states);
  batch.weights.resize(num_states);
  batch.constants.clear();
  batch.fibres.clear();
  const auto body_cell = [&](std::size_t i) {
    return static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i)));
  };
  std::size_t num_fibres = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Material material = elastic.material(static_cast<Index>(first + i));
    num_fibres = material.fibres.size();
    for (std::size_t q = 0; q < points.size(); ++q) {
      batch.constants.insert(batch.constants.end(), material.constants.begin(), material.constants.end());
      batch.fibres.insert(batch.fibres.end(), material.fibres.begin(), material.fibres.end());
    }
  }
  parallel_for(size, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    Columns rest(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin) * dim),
        displacements(rest.rows(), rest.cols());
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i - begin) * dim;
      for (std::size_t a = 0; a < n; ++a) {
        const Eigen::Index node = Eigen::Index{body_.cells[body_cell(i) * n + a]} * dim;
        const Point X = world_.rest_positions.segment<dim>(node);
        rest.template block<1, dim>(static_cast<Eigen::Index>(a), column) = X.transpose();
        displacements.template block<1, dim>(static_cast<Eigen::Index>(a), column) =
            (x.segment<dim>(node) - X).transpose();
      }
    }
    const Columns jacobians = dense::product(nodal_slopes_, rest),
                  gradients = dense::product(nodal_slopes_, displacements);
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t q = 0; q < points.size(); ++q) {
        const auto row = static_cast<Eigen::Index>(q) * dim,
                   column = static_cast<Eigen::Index>(i - begin) * dim;
        const std::size_t state = i * points.size() + q;
        const Square dX_dxi = jacobians.template block<dim, dim>(row, column).transpose();
        batch.dxi_dX[state] = dX_dxi.inverse();
        batch.weights[state] = points[q].weight * dX_dxi.determinant();
        Eigen::Map<Tensor>(batch.H.data() + state * square) =
            gradients.template block<dim, dim>(row, column).transpose() * batch.dxi_dX[state];
      }
  });
  StateBatch<double> states{.law = &elastic.law(),
                            .dim = dim,
                            .count = num_states,
                            .deformation_gradients = batch.H.data(),
                            .holds_displacement_gradients = true,
                            .constants = {},
                            .fibres = batch.fibres.empty() ? nullptr : batch.fibres.front().data(),
                            .num_fibres = num_fibres,
                            .fibre_stride = 3 * num_fibres,
                            .instruction_set = elastic.instruction_set()};
  const std::size_t num_constants = elastic.law().constants.size();
  for (std::size_t k = 0; k < num_constants; ++k)
    states.constants.push_back({batch.constants.data() + k, num_constants});
  first_piola_kirchhoff_stresses(states, batch.P.data());
  stress_tangents(states, Projection::none, batch.A.data());
  std::vector<double> stiffnesses;
  if (is_mixed()) stiffnesses = replace_pressures(domain, first, last, x, states, batch.P, batch.A);

  std::vector<Square> diagonals(size * count);  // blocks of the functions
  parallel_for(size, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    const auto num_columns = static_cast<Eigen::Index>(end - begin);
    Columns stresses(slopes_.rows(), num_columns * dim), weights(values_.rows(), num_columns),
        by_directions(outer_slopes_.rows(), num_columns * square);  // tangents, [q, J, L][cell, i, k]
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i - begin);
      for (std::size_t q = 0; q < points.size(); ++q) {
        const std::size_t state = i * points.size() + q;
        const auto row = static_cast<Eigen::Index>(q);
        const Square& X = batch.dxi_dX[state];
        const double weight = batch.weights[state];
        weights(row, column) = weight;
        stresses.template block<dim, dim>(row * dim, column * dim) =
            weight * X * Eigen::Map<const Tensor>(batch.P.data() + state * square).transpose();
        // A_iJ,kL = w X_Jj A_ij,kl X_Ll
        const std::size_t first_number = (body_cell(i) * points.size() + q) * square * square;
        const double* const A = batch.A.data() + state * square * square;
        for (int a = 0; a < dim; ++a)
          for (int k = 0; k < dim; ++k) {
            const Eigen::Map<const Tensor, 0, Eigen::OuterStride<square>> block(A + a * dim * square +
                                                                                k * dim);
            const Square back = weight * X * block * X.transpose();
            for (int J = 0; J < dim; ++J)
              for (int L = 0; L < dim; ++L) {
                const std::size_t number =
                    first_number + static_cast<std::size_t>((a * dim + J) * square + k * dim + L);
                if (is_mixed())
                  mixed_tangents_[number] = back(J, L);
                else
                  tangents_[number] = static_cast<float>(back(J, L));
                by_directions(row * square + Eigen::Index{J} * dim + L,
                              column * square + Eigen::Index{a} * dim + k) = back(J, L);
              }
          }
      }
    }
    const Columns internal = dense::transposed_product(slopes_, stresses),
                  integrals = dense::transposed_product(values_, weights),
                  blocks = dense::transposed_product(outer_slopes_, by_directions);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t cell = body_cell(i);
      const auto column = static_cast<Eigen::Index>(i - begin);
      Vector3 density = body_force;
      if (!loads.cells.empty()) {
        const auto nodes = body_.cells.begin() + static_cast<std::ptrdiff_t>(cell * n);
        const auto found = loads.cells.find({nodes, nodes + static_cast<std::ptrdiff_t>(n)});
        if (found != loads.cells.end()) density += found->second;
      }
      for (std::size_t f = 0; f < count; ++f) {
        const auto row = static_cast<Eigen::Index>(f);
        Eigen::Map<Point>(cell_residuals.data() + cell * rows_ + f * dim) =
            integrals(row, column) * density.template head<dim>() -
            internal.template block<1, dim>(row, column * dim).transpose();
        for (int a = 0; a < dim; ++a)
          diagonals[i * count + f].row(a) =
              blocks.template block<1, dim>(row, column * square + Eigen::Index{a} * dim);
      }
    }
  });
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t cell = body_cell(i);
    for (std::size_t f = 0; f < count; ++f)
      inverses_[static_cast<std::size_t>(numbers_[cell * num_local() + f])] += diagonals[i * count + f];
    if (is_mixed())
      add_pressures(cell, batch, i * points.size(), stiffnesses[i], cell_residuals.data() + cell * rows_);
  }
}

template <int dim>
void BodySpace<dim>::form_preconditioner() {
  const auto invert = [](Square& block) { block = block.inverse().eval(); };
  const std::size_t count = num_local(), p = num_functions();
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (keys_[i][0] != pressures) invert(inverses_[i]);
  for (std::size_t cell = 0; cell < pressures_.size(); ++cell) {
    Square block = pressures_[cell].compliance;
    for (std::size_t f = 0; f < p; ++f) {
      const auto number = static_cast<std::size_t>(numbers_[cell * count + f]);
      Square coupling = pressures_[cell].G.template middleCols<dim>(static_cast<Eigen::Index>(f) * dim);
      for (int k = 0; k < dim; ++k)
        if (is_fixed_[number * dim + static_cast<std::size_t>(k)] != 0) coupling.col(k).setZero();
      block += coupling * inverses_[number] * coupling.transpose();
    }
    invert(block);
    inverses_[static_cast<std::size_t>(numbers_[cell * count + p])] = block;
  }
}

template class BodySpace<2>;
template class BodySpace<3>;

}  // namespace resilin
