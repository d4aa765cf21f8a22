#include "resilin/energy/motor.hpp"

#include <cmath>
#include <utility>

namespace resilin {

double MotorGoal::at(const Conditions& c) const {
  double goal = position == 0 ? 0 : position * function.factor(c.time, c.load);
  if (velocity != 0) goal += velocity * function.integral(c.time);
  return goal;
}

double MotorGoal::at_by(std::string_view parameter, const Conditions& c) const {
  return parameter == "position" ? function.factor(c.time, c.load) : function.integral(c.time);
}

Motor::Motor(std::string name, int dim, Arms arms, double radius, double stiffness, MotorGoal goal)
    : name_(std::move(name)),
      dim_(dim),
      arms_(std::move(arms)),
      factor_(stiffness / (radius * radius)),
      goal_(std::move(goal)) {}

CarriedPoint Motor::gap_at(const Conditions& c) const {
  const double a = goal_.at(c);
  return sum_of(1, std::cos(a) + std::sin(a) - 1, -std::cos(a), -std::sin(a));
}

CarriedPoint Motor::gap_by_angle(const Conditions& c) const {
  const double a = goal_.at(c);
  return sum_of(0, std::cos(a) - std::sin(a), std::sin(a), -std::cos(a));
}

CarriedPoint Motor::sum_of(double turned, double centre, double along, double across) const {
  CarriedPoint sum;
  const auto add = [&sum](const CarriedPoint& point, double share) {
    for (const auto& [node, weight] : point.nodes) sum.nodes.push_back({node, share * weight});
    if (point.nodes.empty()) sum.place += share * point.place;
  };
  add(arms_.turned, turned);
  add(arms_.centre, centre);
  add(arms_.along, along);
  add(arms_.across, across);
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

namespace {

Vector3 sum_over_nodes(const CarriedPoint& point, int dim, const VectorX& values) {
  Vector3 sum = Vector3::Zero();
  for (const auto& [node, weight] : point.nodes) sum += weight * node_position(dim, node, values);
  return sum;
}

}  // namespace

// E = k/(2 r^2) |W x + s|^2:   d2E/(dx da) = k/r^2 (W'^T (W x + s) + W^T (W' x + s'))
void Motor::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                 const Conditions& c, VectorX& slopes) const {
  const CarriedPoint of = gap_at(c), by_angle = gap_by_angle(c);
  slopes[0] += goal_.at_by(name, c) * factor_ *
               (sum_over_nodes(by_angle, dim_, w).dot(of.at(dim_, x)) +
                sum_over_nodes(of, dim_, w).dot(by_angle.at(dim_, x)));
}

void Motor::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                 const Conditions& c, VectorX& gradient) const {
  const CarriedPoint of = gap_at(c), by_angle = gap_by_angle(c);
  const double factor = change[0] * goal_.at_by(name, c) * factor_;
  const auto add = [&](const CarriedPoint& point, const Vector3& force) {
    for (const auto& [node, weight] : point.nodes)
      gradient.segment(Eigen::Index{node} * dim_, dim_) += weight * force.head(dim_);
  };
  add(by_angle, factor * of.at(dim_, x));
  add(of, factor * by_angle.at(dim_, x));
}

std::optional<double> Motor::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                         const Conditions& after) const {
  if (!goal_.moves(before, after)) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

}  // namespace resilin
