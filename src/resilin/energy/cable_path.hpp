#pragma once

#include <span>
#include <vector>

#include "resilin/energy/dead_load.hpp"

namespace resilin {

/// A point that nodes carry, or one of the ground.
struct CarriedPoint {
  std::vector<WeightedNode> nodes{};  ///< weights sum to one; empty: the ground
  Vector3 place = Vector3::Zero();    ///< place on the ground, zero for a point that nodes carry [m]

  /// The place plus the weighted sum of node positions [m].
  Vector3 at(int dim, const VectorX& x) const;
};

/// A polygon through points, with the derivatives of the lengths l_i of its pieces. A piece without length
/// has none.
class CablePath {
 public:
  CablePath(int dim, std::vector<CarriedPoint> points) : dim_(dim), points_(std::move(points)) {}

  int dim() const { return dim_; }
  const std::vector<CarriedPoint>& points() const { return points_; }
  std::size_t num_pieces() const { return points_.size() - 1; }
  double length(const VectorX& x) const;
  /// l_i(to) - l_i(from), with their digits where the two are close [m].
  std::vector<double> lengthening(const VectorX& from, const VectorX& to) const;
  /// dl_i/dx . way [m].
  std::vector<double> first_order_lengthening(const VectorX& x, const VectorX& way) const;
  /// Angles between pieces, at all points but the ends [rad].
  std::vector<double> turns(const VectorX& x) const;

  /// sum_i factor_i dl_i/dp at each point p.
  std::vector<Vector3> pulls(const VectorX& x, std::span<const double> factors) const;
  /// gradient += sum_i factor_i dl_i/dx.
  void add_slopes(const VectorX& x, std::span<const double> factors, VectorX& gradient) const;
  /// magnitude += sum_i |factor_i| |dl_i/dx|.
  void add_slope_magnitudes(const VectorX& x, std::span<const double> factors, VectorX& magnitude) const;
  /// hessian += sum_i factor_i d2l_i/dx2.
  void add_curvatures(const VectorX& x, std::span<const double> factors, BlockMatrix& hessian) const;
  /// hessian += factor g g^T,   g = sum_i weight_i dl_i/dx.
  void add_square(const VectorX& x, std::span<const double> weights, double factor,
                  BlockMatrix& hessian) const;
  /// hessian += the block times both weights at all pairs of nodes of points i and j.
  void add_blocks(std::size_t i, std::size_t j, const Matrix<3>& block, BlockMatrix& hessian) const;
  void add_pattern(BlockPatternBuilder& builder) const;

 private:
  /// The vectors of the pieces.
  std::vector<Vector3> pieces(const VectorX& x) const;

  int dim_;
  std::vector<CarriedPoint> points_;
};

}  // namespace resilin
