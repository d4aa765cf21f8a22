#include "resilin/energy/hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace resilin {

Hand::Hand(int dim, MaterialPoint place, Vector3 target, double stiffness, double max_force)
    : dim_(dim),
      place_(std::move(place)),
      target_(std::move(target)),
      stiffness_(stiffness),
      max_force_(max_force) {}

double Hand::value(const VectorX& x, const Conditions&) const {
  const double d = stretch(x).norm();
  if (!is_yielding(d)) return 0.5 * stiffness_ * d * d;
  return max_force_ * d - 0.5 * max_force_ * max_force_ / stiffness_;
}

double Hand::difference(const VectorX& from, const VectorX& to, const Conditions&) const {
  const Vector3 a = stretch(from), b = stretch(to);
  const Vector3 motion = place_.position(dim_, to - from);
  const double da = a.norm(), db = b.norm();
  const double squares = motion.dot(a + b);  // db^2 - da^2
  if (!is_yielding(da) && !is_yielding(db)) return 0.5 * stiffness_ * squares;
  if (is_yielding(da) && is_yielding(db)) return max_force_ * squares / (da + db);
  // One end on each side of the radius r: the parts of the way on both sides of it.
  const double r = max_force_ / stiffness_;
  const double sign = db > da ? 1 : -1;
  const double inside = std::min(da, db), outside = std::max(da, db);
  return sign * (0.5 * stiffness_ * (r - inside) * (r + inside) + max_force_ * (outside - r));
}

void Hand::add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const {
  const Vector3 f = -force(x);
  for (std::size_t a = 0; a < place_.nodes.size(); ++a)
    gradient.segment(Eigen::Index{place_.nodes[a]} * dim_, dim_) += place_.weights[a] * f.head(dim_);
}

void Hand::add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const {
  const Vector3 f = force(x).cwiseAbs();
  for (std::size_t a = 0; a < place_.nodes.size(); ++a)
    magnitude.segment(Eigen::Index{place_.nodes[a]} * dim_, dim_) +=
        std::abs(place_.weights[a]) * f.head(dim_);
}

Vector3 Hand::force(const VectorX& x) const {
  const Vector3 s = stretch(x);
  const double d = s.norm();
  return is_yielding(d) ? Vector3(-max_force_ / d * s) : Vector3(-stiffness_ * s);
}

/// k I inside, F/d (I - n n^T) beyond, with n the direction of the stretch.
void Hand::add_hessian(const VectorX& x, const Conditions&, Projection, BlockMatrix& hessian) const {
  const Vector3 s = stretch(x);
  const double d = s.norm();
  Matrix<3> K = stiffness_ * Matrix<3>::Identity();
  if (is_yielding(d)) K = max_force_ / d * (Matrix<3>::Identity() - s / d * (s / d).transpose());
  for (std::size_t a = 0; a < place_.nodes.size(); ++a) {
    for (std::size_t b = a; b < place_.nodes.size(); ++b) {
      const double weight = place_.weights[a] * place_.weights[b];
      if (weight == 0) continue;
      std::array<double, 9> block{};
      for (int i = 0; i < dim_; ++i) {
        for (int j = 0; j < dim_; ++j) block[static_cast<std::size_t>(i * dim_ + j)] = weight * K(i, j);
      }
      hessian.add_block(place_.nodes[a], place_.nodes[b], block.data());
    }
  }
}

}  // namespace resilin
