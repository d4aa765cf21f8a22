#include "resilin/energy/handle_spring.hpp"

namespace resilin {

HandleSpring::HandleSpring(std::string name, int dim, std::vector<Index> nodes, double stiffness,
                           Motion motion, VectorX rest_positions, ActiveTime active)
    : name_(std::move(name)),
      dim_(dim),
      nodes_(std::move(nodes)),
      stiffness_(stiffness),
      motion_(std::move(motion)),
      rest_positions_(std::move(rest_positions)),
      active_(std::move(active)) {}

Vector3 HandleSpring::stretch(Index node, const VectorX& x, const Conditions& c) const {
  const Vector3 far_end = node_position(dim_, node, rest_positions_) +
                          active_.function.factor(c.time, c.load) * motion_.displacement +
                          (c.time - motion_.start) * motion_.velocity;
  return node_position(dim_, node, x) - far_end;
}

std::optional<double> HandleSpring::driven_work(const VectorX& from, const Conditions& before,
                                                const VectorX& to, const Conditions& after) const {
  if (active_.is_always() && motion_.velocity.isZero(0)) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

double HandleSpring::value(const VectorX& x, const Conditions& c) const {
  if (!active_.contains(c.time)) return 0;
  double sum = 0;
  for (const Index node : nodes_) sum += stretch(node, x, c).squaredNorm();
  return 0.5 * stiffness_ * sum;
}

double HandleSpring::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  if (!active_.contains(c.time)) return 0;
  double sum = 0;
  for (const Index node : nodes_) {
    const Vector3 motion = node_position(dim_, node, to) - node_position(dim_, node, from);
    sum += motion.dot(stretch(node, to, c) + stretch(node, from, c));
  }
  return 0.5 * stiffness_ * sum;
}

void HandleSpring::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  if (!active_.contains(c.time)) return;
  for (const Index node : nodes_) {
    gradient.segment(Eigen::Index{node} * dim_, dim_) += stiffness_ * stretch(node, x, c).head(dim_);
  }
}

void HandleSpring::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  if (!active_.contains(c.time)) return;
  for (const Index node : nodes_) {
    magnitude.segment(Eigen::Index{node} * dim_, dim_) +=
        stiffness_ * stretch(node, x, c).head(dim_).cwiseAbs();
  }
}

void HandleSpring::add_hessian(const VectorX&, const Conditions& c, Projection, BlockMatrix& hessian) const {
  if (!active_.contains(c.time)) return;
  for (const Index node : nodes_) {
    for (int k = 0; k < dim_; ++k) hessian.add_to_diagonal(node, k, stiffness_);
  }
}

void HandleSpring::add_held_directions(const VectorX&, std::vector<HeldDirection>& held) const {
  if (!(stiffness_ > 0)) return;
  for (const Index node : nodes_)
    for (int k = 0; k < dim_; ++k) held.push_back({{{node, 1}}, Vector3::Unit(k)});
}

void HandleSpring::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                        const Conditions& c, VectorX& slopes) const {
  if (!active_.contains(c.time)) return;
  for (const Index node : nodes_) {
    const Vector3 w_a = node_position(dim_, node, w);
    if (name == "stiffness")
      slopes[0] += w_a.dot(stretch(node, x, c));
    else if (name == "rest_positions")
      slopes.segment(Eigen::Index{node} * dim_, dim_) -= stiffness_ * w_a.head(dim_);
    else
      slopes -= stiffness_ * slope_of_end(name, c) * w_a.head(dim_);
  }
}

void HandleSpring::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                        const Conditions& c, VectorX& gradient) const {
  if (!active_.contains(c.time)) return;
  for (const Index node : nodes_) {
    auto force = gradient.segment(Eigen::Index{node} * dim_, dim_);
    if (name == "stiffness")
      force += change[0] * stretch(node, x, c).head(dim_);
    else if (name == "rest_positions")
      force -= stiffness_ * change.segment(Eigen::Index{node} * dim_, dim_);
    else
      force -= stiffness_ * slope_of_end(name, c) * change;
  }
}

}  // namespace resilin
