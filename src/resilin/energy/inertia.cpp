#include "resilin/energy/inertia.hpp"

namespace resilin {

double MassDistance::value(const VectorX& x, const Conditions&) const {
  VectorX momentum;
  mass_.multiply(x - target_, momentum);
  return 0.5 / scale_ * momentum.dot(x - target_);
}

// |b|^2_M - |a|^2_M = (b - a)^T M (b + a) keeps its digits when a and b are close.
double MassDistance::difference(const VectorX& from, const VectorX& to, const Conditions&) const {
  VectorX momentum;
  mass_.multiply((to - target_) + (from - target_), momentum);
  return 0.5 / scale_ * momentum.dot(to - from);
}

void MassDistance::add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const {
  VectorX momentum;
  mass_.multiply(x - target_, momentum);
  gradient += momentum / scale_;
}

void MassDistance::add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const {
  VectorX momentum;
  mass_.multiply_magnitude(x.cwiseAbs() + target_.cwiseAbs(), momentum);
  magnitude += momentum / scale_;
}

}  // namespace resilin
