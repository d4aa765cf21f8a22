#include "resilin/contact/cable_friction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace resilin {
namespace {

/// Gauss's rule of twelve points on (-1, 1): the positive ones.
struct GaussPoint {
  double at, weight;
};
constexpr std::array<GaussPoint, 6> gauss_points{{{0.1252334085114689, 0.2491470458134028},
                                                  {0.3678314989981802, 0.2334925365383548},
                                                  {0.5873179542866175, 0.2031674267230659},
                                                  {0.7699026741943047, 0.1600783285433462},
                                                  {0.9041172563704749, 0.1069393259953184},
                                                  {0.9815606342467193, 0.0471753363865118}}};

/// Sums over all pieces from the last one back to that behind each guide.
std::vector<double> sums_behind(const std::vector<double>& pieces) {
  std::vector<double> sums(pieces.size() - 1);
  double sum = 0;
  for (std::size_t i = pieces.size() - 1; i > 0; --i) sums[i - 1] = sum += pieces[i];
  return sums;
}

/// Length of the way of what goes with a velocity that changes evenly from a to b, in a time of one.
double way_there_and_back(double a, double b) {
  if (a * b >= 0) return 0.5 * std::abs(a + b);
  return 0.5 * (a * a + b * b) / (std::abs(a) + std::abs(b));
}

}  // namespace

std::unique_ptr<Energy> CableFriction::begin_stage(const Stage& stage) const {
  if (!(stage.time_of_slip() > 0)) return nullptr;
  return std::make_unique<LaggedCableFriction>(*this, stage);
}

LaggedCableFriction::LaggedCableFriction(const CableFriction& friction, const Stage& stage)
    : friction_(friction),
      still_(stage.still_end()),
      time_(stage.time_of_slip()),
      is_static_(stage.is_static()),
      slip_{friction.speed() * stage.time_of_slip()},
      guides_(path().num_pieces() - 1) {}

std::vector<double> LaggedCableFriction::shortening(const VectorX& x) const {
  return sums_behind(path().lengthening(x, still_));
}

double LaggedCableFriction::sigma(double slip) const {
  const double y = std::abs(slip);
  return y < slip_.eps ? slip * slip_.slope_over_slip(y) : std::copysign(1.0, slip);
}

double LaggedCableFriction::sigma_slope(double slip, double sigma) const {
  const double y = std::abs(slip);
  return std::max(slip_.slope_over_slip(y) - slip_.fall_of_slope(y) * std::copysign(1.0, slip) * sigma, 0.0);
}

double LaggedCableFriction::step_of(const Guide& guide, double slip) const {
  return -guide.tension * std::expm1(-guide.exponent * sigma(slip));
}

// Between corners of sigma the integrand is smooth.
double LaggedCableFriction::energy(const Guide& guide, double from, double change) const {
  if (change == 0 || guide.tension == 0) return 0;
  const double to = from + change;
  std::array<double, 5> ends{from, from, from, from, to};
  std::size_t count = 1;
  for (const double corner : {-slip_.eps, 0.0, slip_.eps})
    if ((corner - from) * (corner - to) < 0) ends[count++] = corner;
  if (change < 0) std::reverse(ends.begin() + 1, ends.begin() + static_cast<std::ptrdiff_t>(count));
  ends[count] = to;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double way = count == 1 ? change : ends[i + 1] - ends[i], middle = ends[i] + 0.5 * way;
    for (const auto& [at, weight] : gauss_points)
      sum += 0.5 * way * weight *
             (step_of(guide, middle - 0.5 * way * at) + step_of(guide, middle + 0.5 * way * at));
  }
  return sum;
}

// In motion the slip is the velocity at the end times the duration: the shortening of a polygon that turns is
// not that to first order.
std::vector<LaggedCableFriction::Guide> LaggedCableFriction::guides_at(const VectorX& x,
                                                                       const Conditions& c) const {
  const std::vector<double> shorter = shortening(x), turns = path().turns(x);
  std::vector<double> slips = shorter;
  if (!is_static_) slips = sums_behind(path().first_order_lengthening(x, still_ - x));
  std::vector<Guide> guides(slips.size());
  double tension = std::max(friction_.cable().force(x, c), 0.0);
  for (std::size_t i = 0; i < guides.size(); ++i) {
    guides[i] = {
        .tension = tension, .exponent = friction_.coefficient() * turns[i], .offset = slips[i] - shorter[i]};
    tension -= step_of(guides[i], slips[i]);
  }
  return guides;
}

std::vector<double> LaggedCableFriction::tensions(const VectorX& x, const Conditions& c) const {
  const std::vector<Guide> guides = guides_at(x, c);
  std::vector<double> all;
  for (const Guide& guide : guides) all.push_back(guide.tension);
  all.push_back(all.back() - step_of(guides.back(), shortening(x).back() + guides.back().offset));
  return all;
}

bool LaggedCableFriction::form_lag(const VectorX& x, const Conditions& c) {
  const auto rubs = [](const Guide& guide) { return guide.tension * guide.exponent > 0; };
  std::vector<Guide> formed = guides_at(x, c);
  if (coupled_) {
    coupled_ = std::move(formed);
    return std::ranges::any_of(*coupled_, rubs);
  }
  before_ = std::exchange(guides_, std::move(formed));
  return std::ranges::any_of(guides_, rubs) || std::ranges::any_of(before_, rubs);
}

void LaggedCableFriction::couple_lag(bool is_coupled) {
  coupled_.reset();
  if (is_coupled) coupled_ = guides_;
}

bool LaggedCableFriction::relax_lag() {
  if (coupled_) return false;
  std::vector<double> changes;
  for (std::size_t i = 0; i < guides_.size(); ++i)
    changes.push_back(guides_[i].tension * guides_[i].exponent - before_[i].tension * before_[i].exponent);
  const double share = relaxation_.next_share(changes);
  if (share == 1) return false;
  const auto mix = [share](double before, double& now) { now = share * now + (1 - share) * before; };
  for (std::size_t i = 0; i < guides_.size(); ++i) {
    mix(before_[i].tension, guides_[i].tension);
    mix(before_[i].exponent, guides_[i].exponent);
    mix(before_[i].offset, guides_[i].offset);
    guides_[i].tension = std::max(guides_[i].tension, 0.0);
    guides_[i].exponent = std::max(guides_[i].exponent, 0.0);
  }
  return true;
}

// As the friction of contacts (contact/friction.cpp), in one direction.
void LaggedCableFriction::follow(const VectorX& x, const VectorX& p, double t) {
  if (coupled_) return;
  const std::vector<double> shorter = shortening(x);
  const std::vector<double> changes = sums_behind(path().first_order_lengthening(x, -p));
  if (followed_.empty())
    for (std::size_t i = 0; i < guides_.size(); ++i)
      followed_.push_back(sigma(shorter[i] + guides_[i].offset));
  for (std::size_t i = 0; i < guides_.size(); ++i) {
    const double s = shorter[i] + guides_[i].offset, y = std::abs(s);
    double& w = followed_[i];
    const double end = slip_.slope_over_slip(y) * (s + changes[i]) -
                       slip_.fall_of_slope(y) * std::copysign(1.0, s) * changes[i] * w;
    w = std::clamp(w + t * (end - w), -1.0, 1.0);
  }
}

double LaggedCableFriction::value(const VectorX& x, const Conditions& c) const {
  const std::vector<double> shorter = shortening(x);
  double sum = 0;
  for (std::size_t i = 0; i < guides_.size(); ++i)
    sum += energy(guides_[i], 0, shorter[i] + guides_[i].offset);
  return c.weight * sum;
}

double LaggedCableFriction::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const std::vector<double> shorter = shortening(from), changes = sums_behind(path().lengthening(to, from));
  double sum = 0;
  for (std::size_t i = 0; i < guides_.size(); ++i)
    sum += energy(guides_[i], shorter[i] + guides_[i].offset, changes[i]);
  return c.weight * sum;
}

std::vector<double> LaggedCableFriction::factors(const std::vector<Guide>& guides, const VectorX& x,
                                                 double weight) const {
  const std::vector<double> shorter = shortening(x);
  std::vector<double> factors(path().num_pieces(), 0.0);
  for (std::size_t i = 0; i < guides.size(); ++i)
    factors[i + 1] = factors[i] - weight * step_of(guides[i], shorter[i] + guides[i].offset);
  return factors;
}

void LaggedCableFriction::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  path().add_slopes(x, factors(coupled_ ? guides_at(x, c) : guides_, x, c.weight), gradient);
}

void LaggedCableFriction::add_gradient_magnitude(const VectorX& x, const Conditions& c,
                                                 VectorX& magnitude) const {
  path().add_slope_magnitudes(x, factors(guides_, x, c.weight), magnitude);
}

void LaggedCableFriction::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                                      BlockMatrix& hessian) const {
  const std::vector<double> shorter = shortening(x);
  const std::vector<Guide>& guides = coupled_ ? *coupled_ : guides_;
  const bool follows = !coupled_ && !followed_.empty();
  for (std::size_t i = 0; i < guides.size(); ++i) {
    const Guide& guide = guides[i];
    const double slip = shorter[i] + guide.offset, seen = follows ? followed_[i] : sigma(slip);
    const double slope =
        guide.tension * guide.exponent * std::exp(-guide.exponent * seen) * sigma_slope(slip, seen);
    if (slope == 0) continue;
    std::vector<double> behind(path().num_pieces(), 0.0);
    std::fill(behind.begin() + static_cast<std::ptrdiff_t>(i) + 1, behind.end(), 1.0);
    path().add_square(x, behind, c.weight * slope, hessian);
  }
  std::vector<double> curving = factors(guides, x, c.weight);
  for (double& factor : curving) {
    if (projection == Projection::clamp) factor = std::max(factor, 0.0);
    if (projection == Projection::absolute) factor = std::abs(factor);
  }
  path().add_curvatures(x, curving, hessian);
}

// The slip velocity goes evenly to that at the end, by the same way, as that of contacts.
double LaggedCableFriction::dissipation(const VectorX& from, const VectorX& to, double duration) const {
  const std::vector<double> shorter = shortening(to), ways = sums_behind(path().lengthening(to, from));
  double heat = 0;
  for (std::size_t i = 0; i < guides_.size(); ++i) {
    const double slip = shorter[i] + guides_[i].offset;
    const double end = time_ > 0 ? duration / time_ * slip : ways[i];
    heat += std::abs(step_of(guides_[i], slip)) * way_there_and_back(2 * ways[i] - end, end);
  }
  return heat;
}

}  // namespace resilin
