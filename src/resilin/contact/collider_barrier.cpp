#include "resilin/contact/collider_barrier.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resilin/core/dense.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Of the distance, that a step may use up.
constexpr double largest_loss = 0.9;

/// The symmetric matrix with its negative eigenvalues dealt with as asked.
Eigen::Matrix3d projected(const Eigen::Matrix3d& matrix, Projection projection) {
  if (projection == Projection::none || matrix.isZero(0)) return matrix;
  const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(matrix);
  Vector3 values = eigen.values;
  for (double& value : values)
    if (value < 0) value = projection == Projection::clamp ? 0 : -value;
  return eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

ColliderBarrier::ColliderBarrier(std::string name, int dim, std::shared_ptr<const ColliderShape> shape,
                                 std::vector<ContactNode> nodes, double activation_distance,
                                 ColliderMotion motion)
    : name_(std::move(name)),
      dim_(dim),
      shape_(std::move(shape)),
      nodes_(std::move(nodes)),
      barrier_{activation_distance},
      motion_(std::move(motion)) {}

void ColliderBarrier::set_shape(std::shared_ptr<const ColliderShape> shape) {
  shape_ = std::move(shape);
  offset_.setZero();
}

template <class Visit>
void ColliderBarrier::for_each_near(const VectorX& x, const Conditions& c, const Visit& visit) const {
  if (!is_active_) return;
  const Vector3 shift = displacement(c);
  for (const ContactNode& node : nodes_) {
    const Vector3 y = node_position(dim_, node.node, x) - shift;
    const double d = shape_->distance(y);
    if (!(d >= barrier_.activation_distance)) visit(node, y, d);
  }
}

double ColliderBarrier::value(const VectorX& x, const Conditions& c) const {
  double sum = 0;
  for_each_near(x, c, [&](const ContactNode& node, const Vector3&, double d) {
    sum += node.stiffness * barrier_.value(d);
  });
  return c.contact_weight * sum;
}

double ColliderBarrier::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  if (!is_active_) return 0;
  const Vector3 shift = displacement(c);
  double sum = 0;
  for (const ContactNode& node : nodes_) {
    const Vector3 y = node_position(dim_, node.node, from) - shift;
    const Vector3 end = node_position(dim_, node.node, to) - shift;
    const double d = shape_->distance(y), change = shape_->distance_change(y, end);
    if (d >= activation_distance() && d + change >= activation_distance()) continue;
    sum += node.stiffness * barrier_.difference(d, change);
  }
  return c.contact_weight * sum;
}

void ColliderBarrier::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  for_each_near(x, c, [&](const ContactNode& node, const Vector3& y, double d) {
    gradient.segment(Eigen::Index{node.node} * dim_, dim_) +=
        c.contact_weight * node.stiffness * barrier_.slope(d) * shape_->normal(y).head(dim_);
  });
}

void ColliderBarrier::add_gradient_magnitude(const VectorX& x, const Conditions& c,
                                             VectorX& magnitude) const {
  for_each_near(x, c, [&](const ContactNode& node, const Vector3& y, double d) {
    magnitude.segment(Eigen::Index{node.node} * dim_, dim_) -=
        c.contact_weight * node.stiffness * barrier_.slope(d) * shape_->normal(y).head(dim_).cwiseAbs();
  });
}

// d2/dx2 kappa A b(d(x)) = kappa A (b'' n n^T + b' Hess d); the first term is never negative.
void ColliderBarrier::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                                  BlockMatrix& hessian) const {
  for_each_near(x, c, [&](const ContactNode& node, const Vector3& y, double d) {
    const Vector3 n = shape_->normal(y);
    const Eigen::Matrix3d block = c.contact_weight * node.stiffness *
                                  (barrier_.curvature(d) * n * n.transpose() +
                                   projected(barrier_.slope(d) * shape_->curvature(y), projection));
    std::array<double, 9> values{};
    for (int i = 0; i < dim_; ++i)
      for (int j = 0; j < dim_; ++j) values[static_cast<std::size_t>(i * dim_ + j)] = block(i, j);
    hessian.add_block(node.node, node.node, values.data());
  });
}

double ColliderBarrier::max_step(const VectorX& x, const VectorX& p, const Conditions& c) const {
  if (!is_active_) return 1;
  const Vector3 shift = displacement(c);
  double step = 1;
  for (const ContactNode& node : nodes_) {
    const Vector3 y = node_position(dim_, node.node, x) - shift;
    const double left = (1 - largest_loss) * shape_->distance(y);
    step = std::min(step, shape_->time_of_approach(y, node_position(dim_, node.node, p), left));
  }
  return step;
}

std::optional<Reaction> ColliderBarrier::reaction(const VectorX& x, const Conditions& c) const {
  Reaction sum;
  for_each_near(x, c, [&](const ContactNode& node, const Vector3& y, double d) {
    const Vector3 force = -node.stiffness * barrier_.slope(d) * shape_->normal(y);
    sum.force += force;
    sum.torque += node_position(dim_, node.node, x).cross(force);
  });
  return sum;
}

void ColliderBarrier::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  for_each_near(x, {}, [&](const ContactNode& node, const Vector3& y, double) {
    held.push_back({node.node, shape_->normal(y)});
  });
}

ColliderBarrier::Nearest ColliderBarrier::nearest(const VectorX& x, const Conditions& c) const {
  const Vector3 shift = displacement(c);
  Nearest nearest;
  for (const ContactNode& node : nodes_) {
    const double d = shape_->distance(node_position(dim_, node.node, x) - shift);
    if (d < nearest.distance) nearest = {d, node.node};
  }
  return nearest;
}

double ColliderBarrier::largest_motion(const VectorX& x, const Vector3& motion, const Conditions& c,
                                       double share) const {
  if (!is_active_) return 1;
  const Vector3 shift = displacement(c);
  double part = 1;
  for (const ContactNode& node : nodes_) {
    const Vector3 y = node_position(dim_, node.node, x) - shift;
    const double left = std::min(share * activation_distance(), 0.5 * shape_->distance(y));
    part = std::min(part, shape_->time_of_approach(y, -motion, left));
  }
  return part;
}

std::optional<double> ColliderBarrier::driven_work(const VectorX& from, const Conditions& before,
                                                   const VectorX& to, const Conditions& after) const {
  const Vector3 way = displacement(after) - displacement(before);
  if (way.isZero(0)) return std::nullopt;
  const auto work = [&](const VectorX& x, const Conditions& c) {
    const std::optional<Reaction> pushed = reaction(x, c);
    return pushed ? pushed->force.dot(way) : 0.0;
  };
  return std::max({work(from, before), work(to, after), value(to, after) - value(to, before)});
}

double ColliderBarrier::least_delay(const VectorX& x, const Conditions& c) const {
  if (motion_.velocity.isZero(0)) return 0;
  const double reached = time_moved(c), wanted = time_moved({.time = c.time});
  const double part = largest_motion(x, (wanted - reached) * motion_.velocity, c);
  return part == 1 ? 0 : c.time - (reached + part * (wanted - reached));
}

}  // namespace resilin
