#include "resilin/core/orientation.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace resilin {
namespace {

constexpr double unit_round_off = std::numeric_limits<double>::epsilon() / 2;
/// Share of the sum of |products| beyond which a rounded determinant has its true sign: twice what a count of
/// its roundings allows.
constexpr double bound_2d = 8 * unit_round_off, bound_3d = 20 * unit_round_off;

int sign(double value) { return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0); }

/// A number as the exact sum of at most `capacity` doubles that do not overlap, the least first.
template <std::size_t capacity>
class Expansion {
 public:
  /// Adds one double; what is left over in each sum is kept, zeros are not.
  void add(double value) {
    std::size_t kept = 0;
    for (const double part : parts()) {
      const double sum = value + part, part_used = sum - value;
      const double rest = (value - (sum - part_used)) + (part - part_used);
      if (rest != 0) parts_[kept++] = rest;
      value = sum;
    }
    if (value != 0) parts_[kept++] = value;
    num_parts_ = kept;
  }
  template <std::size_t other_capacity>
  void add(const Expansion<other_capacity>& other) {
    for (const double part : other.parts()) add(part);
  }
  template <std::size_t other_capacity>
  void subtract(const Expansion<other_capacity>& other) {
    for (const double part : other.parts()) add(-part);
  }
  std::span<const double> parts() const { return {parts_.data(), num_parts_}; }
  int sign() const { return num_parts_ == 0 ? 0 : resilin::sign(parts_[num_parts_ - 1]); }

 private:
  std::array<double, capacity> parts_;
  std::size_t num_parts_ = 0;
};

using Difference = Expansion<2>;

template <std::size_t m, std::size_t n>
Expansion<2 * m * n> operator*(const Expansion<m>& a, const Expansion<n>& b) {
  Expansion<2 * m * n> product;
  for (const double x : a.parts())
    for (const double y : b.parts()) {
      const double high = x * y;
      product.add(std::fma(x, y, -high));
      product.add(high);
    }
  return product;
}

/// x v - y u.
Expansion<16> cross(const Difference& x, const Difference& y, const Difference& u, const Difference& v) {
  Expansion<16> sum;
  sum.add(x * v);
  sum.subtract(y * u);
  return sum;
}

template <int dim>
std::array<Difference, dim> exact_difference(const Eigen::Matrix<double, dim, 1>& to,
                                             const Eigen::Matrix<double, dim, 1>& from) {
  std::array<Difference, dim> difference;
  for (std::size_t k = 0; k < dim; ++k) {
    difference[k].add(to[static_cast<Eigen::Index>(k)]);
    difference[k].add(-from[static_cast<Eigen::Index>(k)]);
  }
  return difference;
}

}  // namespace

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  const double left = u.x() * v.y(), right = u.y() * v.x();
  if (std::abs(left - right) > bound_2d * (std::abs(left) + std::abs(right))) return sign(left - right);
  const auto p = exact_difference<2>(b, a), q = exact_difference<2>(c, a);
  return cross(p[0], p[1], q[0], q[1]).sign();
}

int orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 u = b - a, v = c - a, w = d - a;
  const double determinant = u.dot(v.cross(w));
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    size += std::abs(u[k]) * (std::abs(v[i] * w[j]) + std::abs(v[j] * w[i]));
  }
  if (std::abs(determinant) > bound_3d * size) return sign(determinant);
  const auto p = exact_difference<3>(b, a), q = exact_difference<3>(c, a), r = exact_difference<3>(d, a);
  Expansion<192> exact;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    exact.add(p[k] * cross(q[i], q[j], r[i], r[j]));
  }
  return exact.sign();
}

}  // namespace resilin
