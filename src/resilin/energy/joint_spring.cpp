#include "resilin/energy/joint_spring.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "resilin/core/dense.hpp"

namespace resilin {

JointSpring::JointSpring(std::string name, JointCoordinate coordinate, Law law)
    : name_(std::move(name)), coordinate_(std::move(coordinate)), law_(std::move(law)) {}

double JointSpring::offset(double q, const Conditions& c) const {
  double d = q;
  if (law_.limits) {
    d -= 0.5 * ((*law_.limits)[0] + (*law_.limits)[1]);
  } else if (!law_.effort) {
    d -= law_.rest + law_.goal.at(c);
  }
  return coordinate_.is_angle() ? std::remainder(d, 2 * std::numbers::pi) : d;
}

double JointSpring::stretch(double offset) const {
  if (!law_.limits) return offset;
  const double beyond = std::abs(offset) - 0.5 * ((*law_.limits)[1] - (*law_.limits)[0]);
  return beyond > 0 ? std::copysign(beyond, offset) : 0;
}

double JointSpring::effort(const Conditions& c) const {
  return *law_.effort * law_.goal.function.factor(c.time, c.load);
}

double JointSpring::slope(double offset, const Conditions& c) const {
  return law_.effort ? -effort(c) : law_.stiffness * stretch(offset);
}

double JointSpring::value(const VectorX& x, const Conditions& c) const {
  const double d = offset(coordinate_.value(x), c);
  if (law_.effort) return -effort(c) * d;
  const double s = stretch(d);
  return 0.5 * law_.stiffness * s * s;
}

double JointSpring::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const double change = coordinate_.change(from, to);
  if (law_.effort) return -effort(c) * change;
  const double before = offset(coordinate_.value(from), c), after = before + change;
  const bool is_around = coordinate_.is_angle() && std::abs(after) > std::numbers::pi;
  const double s = stretch(before), t = stretch(is_around ? offset(coordinate_.value(to), c) : after);
  const bool is_smooth = !is_around && s * t > 0;
  return 0.5 * law_.stiffness * (is_smooth ? change : t - s) * (t + s);
}

void JointSpring::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const double force = slope(offset(coordinate_.value(x), c), c);
  if (force != 0) coordinate_.add_forces(force * coordinate_.slopes(x), gradient);
}

void JointSpring::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double d = offset(coordinate_.value(x), c);
  double force = std::abs(slope(d, c));
  if (!law_.effort && stretch(d) != 0)
    force += law_.stiffness * (coordinate_.magnitude(x) + std::abs(law_.rest) + std::abs(law_.goal.at(c)));
  coordinate_.add_magnitudes(force * coordinate_.slopes(x), magnitude);
}

void JointSpring::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                              BlockMatrix& hessian) const {
  const double d = offset(coordinate_.value(x), c), force = slope(d, c);
  const bool is_taut = !law_.effort && (!law_.limits || stretch(d) != 0);
  if (force == 0 && !is_taut) return;
  JointCoordinate::Square K = force * coordinate_.curvatures(x);
  if (is_taut) {
    const JointCoordinate::Vector slopes = coordinate_.slopes(x);
    K += law_.stiffness * slopes * slopes.transpose();
  }
  if (projection != Projection::none && force != 0) {
    dense::Eigenpairs eigen = dense::symmetric_eigenpairs(K);
    for (double& value : eigen.values)
      if (value < 0) value = projection == Projection::clamp ? 0 : -value;
    K = eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
  }
  coordinate_.add_blocks(K, hessian);
}

std::vector<EnergyParameter> JointSpring::parameters() const {
  if (law_.limits) return {};
  if (law_.effort) return {{"effort"}};
  if (law_.is_motor) return {{"position"}, {"velocity"}};
  return {{"stiffness"}, {"rest"}};
}

double JointSpring::slope_by(std::string_view parameter, double offset, const Conditions& c) const {
  if (parameter == "effort") return -law_.goal.function.factor(c.time, c.load);
  if (parameter == "stiffness") return stretch(offset);
  return -law_.stiffness * (parameter == "rest" ? 1 : law_.goal.at_by(parameter, c));
}

void JointSpring::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                       const Conditions& c, VectorX& slopes) const {
  slopes[0] += slope_by(name, offset(coordinate_.value(x), c), c) * coordinate_.rate(x, w);
}

void JointSpring::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                       const Conditions& c, VectorX& gradient) const {
  const double force = change[0] * slope_by(name, offset(coordinate_.value(x), c), c);
  coordinate_.add_forces(force * coordinate_.slopes(x), gradient);
}

std::optional<double> JointSpring::driven_work(const VectorX& from, const Conditions& before,
                                               const VectorX& to, const Conditions& after) const {
  if (!law_.is_motor || !law_.goal.moves(before, after)) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

}  // namespace resilin
