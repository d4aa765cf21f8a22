#include "resilin/energy/cable.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace resilin {

namespace {

/// Whether it is a spring of rest length 0: its energy k/2 |p_2 - p_1|^2 is smooth where the ends coincide.
bool is_linear_spring(const std::vector<CarriedPoint>& points, const Cable::Law& law) {
  return points.size() == 2 && law.rest_length == 0 && law.shortening == 0 && !law.tension &&
         law.forces.empty();
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

std::size_t Cable::piece_of(double stretch) const {
  const auto after = std::ranges::upper_bound(law_.elongations, stretch) - law_.elongations.begin();
  const auto last = static_cast<std::ptrdiff_t>(law_.elongations.size()) - 1;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after, 1, last) - 1);
}

double Cable::slope_of_piece(std::size_t piece) const {
  return (law_.forces[piece + 1] - law_.forces[piece]) /
         (law_.elongations[piece + 1] - law_.elongations[piece]);
}

double Cable::force_at(double stretch) const {
  if (law_.forces.empty()) return law_.stiffness * stretch;
  const std::size_t piece = piece_of(stretch);
  return law_.forces[piece] + slope_of_piece(piece) * (stretch - law_.elongations[piece]);
}

// Trapezia from the stretch on to zero.
double Cable::energy_at(double stretch) const {
  if (law_.forces.empty()) return 0.5 * law_.stiffness * stretch * stretch;
  const double low = std::min(stretch, 0.0), high = std::max(stretch, 0.0);
  double sum = 0, from = low, force = force_at(low);
  const auto go_to = [&](double to) {
    const double there = force_at(to);
    sum += 0.5 * (force + there) * (to - from);
    from = to;
    force = there;
  };
  for (const double each : law_.elongations)
    if (each > low && each < high) go_to(each);
  go_to(high);
  return stretch < 0 ? -sum : sum;
}

double Cable::slope(double length, const Conditions& c) const {
  if (law_.tension) return law_.function.factor(c.time, c.load) * *law_.tension;
  return force_at(stretch(length, c));
}

double Cable::curvature(double length, const Conditions& c) const {
  if (law_.tension || (law_.tension_only && stretch(length, c) == 0)) return 0;
  if (!law_.forces.empty()) return slope_of_piece(piece_of(stretch(length, c)));
  return law_.stiffness;
}

double Cable::force_by(std::string_view parameter, double length, const Conditions& c) const {
  if (parameter == "tension") return law_.function.factor(c.time, c.load);
  if (parameter == "stiffness") return stretch(length, c);
  const double k = curvature(length, c);
  return parameter == "shortening" ? k * law_.function.factor(c.time, c.load) : -k;
}

double Cable::value(const VectorX& x, const Conditions& c) const {
  const double l = length(x);
  if (law_.tension) return slope(l, c) * (l - law_.rest_length);
  return energy_at(stretch(l, c));
}

double Cable::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  double longer = 0;
  for (const double change : path_.lengthening(from, to)) longer += change;
  const double length_from = length(from), length_to = length(to);
  if (law_.tension) return slope(length_to, c) * longer;
  const double s_from = stretch(length_from, c), s_to = stretch(length_to, c);
  if (!law_.forces.empty()) {
    // Within one piece the mean force times the way keeps the digits.
    const bool is_one_piece =
        piece_of(s_from) == piece_of(s_to) && (!law_.tension_only || (s_from > 0 && s_to > 0));
    return is_one_piece ? 0.5 * (force_at(s_from) + force_at(s_to)) * longer
                        : energy_at(s_to) - energy_at(s_from);
  }
  const bool is_taut = !law_.tension_only || (s_from > 0 && s_to > 0);
  return 0.5 * law_.stiffness * (is_taut ? longer : s_to - s_from) * (s_to + s_from);
}

void Cable::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  path_.add_slopes(x, each(force(x, c)), gradient);
}

void Cable::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double l = length(x);
  const double shortened = std::abs(law_.shortening * law_.function.factor(c.time, c.load));
  const double tension = law_.tension
                             ? slope(l, c)
                             : std::abs(force_at(stretch(l, c))) +
                                   std::abs(curvature(l, c)) * (l + std::abs(law_.rest_length) + shortened);
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
  const double k_square = k > 0 || projection == Projection::none ? k
                          : projection == Projection::clamp       ? 0
                                                                  : -k;
  if (k_square != 0) path_.add_square(x, each(1), k_square, hessian);
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

void Cable::rest_at(const VectorX& rest_positions) {
  law_.rest_length = length(rest_positions);
  rest_pulls_ = path_.pulls(rest_positions, each(1));
  num_unknowns_ = rest_positions.size();
}

std::vector<EnergyParameter> Cable::parameters() const {
  if (law_.tension) return {{"tension"}};
  std::vector<EnergyParameter> all = {{"rest_length"}, {"shortening"}};
  if (law_.forces.empty()) all.push_back({"stiffness"});
  if (!rest_pulls_.empty()) all.push_back({"rest_positions", num_unknowns_});
  return all;
}

void Cable::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                 const Conditions& c, VectorX& slopes) const {
  double by_force = 0;  // w . dl/dx
  for (const double longer : path_.first_order_lengthening(x, w)) by_force += longer;
  const double slope = by_force * force_by(name, length(x), c);
  if (name != "rest_positions") {
    slopes[0] += slope;
    return;
  }
  for (std::size_t i = 0; i < rest_pulls_.size(); ++i)
    for (const auto& [node, weight] : path_.points()[i].nodes)
      slopes.segment(Eigen::Index{node} * path_.dim(), path_.dim()) +=
          slope * weight * rest_pulls_[i].head(path_.dim());
}

void Cable::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                 const Conditions& c, VectorX& gradient) const {
  double size = 0;
  if (name != "rest_positions") size = change[0];
  for (std::size_t i = 0; name == "rest_positions" && i < rest_pulls_.size(); ++i)
    for (const auto& [node, weight] : path_.points()[i].nodes)
      size += weight * rest_pulls_[i].dot(node_position(path_.dim(), node, change));
  path_.add_slopes(x, each(size * force_by(name, length(x), c)), gradient);
}

}  // namespace resilin
