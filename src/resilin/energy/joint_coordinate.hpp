#pragma once

#include <array>
#include <vector>

#include "resilin/energy/cable.hpp"

namespace resilin {

/// A coordinate q of a joint, a smooth function of vectors y that are linear in the positions:
///
///   travel   q = y_0 . y_1                        way from one point to another along a carried direction
///   angle    q = atan2(y_0 . y_2, y_0 . y_1)      from y_1 on towards y_2, in (-pi, pi]
class JointCoordinate {
 public:
  static constexpr int max_size = 9;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_size, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_size, max_size>;

  static JointCoordinate travel(int dim, const CarriedPoint& way, const CarriedPoint& direction);
  static JointCoordinate angle(int dim, const CarriedPoint& turned, const CarriedPoint& along,
                               const CarriedPoint& across);

  bool is_angle() const { return is_angle_; }
  double value(const VectorX& x) const { return value_of(vectors(x)); }
  /// q(to) - q(from) with its digits, an angle in (-pi, pi].
  double change(const VectorX& from, const VectorX& to) const;
  /// dq/dy, three numbers for each vector.
  Vector slopes(const VectorX& x) const { return slopes_of(vectors(x)); }
  /// d2q/dy2.
  Square curvatures(const VectorX& x) const;
  /// The sum over the numbers of y of |dq/dy| times the sum of the |parts| that each is made of: the scale of
  /// the round-off of q.
  double magnitude(const VectorX& x) const;
  /// dq/dx . v
  double rate(const VectorX& x, const VectorX& v) const;
  /// (dq/dx at `shape`) . (to - from)
  double rate(const VectorX& shape, const VectorX& from, const VectorX& to) const;

  // Numbers of y, given to the nodes.

  /// gradient += dy/dx^T f
  void add_forces(const Vector& f, VectorX& gradient) const;
  /// magnitude += |dy/dx|^T |f|
  void add_magnitudes(const Vector& f, VectorX& magnitude) const;
  /// hessian += dy/dx^T K dy/dx
  void add_blocks(const Square& K, BlockMatrix& hessian) const;
  void add_pattern(BlockPatternBuilder& builder) const { builder.add_clique(nodes_); }

 private:
  using Vectors = std::array<Vector3, 3>;

  JointCoordinate(int dim, bool is_angle, const std::vector<CarriedPoint>& vectors);
  Eigen::Index size() const { return is_angle_ ? 9 : 6; }
  std::size_t num_vectors() const { return is_angle_ ? 3 : 2; }
  Vectors vectors(const VectorX& x) const;
  /// Changes of y between two states: without the ground.
  Vectors changes(const VectorX& from, const VectorX& to) const;
  double value_of(const Vectors& y) const;
  Vector slopes_of(const Vectors& y) const;

  int dim_;
  bool is_angle_;
  std::array<Vector3, 3> places_{};  ///< parts of the ground
  std::vector<Index> nodes_;         ///< each once
  std::vector<Vector3> weights_;     ///< by node: its weight in each vector
};

/// The vector from one point to another, over a length.
CarriedPoint vector_between(const CarriedPoint& from, const CarriedPoint& to, double length = 1);

}  // namespace resilin
