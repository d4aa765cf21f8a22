#include "resilin/energy/dead_load.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/parallel.hpp"
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

Vector3 power_by_axis(const VectorX& forces, const VectorX& w, int dim) {
  Vector3 power = Vector3::Zero();
  for (Eigen::Index i = 0; i < w.size(); i += dim)
    power.head(dim) += forces.segment(i, dim).cwiseProduct(w.segment(i, dim));
  return power;
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

namespace {

Eigen::Matrix3d cross_matrix(const Vector3& e) {
  Eigen::Matrix3d matrix;
  matrix << 0, -e.z(), e.y(), e.z(), 0, -e.x(), -e.y(), e.x(), 0;
  return matrix;
}

/// Calls `body(nodes, point, area)` for the points of all facets, `area` times a function being its integral.
template <class Body>
void for_each_facet_point(int dim, const CellBlock& facets, const VectorX& X, const Body& body) {
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets.cell(facet);
    for (const FacetPoint& point : facet_points(facets.kind))
      body(nodes, point, point.weight * area_vector(dim, point, nodes, X).norm());
  }
}

/// Slopes of the area at a point by the positions of its nodes: A / |A| . dA.
std::array<Vector3, max_facet_nodes> area_slopes(int dim, std::span<const Index> nodes,
                                                 const FacetPoint& point, const VectorX& X) {
  const auto of_vector = area_vector_slopes(dim, point, nodes, X);
  const Vector3 direction = area_vector(dim, point, nodes, X).normalized();
  std::array<Vector3, max_facet_nodes> slopes;
  for (std::size_t b = 0; b < nodes.size(); ++b)
    slopes[b] = point.weight * of_vector[b].transpose() * direction;
  return slopes;
}

}  // namespace

/// 3D, with tangents t_k = sum_a N_a,k x_a: A = t_0 x t_1, so dA/dx_b = [N_b,1 t_0 - N_b,0 t_1]_x.
/// 2D: A = (t_y, -t_x).
std::array<Eigen::Matrix3d, max_facet_nodes> area_vector_slopes(int dim, const FacetPoint& point,
                                                                std::span<const Index> nodes,
                                                                const VectorX& x) {
  std::array<Eigen::Matrix3d, max_facet_nodes> slopes;
  std::array<Vector3, 2> tangents = {Vector3::Zero(), Vector3::Zero()};
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t k = 0; k < 2; ++k)
      tangents[k] += point.slopes[2 * a + k] * node_position(dim, nodes[a], x);
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    if (dim == 2) {
      slopes[b].setZero();
      slopes[b](0, 1) = point.slopes[2 * b];
      slopes[b](1, 0) = -point.slopes[2 * b];
    } else {
      slopes[b] = cross_matrix(point.slopes[2 * b + 1] * tangents[0] - point.slopes[2 * b] * tangents[1]);
    }
  }
  return slopes;
}

DeadLoad::DeadLoad(std::string name, int dim, std::shared_ptr<const LoadedRegion> region,
                   const Vector3& value, VectorX rest_positions, ActiveTime active)
    : name_(std::move(name)),
      forces_(VectorX::Zero(rest_positions.size())),
      rest_positions_(std::move(rest_positions)),
      active_(std::move(active)),
      region_(std::move(region)),
      value_(value),
      dim_(dim) {
  region_->add_forces(value_, rest_positions_, forces_);
}

std::vector<EnergyParameter> DeadLoad::parameters() const {
  if (!region_) return {{"forces", forces_.size()}};
  return {{"value", region_->value_size(dim_)}, {"rest_positions", forces_.size()}};
}

void DeadLoad::add_parameter_slopes(std::string_view name, const VectorX&, const VectorX& w,
                                    const Conditions& c, VectorX& slopes) const {
  const double t = factor(c);
  if (name == "forces") {
    slopes -= t * w;
  } else if (name == "rest_positions") {
    region_->add_rest_slopes(-t * value_, rest_positions_, w, slopes);
  } else {
    const Vector3 by_value = region_->value_slopes(dim_, rest_positions_, w);
    const int size = region_->value_size(dim_);
    slopes -= t * (size == 1 ? by_value.tail(1) : by_value.head(size));
  }
}

void DeadLoad::add_parameter_forces(std::string_view name, const VectorX&, const VectorX& change,
                                    const Conditions& c, VectorX& gradient) const {
  const double t = factor(c);
  if (name == "forces") {
    gradient -= t * change;
  } else if (name == "rest_positions") {
    region_->add_force_change(-t * value_, rest_positions_, change, gradient);
  } else {
    Vector3 value = Vector3::Zero();
    if (change.size() == 1) {
      value.z() = -t * change[0];
    } else {
      value.head(dim_) = -t * change;
    }
    region_->add_forces(value, rest_positions_, gradient);
  }
}

Vector3 LoadedRegion::value_slopes(int dim, const VectorX& X, const VectorX& w) const {
  VectorX shares = VectorX::Zero(w.size());
  add_forces(Vector3::Ones(), X, shares);
  return power_by_axis(shares, w, dim);
}

void LoadedFacets::add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const {
  for_each_facet_point(
      dim_, facets_, X, [&](std::span<const Index> nodes, const FacetPoint& point, double area) {
        for (std::size_t a = 0; a < nodes.size(); ++a)
          forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += point.values[a] * area * value.head(dim_);
      });
}

void LoadedFacets::add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                                    VectorX& forces) const {
  for_each_facet_point(dim_, facets_, X, [&](std::span<const Index> nodes, const FacetPoint& point, double) {
    const auto slopes = area_slopes(dim_, nodes, point, X);
    double area = 0;
    for (std::size_t b = 0; b < nodes.size(); ++b)
      area += slopes[b].dot(node_position(dim_, nodes[b], change));
    for (std::size_t a = 0; a < nodes.size(); ++a)
      forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += point.values[a] * area * value.head(dim_);
  });
}

void LoadedFacets::add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                                   VectorX& slopes) const {
  for_each_facet_point(dim_, facets_, X, [&](std::span<const Index> nodes, const FacetPoint& point, double) {
    double power = 0;
    for (std::size_t a = 0; a < nodes.size(); ++a)
      power += point.values[a] * value.dot(node_position(dim_, nodes[a], w));
    const auto by_area = area_slopes(dim_, nodes, point, X);
    for (std::size_t b = 0; b < nodes.size(); ++b)
      slopes.segment(Eigen::Index{nodes[b]} * dim_, dim_) += power * by_area[b].head(dim_);
  });
}

void LoadedNodes::add_forces(const Vector3& value, const VectorX&, VectorX& forces) const {
  for (const Index node : nodes_) forces.segment(Eigen::Index{node} * dim_, dim_) += value.head(dim_);
}

void LoadedCells::add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const {
  add_body_force(element_, cells_, X, value, forces);
}

void LoadedCells::add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                                   VectorX& forces) const {
  add_body_force_change(element_, cells_, X, change, value, forces);
}

void LoadedCells::add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                                  VectorX& slopes) const {
  add_body_force_slopes(element_, cells_, X, value, w, slopes);
}

void add_body_force(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                    const Vector3& force, VectorX& nodal_forces) {
  constexpr std::size_t cells_per_chunk = 1024;
  const auto n = static_cast<std::size_t>(element.num_nodes);
  const auto integrate = [&](std::size_t first, std::size_t last) {
    ShapeIntegrals integrals(element);
    std::vector<double> X, shares((last - first) * n);
    for (std::size_t cell = first; cell < last; ++cell) {
      cell_positions(element.dim, cells.subspan(cell * n, n), rest_positions, X);
      integrals.of_values(X, std::span(shares).subspan((cell - first) * n, n));
    }
    return shares;
  };
  parallel_in_order(cells.size() / n, cells_per_chunk, integrate,
                    [&](std::size_t first, const std::vector<double>& shares) {
                      for (std::size_t k = 0; k < shares.size(); ++k)
                        nodal_forces.segment(Eigen::Index{cells[first * n + k]} * element.dim, element.dim) +=
                            shares[k] * force.head(element.dim);
                    });
}

void add_body_force_change(const ElementInfo& element, std::span<const Index> cells,
                           const VectorX& rest_positions, const VectorX& change, const Vector3& force,
                           VectorX& nodal_forces) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> X, dX, shares(n);
  for (std::size_t first = 0; first < cells.size(); first += n) {
    const std::span<const Index> nodes = cells.subspan(first, n);
    cell_positions(element.dim, nodes, rest_positions, X);
    cell_positions(element.dim, nodes, change, dX);
    std::ranges::fill(shares, 0.0);
    integrals.add_change_of_values(X, dX, shares);
    for (std::size_t a = 0; a < n; ++a)
      nodal_forces.segment(Eigen::Index{nodes[a]} * element.dim, element.dim) +=
          shares[a] * force.head(element.dim);
  }
}

void add_body_force_slopes(const ElementInfo& element, std::span<const Index> cells,
                           const VectorX& rest_positions, const Vector3& force, const VectorX& w,
                           VectorX& slopes) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> X, powers(n), by_X(n * static_cast<std::size_t>(element.dim));
  for (std::size_t first = 0; first < cells.size(); first += n) {
    const std::span<const Index> nodes = cells.subspan(first, n);
    cell_positions(element.dim, nodes, rest_positions, X);
    for (std::size_t a = 0; a < n; ++a) powers[a] = force.dot(node_position(element.dim, nodes[a], w));
    std::ranges::fill(by_X, 0.0);
    integrals.add_slopes_of_values(X, powers, by_X);
    add_cell_values(element.dim, nodes, 1, by_X, slopes);
  }
}

}  // namespace resilin
