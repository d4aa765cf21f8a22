#include "resilin/mesh/winding_number.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "resilin/mesh/quality.hpp"

namespace resilin {
namespace {

constexpr Index leaf_size = 8;
constexpr double far = 1.5;  // radii from the centre: from there on a node is taken as a whole
constexpr std::size_t max_depth = 64;

/// Sum of angles of the plane by their product as complex numbers, so that one arc tangent is enough for
/// many.
class AngleSum {
 public:
  /// Adds the angle of x + i y, which is in [-pi, pi].
  void add(double x, double y) {
    const double scale = std::abs(x) + std::abs(y);
    if (!(scale > 0)) return;
    x /= scale;
    y /= scale;
    const double product_x = x_ * x - y_ * y, product_y = x_ * y + y_ * x;
    // Two angles of one sign whose sum has the other one have passed pi.
    if (y_ >= 0 && y >= 0 && product_y < 0) ++turns_;
    if (y_ < 0 && y < 0 && product_y >= 0) --turns_;
    x_ = product_x;
    y_ = product_y;
  }
  double value() const { return std::atan2(y_, x_) + 2 * std::numbers::pi * turns_; }

 private:
  double x_ = 1, y_ = 0;
  int turns_ = 0;
};

/// Adds half the solid angle. Source: Van Oosterom & Strackee 1983, "The solid angle of a plane triangle",
/// eq. 8.
void add_half_solid_angle(const std::array<Vector3, 3>& corners, const Vector3& X, AngleSum& sum) {
  const Vector3 a = corners[0] - X, b = corners[1] - X, c = corners[2] - X;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double divisor = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  sum.add(divisor, a.dot(b.cross(c)));
}

}  // namespace

WindingNumber::WindingNumber(const Mesh& mesh, const CellBlock& triangles) {
  std::vector<Vector3> middles;
  std::vector<Index> order(static_cast<std::size_t>(triangles.num_cells()));
  std::iota(order.begin(), order.end(), Index{0});
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(triangles.cell(t)[i])];
    };
    corners_.push_back({X(0), X(1), X(2)});
    middles.emplace_back((X(0) + X(1) + X(2)) / 3);
  }
  if (order.empty()) return;
  nodes_.push_back({.first = 0, .last = triangles.num_cells()});
  build(0, order, {middles, triangle_area_vectors(mesh, triangles)});
  std::vector<std::array<Vector3, 3>> sorted;
  for (const Index t : order) sorted.push_back(corners_[static_cast<std::size_t>(t)]);
  corners_ = std::move(sorted);
}

/// Over a triangle of area A with middle m: integral of s = A m, of s s^T = A/12 (sum_corners s s^T + 9 m
/// m^T).
void WindingNumber::add_moments(Node& node, const std::array<Vector3, 3>& corners, const Vector3& area) {
  const Vector3 m = (corners[0] + corners[1] + corners[2]) / 3 - node.center;
  node.first_moment += 0.5 * (area * m.transpose() + m * area.transpose());
  Matrix<3> S = 9 * m * m.transpose();
  for (const Vector3& X : corners) S += (X - node.center) * (X - node.center).transpose();
  S /= 12;
  const Vector3& n = area;
  const std::array<double, 10> form = {n.x() * S(0, 0),
                                       2 * n.x() * S(0, 1) + n.y() * S(0, 0),
                                       2 * n.x() * S(0, 2) + n.z() * S(0, 0),
                                       n.x() * S(1, 1) + 2 * n.y() * S(0, 1),
                                       2 * (n.x() * S(1, 2) + n.y() * S(0, 2) + n.z() * S(0, 1)),
                                       n.x() * S(2, 2) + 2 * n.z() * S(0, 2),
                                       n.y() * S(1, 1),
                                       2 * n.y() * S(1, 2) + n.z() * S(1, 1),
                                       n.y() * S(2, 2) + 2 * n.z() * S(1, 2),
                                       n.z() * S(2, 2)};
  for (std::size_t i = 0; i < form.size(); ++i) node.second_moment[i] += form[i];
  node.contracted += 2 * S * n + S.trace() * n;
}

/// Solid angle of the triangles of a node whose center is at R from the point: the Taylor series in s of
/// n . (R + s) / |R + s|^3.
double WindingNumber::far_angle(const Node& node, const Vector3& R, double square) {
  const double x = R.x(), y = R.y(), z = R.z(), q = 1 / square;
  const auto& c = node.second_moment;
  const double form = x * (x * (c[0] * x + c[1] * y + c[2] * z) + y * (c[3] * y + c[4] * z) + c[5] * z * z) +
                      y * (y * (c[6] * y + c[7] * z) + c[8] * z * z) + c[9] * z * z * z;
  const double zeroth = node.dipole.dot(R);
  const double first = node.first_moment.trace() - 3 * q * R.dot(node.first_moment * R);
  const double second = 1.5 * q * (5 * q * form - node.contracted.dot(R));
  return q * std::sqrt(q) * (zeroth + first + second);
}

void WindingNumber::build(Index node, std::vector<Index>& order, const Triangles& triangles) {
  Node made = nodes_[static_cast<std::size_t>(node)];
  const auto begin = order.begin() + made.first, end = order.begin() + made.last;
  const auto middle = [&](Index t) -> const Vector3& {
    return triangles.middles[static_cast<std::size_t>(t)];
  };
  double area = 0;
  Vector3 sum = Vector3::Zero(), low = middle(*begin), high = low;
  for (auto t = begin; t != end; ++t) {
    const Vector3& vector = triangles.areas[static_cast<std::size_t>(*t)];
    made.dipole += vector;
    area += vector.norm();
    sum += vector.norm() * middle(*t);
    low = low.cwiseMin(middle(*t));
    high = high.cwiseMax(middle(*t));
  }
  made.center = area > 0 ? Vector3(sum / area) : Vector3(0.5 * (low + high));
  for (auto t = begin; t != end; ++t)
    for (const Vector3& X : corners_[static_cast<std::size_t>(*t)])
      made.radius = std::max(made.radius, (X - made.center).norm());
  for (auto t = begin; t != end; ++t)
    add_moments(made, corners_[static_cast<std::size_t>(*t)], triangles.areas[static_cast<std::size_t>(*t)]);
  if (made.last - made.first > leaf_size) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const Index half = (made.first + made.last) / 2;
    std::nth_element(begin, order.begin() + half, end, [&](Index a, Index b) {
      return middle(a)[axis] != middle(b)[axis] ? middle(a)[axis] < middle(b)[axis] : a < b;
    });
    made.left = static_cast<Index>(nodes_.size());
    nodes_.push_back({.first = made.first, .last = half});
    nodes_.push_back({.first = half, .last = made.last});
  }
  nodes_[static_cast<std::size_t>(node)] = made;
  if (made.left < 0) return;
  build(made.left, order, triangles);
  build(made.left + 1, order, triangles);
}

double WindingNumber::operator()(const Vector3& X) const {
  std::array<Index, max_depth> stack;
  std::size_t size = 0;
  if (!nodes_.empty()) stack[size++] = 0;
  double angle = 0;
  while (size > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
    const Vector3 arm = node.center - X;
    const double square = arm.squaredNorm();
    if (square > far * far * node.radius * node.radius) {
      angle += far_angle(node, arm, square);
    } else if (node.left < 0) {
      AngleSum half;
      for (Index t = node.first; t < node.last; ++t)
        add_half_solid_angle(corners_[static_cast<std::size_t>(t)], X, half);
      angle += 2 * half.value();
    } else {
      stack[size++] = node.left + 1;
      stack[size++] = node.left;
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace resilin
