#include "resilin/energy/pressure.hpp"

#include <array>

namespace resilin {
namespace {

/// d(area vector)/d(position of the facet's node a), row-major dim x dim.
///
/// 3D: N = 1/2 (x1 - x0) x (x2 - x0), so dN = 1/2 e_a x^T dx_a with e_a the edge opposite to node a, cyclic.
/// 2D: N = (y1 - y0, -(x1 - x0)).
Eigen::Matrix3d area_vector_slope(int dim, const LoadedFacet& facet, int a, const VectorX& x) {
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  if (dim == 2) {
    const double sign = a == 0 ? -1 : 1;
    slope(0, 1) = sign;
    slope(1, 0) = -sign;
    return slope;
  }
  const auto corner = [&](int k) {
    return node_position(dim, facet.nodes[static_cast<std::size_t>((a + k) % 3)], x);
  };
  const Vector3 e = 0.5 * (corner(2) - corner(1));  // dN = e x dx_a
  slope << 0, -e.z(), e.y(), e.z(), 0, -e.x(), -e.y(), e.x(), 0;
  return slope;
}

}  // namespace

Pressure::Pressure(std::string name, int dim, std::vector<LoadedFacet> facets, double pressure,
                   VectorX rest_positions, ActiveTime active)
    : name_(std::move(name)),
      dim_(dim),
      facets_(std::move(facets)),
      pressure_(pressure),
      rest_positions_(std::move(rest_positions)),
      active_(std::move(active)) {}

double Pressure::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const double p = factor(c);
  if (p == 0) return 0;
  const VectorX middle = 0.5 * (from + to);
  double work = 0;
  for (const LoadedFacet& facet : facets_) {
    const Vector3 mean_area = (area_vector(dim_, facet, from) + 4 * area_vector(dim_, facet, middle) +
                               area_vector(dim_, facet, to)) /
                              6;
    Vector3 mean_motion = Vector3::Zero();
    for (int a = 0; a < dim_; ++a) {
      const Index node = facet.nodes[static_cast<std::size_t>(a)];
      mean_motion += (node_position(dim_, node, to) - node_position(dim_, node, from)) / dim_;
    }
    work += mean_area.dot(mean_motion);
  }
  return p * work;
}

void Pressure::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const double p = factor(c);
  if (p == 0) return;
  for (const LoadedFacet& facet : facets_) {
    const Vector3 share = p / dim_ * area_vector(dim_, facet, x);
    for (int a = 0; a < dim_; ++a) {
      gradient.segment(Eigen::Index{facet.nodes[static_cast<std::size_t>(a)]} * dim_, dim_) +=
          share.head(dim_);
    }
  }
}

void Pressure::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double p = std::abs(factor(c));
  for (const LoadedFacet& facet : facets_) {
    const Vector3 share = p / dim_ * area_vector(dim_, facet, x).cwiseAbs();
    for (int a = 0; a < dim_; ++a) {
      magnitude.segment(Eigen::Index{facet.nodes[static_cast<std::size_t>(a)]} * dim_, dim_) +=
          share.head(dim_);
    }
  }
}

void Pressure::add_pattern(BlockPatternBuilder& builder) const {
  for (const LoadedFacet& facet : facets_) {
    for (int a = 0; a < dim_; ++a) {
      for (int b = a + 1; b < dim_; ++b) {
        builder.add_pair(facet.nodes[static_cast<std::size_t>(a)], facet.nodes[static_cast<std::size_t>(b)]);
      }
    }
  }
}

void Pressure::add_hessian(const VectorX& x, const Conditions& c, Projection, BlockMatrix& hessian) const {
  const double p = factor(c);
  if (p == 0) return;
  for (const LoadedFacet& facet : facets_) {
    std::array<Eigen::Matrix3d, 3> slopes;
    for (int a = 0; a < dim_; ++a) slopes[static_cast<std::size_t>(a)] = area_vector_slope(dim_, facet, a, x);
    for (int a = 0; a < dim_; ++a) {
      for (int b = a; b < dim_; ++b) {
        // Force on a from the area vector's change with x_b, symmetrised with the one on b from x_a.
        const Eigen::Matrix3d block =
            0.5 * p / dim_ *
            (slopes[static_cast<std::size_t>(b)] + slopes[static_cast<std::size_t>(a)].transpose());
        std::array<double, 9> values{};
        for (int i = 0; i < dim_; ++i) {
          for (int j = 0; j < dim_; ++j) values[static_cast<std::size_t>(i * dim_ + j)] = block(i, j);
        }
        hessian.add_block(facet.nodes[static_cast<std::size_t>(a)], facet.nodes[static_cast<std::size_t>(b)],
                          values.data());
      }
    }
  }
}

}  // namespace resilin
