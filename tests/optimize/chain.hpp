#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "resilin/optimize/objective.hpp"

namespace resilin::testing {

/// A chain of nodes in the plane with neo-Hookean-like springs between neighbours and a barrier at length
/// zero:
///   E = sum_i k/2 (l_i^2 - 1 - 2 ln l_i) - f.x,  l_i = |x_{i+1} - x_i|.
/// Its Hessian is indefinite where springs are pressed, as that of solids is.
class Chain final : public Objective {
 public:
  static constexpr double stiffness = 100;  ///< [N/m]

  Chain(Index num_nodes, VectorX force) : num_nodes_(num_nodes), force_(std::move(force)) {}

  std::shared_ptr<const BlockPattern> pattern() const {
    BlockPatternBuilder builder(num_nodes_);
    for (Index i = 0; i + 1 < num_nodes_; ++i) builder.add_pair(i, i + 1);
    return std::make_shared<BlockPattern>(builder.build());
  }

  double difference(const VectorX& from, const VectorX& to) const override {
    double sum = -force_.dot(to - from);
    for (Index i = 0; i + 1 < num_nodes_; ++i) sum += energy(span(to, i)) - energy(span(from, i));
    return sum;
  }
  double magnitude(const VectorX& x) const override {
    double sum = std::abs(force_.dot(x));
    for (Index i = 0; i + 1 < num_nodes_; ++i) sum += std::abs(energy(span(x, i)));
    return sum;
  }
  void gradient(const VectorX& x, VectorX& g) const override {
    g = -force_;
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const Eigen::Vector2d pull = stiffness * (1 - 1 / d.squaredNorm()) * d;
      g.segment<2>(2 * i) -= pull;
      g.segment<2>(2 * (i + 1)) += pull;
    }
  }
  void gradient_magnitude(const VectorX& x, VectorX& m) const override {
    m = force_.cwiseAbs();
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const Eigen::Vector2d pull = (stiffness * (1 + 1 / d.squaredNorm()) * d).cwiseAbs();
      m.segment<2>(2 * i) += pull;
      m.segment<2>(2 * (i + 1)) += pull;
    }
  }
  void hessian(const VectorX& x, Projection projection, BlockMatrix& H) const override {
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const double l2 = d.squaredNorm();
      const Eigen::Matrix2d along = d * d.transpose() / l2;
      const auto filter = [projection](double value) {
        if (projection == Projection::none) return value;
        return projection == Projection::clamp ? std::max(value, 0.0) : std::abs(value);
      };
      const Eigen::Matrix2d k = filter(stiffness * (1 + 1 / l2)) * along +
                                filter(stiffness * (1 - 1 / l2)) * (Eigen::Matrix2d::Identity() - along);
      const Eigen::Matrix2d minus = -k;
      H.add_block(i, i, k.data());
      H.add_block(i + 1, i + 1, k.data());
      H.add_block(i, i + 1, minus.data());
    }
  }
  double max_step(const VectorX&, const VectorX&) const override { return 1; }
  VectorX force_scales(const VectorX&, const VectorX& g, const ConnectedComponents& parts) const override {
    return VectorX::Constant(parts.count(), std::max(force_.norm(), g.head<2>().norm()));
  }
  VectorX distinct_acting_scales(const VectorX&, const VectorX&,
                                 const ConnectedComponents& parts) const override {
    return VectorX::Constant(parts.count(), force_.norm());
  }

 private:
  static double energy(const Eigen::Vector2d& d) {
    const double l2 = d.squaredNorm();
    return l2 > 0 ? 0.5 * stiffness * (l2 - 1 - std::log(l2)) : std::numeric_limits<double>::infinity();
  }
  Eigen::Vector2d span(const VectorX& x, Index i) const {
    return x.segment<2>(2 * (i + 1)) - x.segment<2>(2 * i);
  }

  Index num_nodes_;
  VectorX force_;
};

}  // namespace resilin::testing
