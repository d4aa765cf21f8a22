#include "resilin/energy/pressure.hpp"

#include <array>

namespace resilin {

Pressure::Pressure(std::string name, int dim, CellBlock facets, double pressure, VectorX rest_positions,
                   ActiveTime active)
    : name_(std::move(name)),
      dim_(dim),
      facets_(std::move(facets)),
      points_(facet_points(facets_.kind)),
      pressure_(pressure),
      rest_positions_(std::move(rest_positions)),
      active_(std::move(active)) {}

double Pressure::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const double p = factor(c);
  if (p == 0) return 0;
  const VectorX middle = 0.5 * (from + to);
  double work = 0;
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    for (const FacetPoint& point : points_) {
      const Vector3 mean_area =
          (area_vector(dim_, point, nodes, from) + 4 * area_vector(dim_, point, nodes, middle) +
           area_vector(dim_, point, nodes, to)) /
          6;
      Vector3 motion = Vector3::Zero();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        motion += point.values[a] * (node_position(dim_, nodes[a], to) - node_position(dim_, nodes[a], from));
      work += point.weight * mean_area.dot(motion);
    }
  }
  return p * work;
}

void Pressure::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  if (const double p = factor(c); p != 0) add_forces(x, p, gradient);
}

void Pressure::add_parameter_slopes(std::string_view, const VectorX& x, const VectorX& w, const Conditions& c,
                                    VectorX& slopes) const {
  VectorX forces = VectorX::Zero(x.size());
  add_forces(x, active_.factor(c), forces);
  slopes[0] += w.dot(forces);
}

void Pressure::add_parameter_forces(std::string_view, const VectorX& x, const VectorX& change,
                                    const Conditions& c, VectorX& gradient) const {
  if (const double p = active_.factor(c) * change[0]; p != 0) add_forces(x, p, gradient);
}

std::optional<double> Pressure::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                            const Conditions& after) const {
  if (active_.is_always()) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

void Pressure::add_forces(const VectorX& x, double p, VectorX& forces) const {
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    for (const FacetPoint& point : points_) {
      const Vector3 force = p * point.weight * area_vector(dim_, point, nodes, x);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += point.values[a] * force.head(dim_);
    }
  }
}

void Pressure::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double p = std::abs(factor(c));
  if (p == 0) return;
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    for (const FacetPoint& point : points_) {
      const Vector3 force = p * point.weight * area_vector(dim_, point, nodes, x).cwiseAbs();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        magnitude.segment(Eigen::Index{nodes[a]} * dim_, dim_) +=
            std::abs(point.values[a]) * force.head(dim_);
    }
  }
}

void Pressure::add_pattern(BlockPatternBuilder& builder) const {
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) builder.add_clique(facets_.cell(facet));
}

void Pressure::add_hessian(const VectorX& x, const Conditions& c, Projection, BlockMatrix& hessian) const {
  const double p = factor(c);
  if (p == 0) return;
  for (Index facet = 0; facet < facets_.num_cells(); ++facet)
    add_facet_hessian(facets_.cell(facet), x, p, hessian);
}

void Pressure::add_facet_hessian(std::span<const Index> nodes, const VectorX& x, double p,
                                 BlockMatrix& hessian) const {
  const std::size_t count = nodes.size();
  std::array<Eigen::Matrix3d, max_facet_nodes * max_facet_nodes> blocks;
  blocks.fill(Eigen::Matrix3d::Zero());
  for (const FacetPoint& point : points_) {
    const auto slopes = area_vector_slopes(dim_, point, nodes, x);
    // Force on a from the area vector's change with x_b, symmetrised with the one on b from x_a.
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a; b < count; ++b)
        blocks[a * count + b] +=
            0.5 * p * point.weight * (point.values[a] * slopes[b] + point.values[b] * slopes[a].transpose());
  }
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a; b < count; ++b) {
      std::array<double, 9> values{};
      for (int i = 0; i < dim_; ++i)
        for (int j = 0; j < dim_; ++j)
          values[static_cast<std::size_t>(i * dim_ + j)] = blocks[a * count + b](i, j);
      hessian.add_block(nodes[a], nodes[b], values.data());
    }
}

}  // namespace resilin
