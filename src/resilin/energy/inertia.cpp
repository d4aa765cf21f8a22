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

void MassDistance::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                        const Conditions&, VectorX& slopes) const {
  if (name == "mass") return mass_.add_slopes(w, (x - target_) / scale_, slopes);
  VectorX product;
  mass_.multiply(w, product);
  slopes -= product / scale_;
}

void MassDistance::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                        const Conditions&, VectorX& gradient) const {
  if (name == "mass") return mass_.add_change(change, (x - target_) / scale_, gradient);
  VectorX product;
  mass_.multiply(change, product);
  gradient -= product / scale_;
}

}  // namespace resilin
