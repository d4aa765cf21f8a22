#include "resilin/energy/motor.hpp"

#include <cmath>
#include <utility>

namespace resilin {

double MotorGoal::at(const Conditions& c) const {
  double goal = position == 0 ? 0 : position * function.factor(c.time, c.load);
  if (velocity != 0) goal += velocity * function.integral(c.time);
  return goal;
}

Motor::Motor(std::string name, int dim, Arms arms, double radius, double stiffness, MotorGoal goal)
    : name_(std::move(name)),
      dim_(dim),
      arms_(std::move(arms)),
      factor_(stiffness / (radius * radius)),
      goal_(std::move(goal)) {}

CarriedPoint Motor::gap_at(const Conditions& c) const {
  const double a = goal_.at(c), along = std::cos(a), across = std::sin(a);
  CarriedPoint sum;
  const auto add = [&sum](const CarriedPoint& point, double share) {
    for (const auto& [node, weight] : point.nodes) sum.nodes.push_back({node, share * weight});
    if (point.nodes.empty()) sum.place += share * point.place;
  };
  add(arms_.turned, 1);
  add(arms_.centre, along + across - 1);
  add(arms_.along, -along);
  add(arms_.across, -across);
  return sum;
}

double Motor::value(const VectorX& x, const Conditions& c) const {
  return 0.5 * factor_ * gap_at(c).at(dim_, x).squaredNorm();
}

double Motor::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const CarriedPoint of = gap_at(c);
  Vector3 way = Vector3::Zero();
  for (const auto& [node, weight] : of.nodes)
    way += weight * (node_position(dim_, node, to) - node_position(dim_, node, from));
  return 0.5 * factor_ * way.dot(of.at(dim_, from) + of.at(dim_, to));
}

void Motor::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const CarriedPoint of = gap_at(c);
  const Vector3 force = factor_ * of.at(dim_, x);
  for (const auto& [node, weight] : of.nodes)
    gradient.segment(Eigen::Index{node} * dim_, dim_) += weight * force.head(dim_);
}

void Motor::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const CarriedPoint of = gap_at(c);
  Vector3 parts = of.place.cwiseAbs();
  for (const auto& [node, weight] : of.nodes)
    parts += std::abs(weight) * node_position(dim_, node, x).cwiseAbs();
  for (const auto& [node, weight] : of.nodes)
    magnitude.segment(Eigen::Index{node} * dim_, dim_) += factor_ * std::abs(weight) * parts.head(dim_);
}

void Motor::add_hessian(const VectorX&, const Conditions& c, Projection, BlockMatrix& hessian) const {
  const CarriedPoint of = gap_at(c);
  for (const auto& [row, row_weight] : of.nodes)
    for (const auto& [column, column_weight] : of.nodes) {
      if (column < row) continue;
      using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
      const Block block = factor_ * row_weight * column_weight * Block::Identity(dim_, dim_);
      hessian.add_block(row, column, block.data());
    }
}

void Motor::add_pattern(BlockPatternBuilder& builder) const {
  std::vector<Index> nodes;
  for (const WeightedNode& each : gap_at({}).nodes) nodes.push_back(each.node);
  builder.add_clique(nodes);
}

std::optional<double> Motor::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                         const Conditions& after) const {
  if (!goal_.moves(before, after)) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

}  // namespace resilin
