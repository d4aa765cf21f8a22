#include "resilin/fields/nodal_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

constexpr int columns = 3;  // components that are solved for at a time
constexpr double tolerance = 1e-13;

std::vector<double> shape_values(const ElementInfo& element, std::span<const Vector3> places) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> values(places.size() * n);
  for (std::size_t i = 0; i < places.size(); ++i)
    element.shape_values(places[i], std::span(values).subspan(i * n, n));
  return values;
}

std::vector<Vector3> places_of(const QuadratureRule& rule) {
  std::vector<Vector3> places;
  for (const QuadraturePoint& point : rule.points) places.push_back(point.xi);
  return places;
}

}  // namespace

NodalFit::NodalFit(const Body& body) : num_nodes_(static_cast<std::size_t>(body.num_nodes)) {
  const ElementInfo& element = body.domains.element();
  const ElementInfo& corner = corner_element(element);
  const auto nodes_per_cell = static_cast<std::size_t>(element.num_nodes);
  num_points_ = static_cast<std::size_t>(body.domains.num_points());
  num_corners_ = static_cast<std::size_t>(corner.num_nodes);
  for (std::size_t begin = 0; begin < body.cells.size(); begin += nodes_per_cell)
    for (std::size_t a = 0; a < num_corners_; ++a)
      corners_.push_back(body.cells[begin + a] - body.first_node);
  point_volumes_ = body.domains.point_volumes();
  shape_at_points_ = shape_values(corner, places_of(body.domains.quadrature()));
  shape_at_nodes_ = shape_values(corner, element.nodes);

  BlockPatternBuilder builder(body.num_nodes);
  builder.add_cells(corners_, corner.num_nodes);
  matrix_ = BlockMatrix(columns, std::make_shared<const BlockPattern>(builder.build()));
  add_matrix(body);
  find_nodes_between(body);
  solver_ = make_linear_solver({.kind = "cg_jacobi"}, matrix_.num_unknowns());
  solver_->analyze(matrix_, VectorX());
  solver_->factorize(matrix_);
}

void NodalFit::add_matrix(const Body& body) {
  // Cells of one point are simplices of degree 1, whose points weigh the same in all of them.
  const bool has_enough_points = body.domains.quadrature().degree >= 2;
  const CellShape shape = body.domains.element().shape;
  const QuadratureRule& rule = has_enough_points ? body.domains.quadrature() : rule_of_degree(shape, 2);
  const std::vector<double> N = shape_values(corner_element(body.domains.element()), places_of(rule));
  std::vector<bool> is_corner(num_nodes_, false);
  for (std::size_t cell = 0; cell * num_corners_ < corners_.size(); ++cell) {
    const Index* nodes = corners_.data() + cell * num_corners_;
    for (std::size_t a = 0; a < num_corners_; ++a) {
      is_corner[static_cast<std::size_t>(nodes[a])] = true;
      for (std::size_t b = 0; b < num_corners_; ++b) {
        if (nodes[b] < nodes[a]) continue;
        double entry = 0;
        for (std::size_t q = 0; q < rule.points.size(); ++q) {
          const double volume = has_enough_points
                                    ? point_volumes_[cell * num_points_ + q]
                                    : point_volumes_[cell] * rule.points[q].weight / size(shape);
          entry += volume * N[q * num_corners_ + a] * N[q * num_corners_ + b];
        }
        double* block = matrix_.block(matrix_.pattern->slot(nodes[a], nodes[b]));
        for (int k = 0; k < columns; ++k) block[k * (columns + 1)] += entry;
      }
    }
  }
  for (Index node = 0; node < matrix_.num_nodes(); ++node)
    if (!is_corner[static_cast<std::size_t>(node)])
      for (int k = 0; k < columns; ++k) matrix_.add_to_diagonal(node, k, 1);
}

void NodalFit::find_nodes_between(const Body& body) {
  const auto nodes_per_cell = static_cast<std::size_t>(body.domains.element().num_nodes);
  std::vector<bool> is_found(num_nodes_, false);
  for (std::size_t cell = 0; cell * nodes_per_cell < body.cells.size(); ++cell)
    for (std::size_t local = num_corners_; local < nodes_per_cell; ++local) {
      const auto node = static_cast<std::size_t>(body.cells[cell * nodes_per_cell + local] - body.first_node);
      if (!is_found[node]) between_.push_back({node, cell, local});
      is_found[node] = true;
    }
}

/// sum_q V_q N_a(xi_q) f_q of the components `first`, `first` + 1, ...
VectorX NodalFit::right_side(std::span<const double> point_values, std::size_t components,
                             std::size_t first) const {
  VectorX b = VectorX::Zero(matrix_.num_unknowns());
  const std::size_t count = std::min<std::size_t>(columns, components - first);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const std::size_t cell = i / num_corners_, a = i % num_corners_;
    for (std::size_t q = 0; q < num_points_; ++q) {
      const std::size_t point = cell * num_points_ + q;
      const double weight = point_volumes_[point] * shape_at_points_[q * num_corners_ + a];
      for (std::size_t k = 0; k < count; ++k)
        b[Eigen::Index{corners_[i]} * columns + static_cast<Eigen::Index>(k)] +=
            weight * point_values[point * components + first + k];
    }
  }
  return b;
}

std::vector<double> NodalFit::fit(std::span<const double> point_values, int num_components) {
  const auto components = static_cast<std::size_t>(num_components);
  std::vector<double> values(num_nodes_ * components, std::numeric_limits<double>::quiet_NaN());
  if (!std::ranges::all_of(point_values, [](double value) { return std::isfinite(value); })) return values;
  for (std::size_t first = 0; first < components; first += columns) {
    const VectorX b = right_side(point_values, components, first);
    VectorX x = VectorX::Zero(b.size());
    solver_->solve(matrix_, b, x, tolerance);
    for (std::size_t node = 0; node < num_nodes_; ++node)
      for (std::size_t k = 0; k < columns && first + k < components; ++k)
        values[node * components + first + k] = x[static_cast<Eigen::Index>(node * columns + k)];
  }
  for (const auto& [node, cell, local] : between_)
    for (std::size_t k = 0; k < components; ++k) {
      double value = 0;
      for (std::size_t a = 0; a < num_corners_; ++a) {
        const auto corner = static_cast<std::size_t>(corners_[cell * num_corners_ + a]);
        value += shape_at_nodes_[local * num_corners_ + a] * values[corner * components + k];
      }
      values[node * components + k] = value;
    }
  return values;
}

}  // namespace resilin
