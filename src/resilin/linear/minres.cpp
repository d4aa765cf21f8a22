#include "resilin/linear/minres.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace resilin {

bool minres(const std::function<bool(const VectorX& v, VectorX& image)>& apply,
            const std::function<void(const VectorX& v, VectorX& image)>& precondition, const VectorX& b,
            const MinresSettings& settings, VectorX& x) {
  const Eigen::Index n = b.size();
  x.setZero(n);
  // The letters of Elman, Silvester & Wathen; `old` is of the iteration before.
  VectorX v_old = VectorX::Zero(n), v = b, w_old = v_old, w = v_old, z(n), image(n);
  precondition(v, z);
  double gamma_old = 1, gamma = std::sqrt(z.dot(v));
  const double first = gamma;
  double eta = gamma, s_old = 0, s = 0, c_old = 1, c = 1;
  if (first == 0) return true;
  for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
    z /= gamma;
    if (!apply(z, image)) return false;
    const double delta = image.dot(z);
    VectorX v_new = image - delta / gamma * v - gamma / gamma_old * v_old;
    VectorX z_new(n);
    precondition(v_new, z_new);
    const double gamma_new = std::sqrt(std::max(0.0, z_new.dot(v_new)));
    const double alpha0 = c * delta - c_old * s * gamma, alpha1 = std::hypot(alpha0, gamma_new);
    const double alpha2 = s * delta + c_old * c * gamma, alpha3 = s_old * gamma;
    if (!(alpha1 > 0)) return false;
    c_old = c;
    s_old = s;
    c = alpha0 / alpha1;
    s = gamma_new / alpha1;
    VectorX w_new = (z - alpha3 * w_old - alpha2 * w) / alpha1;
    x += c * eta * w_new;
    eta *= -s;
    if (std::abs(eta) <= settings.tolerance * first) return true;
    v_old = std::move(v);
    v = std::move(v_new);
    z = std::move(z_new);
    w_old = std::move(w);
    w = std::move(w_new);
    gamma_old = gamma;
    gamma = gamma_new;
  }
  return false;
}

}  // namespace resilin
