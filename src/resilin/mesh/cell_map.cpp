#include "resilin/mesh/cell_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "resilin/element/catalog.hpp"
#include "resilin/mesh/cell_kind.hpp"

namespace resilin {
namespace {

constexpr double rounding = 1e-12;  // by the size of a cell

/// Cells that the Bezier points of their edges bound: `CellMap::box` knows no others.
template <class... Element>
constexpr bool all_are_bounded_by_edges(ElementList<Element...>) {
  return ((Element::degree == 1 || (Element::degree == 2 && is_simplex(Element::shape))) && ...);
}
static_assert(all_are_bounded_by_edges(Elements{}), "CellMap::box wants the Bezier points of faces as well");

Vector3 center_of(const ElementInfo& element) {
  Vector3 center = Vector3::Zero();
  for (int a = 0; a < element.num_corners(); ++a) center += element.nodes[static_cast<std::size_t>(a)];
  return center / element.num_corners();
}

}  // namespace

CellMap::CellMap(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions)
    : element_(element), block_{cell_kind(element), {cells.begin(), cells.end()}} {
  places_.reserve(cells.size());
  for (const Index node : cells) {
    Vector3 X = Vector3::Zero();
    for (int i = 0; i < element.dim; ++i) X[i] = rest_positions[Eigen::Index{node} * element.dim + i];
    places_.push_back(X);
  }
  const Index count = static_cast<Index>(cells.size()) / element.num_nodes;
  affine_.resize(static_cast<std::size_t>(count));
  for (Index cell = 0; cell < count; ++cell) affine_[static_cast<std::size_t>(cell)] = affine_of(cell);
}

const Vector3& CellMap::node(Index cell, int a) const {
  return places_[static_cast<std::size_t>(cell) * static_cast<std::size_t>(element_.num_nodes) +
                 static_cast<std::size_t>(a)];
}

Box CellMap::box(Index cell) const {
  Box box;
  for (int a = 0; a < element_.num_corners(); ++a) box.add(node(cell, a));
  // A quadratic edge lies in the triangle of its Bezier points: its ends and twice its middle less their
  // mean.
  if (element_.num_nodes > element_.num_corners()) {
    int a = element_.num_corners();
    for (const auto& [i, j] : cell_edges(cell_kind(element_)))
      box.add(2 * node(cell, a++) - 0.5 * (node(cell, i) + node(cell, j)));
  }
  return box;
}

double CellMap::mean_edge(Index cell) const {
  const auto edges = cell_edges(cell_kind(element_));
  double sum = 0;
  for (const auto& [i, j] : edges) sum += (node(cell, i) - node(cell, j)).norm();
  return sum / static_cast<double>(edges.size());
}

Vector3 CellMap::place(Index cell, const Vector3& xi) const {
  std::array<double, max_element_nodes> N;
  element_.shape_values(xi, std::span(N).first(static_cast<std::size_t>(element_.num_nodes)));
  Vector3 X = Vector3::Zero();
  for (int a = 0; a < element_.num_nodes; ++a) X += N[static_cast<std::size_t>(a)] * node(cell, a);
  return X;
}

Matrix<3> CellMap::dX_dxi(Index cell, const Vector3& xi) const {
  std::array<double, 3 * max_element_nodes> slopes;
  const auto dim = static_cast<std::size_t>(element_.dim);
  element_.shape_gradients(xi, std::span(slopes).first(static_cast<std::size_t>(element_.num_nodes) * dim));
  Matrix<3> J = Matrix<3>::Zero();
  if (dim == 2) J(2, 2) = 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(element_.num_nodes); ++a)
    for (std::size_t k = 0; k < dim; ++k)
      J.col(static_cast<Eigen::Index>(k)) += slopes[a * dim + k] * node(cell, static_cast<int>(a));
  return J;
}

CellMap::Affine CellMap::affine_of(Index cell) const {
  const Vector3 center = center_of(element_);
  const Matrix<3> J = dX_dxi(cell, center);
  Affine affine{place(cell, center) - J * center, J.inverse(), true};
  const double size = mean_edge(cell);
  for (int a = 0; a < element_.num_nodes; ++a) {
    const Vector3 affine_place = affine.origin + J * element_.nodes[static_cast<std::size_t>(a)];
    if ((affine_place - node(cell, a)).norm() > rounding * size) affine.is_exact = false;
  }
  return affine;
}

double CellMap::depth(const Vector3& xi) const {
  const auto inside = xi.head(element_.dim);
  const double above = inside.minCoeff();
  switch (family(element_.shape)) {
    case ShapeFamily::simplices:
      return std::min(above, 1 - inside.sum());
    case ShapeFamily::cubes:
      break;
  }
  return std::min(above, 1 - inside.maxCoeff());
}

std::optional<Vector3> CellMap::invert(Index cell, const Vector3& X) const {
  const Affine& affine = affine_[static_cast<std::size_t>(cell)];
  Vector3 xi = affine.dxi_dX * (X - affine.origin);
  if (affine.is_exact) return xi;
  xi = xi.cwiseMax(0.0).cwiseMin(1.0);
  constexpr int max_iterations = 40;
  constexpr double longest_step = 0.5;  // in the reference cell, so that no step leaves the map's good range
  const double size = mean_edge(cell);
  for (int i = 0; i < max_iterations; ++i) {
    const Vector3 residual = X - place(cell, xi);
    if (residual.norm() <= rounding * size) return xi;
    Vector3 step = dX_dxi(cell, xi).inverse() * residual;
    if (!step.allFinite()) return std::nullopt;
    const double length = step.norm();
    if (length > longest_step) step *= longest_step / length;
    xi += step;
  }
  return std::nullopt;
}

void CellMap::weights_at(Index cell, const Vector3& xi, const Vector3& X, std::span<double> weights) const {
  const auto count = static_cast<std::size_t>(element_.num_nodes),
             dim = static_cast<std::size_t>(element_.dim);
  element_.shape_values(xi, weights);
  const Vector3 rest = dX_dxi(cell, xi).inverse() * (X - place(cell, xi));
  std::array<double, 3 * max_element_nodes> slopes;
  element_.shape_gradients(xi, std::span(slopes).first(count * dim));
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t k = 0; k < dim; ++k)
      weights[a] += slopes[a * dim + k] * rest[static_cast<Eigen::Index>(k)];
}

}  // namespace resilin
