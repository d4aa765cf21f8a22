#include "resilin/core/orientation.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace resilin {
namespace {

constexpr double unit_round_off = std::numeric_limits<double>::epsilon() / 2;
/// Of the sum of the |products|, beyond which a rounded determinant has its true sign: twice what a count of
/// its roundings allows.
constexpr double bound_2d = 8 * unit_round_off, bound_3d = 20 * unit_round_off;

int sign(double value) { return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0); }

/// A number as the exact sum of doubles that do not overlap, the least first.
class Expansion {
 public:
  /// a - b.
  static Expansion difference(double a, double b) {
    Expansion e;
    e.add(a);
    e.add(-b);
    return e;
  }

  Expansion& operator+=(const Expansion& other) {
    for (const double part : other.parts_) add(part);
    return *this;
  }
  Expansion operator-() const {
    Expansion e = *this;
    for (double& part : e.parts_) part = -part;
    return e;
  }
  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion product;
    for (const double x : a.parts_)
      for (const double y : b.parts_) {
        const double high = x * y;
        product.add(std::fma(x, y, -high));
        product.add(high);
      }
    return product;
  }
  int sign() const { return parts_.empty() ? 0 : resilin::sign(parts_.back()); }

 private:
  /// Adds one double; what is left over in each sum is kept, zeros are not.
  void add(double value) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const double sum = value + part, part_used = sum - value;
      const double rest = (value - (sum - part_used)) + (part - part_used);
      if (rest != 0) parts_[kept++] = rest;
      value = sum;
    }
    parts_.resize(kept);
    if (value != 0) parts_.push_back(value);
  }
  std::vector<double> parts_;
};

template <int dim>
std::array<Expansion, dim> exact_difference(const Eigen::Matrix<double, dim, 1>& to,
                                            const Eigen::Matrix<double, dim, 1>& from) {
  std::array<Expansion, dim> difference;
  for (int k = 0; k < dim; ++k)
    difference[static_cast<std::size_t>(k)] = Expansion::difference(to[k], from[k]);
  return difference;
}

}  // namespace

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  const double left = u.x() * v.y(), right = u.y() * v.x();
  if (std::abs(left - right) > bound_2d * (std::abs(left) + std::abs(right))) return sign(left - right);
  const auto p = exact_difference<2>(b, a), q = exact_difference<2>(c, a);
  Expansion determinant = p[0] * q[1];
  determinant += -(p[1] * q[0]);
  return determinant.sign();
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
  Expansion exact;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    Expansion minor = q[i] * r[j];
    minor += -(q[j] * r[i]);
    exact += p[k] * minor;
  }
  return exact.sign();
}

}  // namespace resilin
