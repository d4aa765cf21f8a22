#include "resilin/energy/cable.hpp"

#include <cmath>
#include <utility>

namespace resilin {

namespace {

/// Whether it is a spring of rest length 0: its energy k/2 |p_2 - p_1|^2 is smooth where the ends coincide.
bool is_linear_spring(const std::vector<CarriedPoint>& points, const Cable::Law& law) {
  return points.size() == 2 && law.rest_length == 0 && law.shortening == 0 && !law.tension;
}

}  // namespace

Cable::Cable(std::string name, int dim, std::vector<CarriedPoint> points, Law law)
    : name_(std::move(name)), path_(dim, std::move(points)), law_(std::move(law)) {}

Vector3 Cable::first_direction(const VectorX& x) const { return -path_.pulls(x, each(1)).front(); }

double Cable::stretch(double length, const Conditions& c) const {
  const double shortened = law_.shortening == 0 ? 0 : law_.function.factor(c.time, c.load) * law_.shortening;
  const double stretch = length - law_.rest_length + shortened;
  return law_.tension_only && stretch < 0 ? 0 : stretch;
}

double Cable::slope(double length, const Conditions& c) const {
  if (law_.tension) return law_.function.factor(c.time, c.load) * *law_.tension;
  return law_.stiffness * stretch(length, c);
}

double Cable::curvature(double length, const Conditions& c) const {
  if (law_.tension || (law_.tension_only && stretch(length, c) == 0)) return 0;
  return law_.stiffness;
}

double Cable::value(const VectorX& x, const Conditions& c) const {
  const double l = length(x);
  if (law_.tension) return slope(l, c) * (l - law_.rest_length);
  const double s = stretch(l, c);
  return 0.5 * law_.stiffness * s * s;
}

double Cable::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  double longer = 0;
  for (const double change : path_.lengthening(from, to)) longer += change;
  const double length_from = length(from), length_to = length(to);
  if (law_.tension) return slope(length_to, c) * longer;
  const double s_from = stretch(length_from, c), s_to = stretch(length_to, c);
  const bool is_taut = !law_.tension_only || (s_from > 0 && s_to > 0);
  return 0.5 * law_.stiffness * (is_taut ? longer : s_to - s_from) * (s_to + s_from);
}

void Cable::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  path_.add_slopes(x, each(force(x, c)), gradient);
}

void Cable::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double l = length(x);
  const double shortened = std::abs(law_.shortening * law_.function.factor(c.time, c.load));
  const double tension =
      law_.tension ? slope(l, c) : law_.stiffness * (l + std::abs(law_.rest_length) + shortened);
  path_.add_slope_magnitudes(x, each(tension), magnitude);
}

void Cable::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                        BlockMatrix& hessian) const {
  const double l = length(x), k = curvature(l, c);
  if (l == 0 && is_linear_spring(path_.points(), law_)) {
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        path_.add_blocks(i, j, (i == j ? law_.stiffness : -law_.stiffness) * Matrix<3>::Identity(), hessian);
    return;
  }
  double tension = slope(l, c);
  if (tension < 0 && projection == Projection::clamp) tension = 0;
  if (projection == Projection::absolute) tension = std::abs(tension);
  if (k != 0) path_.add_square(x, each(1), k, hessian);
  if (tension != 0) path_.add_curvatures(x, each(tension), hessian);
}

void Cable::add_pattern(BlockPatternBuilder& builder) const { path_.add_pattern(builder); }

std::optional<double> Cable::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                         const Conditions& after) const {
  if (law_.function.is_constant()) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

void Cable::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  if (law_.tension || path_.points().size() != 2 || law_.tension_only) return;
  const Vector3 along = first_direction(x);
  std::vector<Vector3> directions;
  if (along.norm() > 0)
    directions.push_back(along);
  else if (is_linear_spring(path_.points(), law_))
    for (int axis = 0; axis < path_.dim(); ++axis) directions.push_back(Vector3::Unit(axis));
  for (const Vector3& each : directions) {
    HeldDirection direction{.nodes = {}, .direction = each};
    for (int end = 0; end < 2; ++end)
      for (const auto& [node, weight] : path_.points()[static_cast<std::size_t>(end)].nodes)
        direction.nodes.push_back({node, end == 0 ? weight : -weight});
    held.push_back(std::move(direction));
  }
}

}  // namespace resilin
