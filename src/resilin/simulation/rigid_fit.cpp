#include "resilin/simulation/rigid_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

VectorX summed(const ProcessGroup& share, VectorX values) {
  share.sum(std::span(values.data(), static_cast<std::size_t>(values.size())));
  return values;
}

/// So that all processes go on from the same bits.
VectorX of_first_process(const ProcessGroup& share, VectorX values) {
  if (!share.is_first()) values.setZero();
  return summed(share, std::move(values));
}

}  // namespace

Eigen::MatrixXd nearest_rotation(const Eigen::MatrixXd& A) {
  if (A.rows() == 2) return Eigen::Rotation2Dd(std::atan2(A(1, 0) - A(0, 1), A(0, 0) + A(1, 1))).matrix();
  // Horn 1987: the quaternion is the eigenvector of the largest eigenvalue.
  Eigen::MatrixXd N(4, 4);
  N.bottomRightCorner(3, 3) = A + A.transpose() - A.trace() * Eigen::MatrixXd::Identity(3, 3);
  N(0, 0) = A.trace();
  N(1, 0) = N(0, 1) = A(2, 1) - A(1, 2);
  N(2, 0) = N(0, 2) = A(0, 2) - A(2, 0);
  N(3, 0) = N(0, 3) = A(1, 0) - A(0, 1);
  const VectorX q = dense::symmetric_eigenpairs(N).vectors.col(3);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

bool is_free(const World& world, const Body& body, std::span<const std::uint8_t> is_fixed) {
  const Eigen::Index dim = world.dimension;
  bool is_held = false;
  for (Index node = body.first_node; node < body.first_node + body.num_nodes && !is_held; ++node) {
    if (!(world.mass->nodal[node] > 0)) continue;
    const auto unknowns =
        is_fixed.subspan(static_cast<std::size_t>(node * dim), static_cast<std::size_t>(dim));
    is_held = std::ranges::any_of(unknowns, [](std::uint8_t fixed) { return fixed != 0; });
  }
  return !world.share.any(is_held);
}

VectorX rigidly_fitted(const World& world, std::span<const std::uint8_t> is_fixed, const VectorX& shape,
                       const VectorX& target, const VectorX& x) {
  const Eigen::Index dim = world.dimension;
  VectorX fitted = x;
  VectorX held = shape, wanted = target;  // about each body's centre of mass
  VectorX ones = VectorX::Ones(x.size()), weights;
  world.mass->multiply(ones, weights);  // a uniform motion's share of momentum, node by node
  const auto block = [dim](auto&& values, const Body& body) {
    return values.segment(body.first_node * dim, body.num_nodes * dim).reshaped(dim, body.num_nodes);
  };
  for (const Body& body : world.bodies)
    for (VectorX* places : {&held, &wanted}) {
      auto nodes = block(*places, body);
      const VectorX first = of_first_process(world.share, nodes.col(0));
      nodes.colwise() -= first;
      const VectorX moment = summed(world.share, nodes.cwiseProduct(block(weights, body)).rowwise().sum());
      const VectorX center = moment / world.share.sum(block(weights, body).row(0).sum());
      nodes.colwise() -= center;
    }
  VectorX momenta;
  world.mass->multiply(wanted, momenta);
  for (const Body& body : world.bodies) {
    if (!is_free(world, body, is_fixed)) continue;
    Eigen::MatrixXd A = block(momenta, body) * block(held, body).transpose();
    world.share.sum(std::span(A.data(), static_cast<std::size_t>(A.size())));
    const Eigen::MatrixXd turned = nearest_rotation(A) * block(held, body);
    const VectorX center =
        of_first_process(world.share, block(target, body).col(0) - block(wanted, body).col(0));
    block(fitted, body) = turned.colwise() + center;
  }
  return fitted;
}

}  // namespace resilin
