#include "resilin/world/support.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// From the centre of a turn to where it has taken X.
Vector3 turned_arm(const Rotation& turn, double factor, const Vector3& X) {
  const Eigen::AngleAxisd rotation(factor * radians(turn.degrees), turn.axis.normalized());
  return rotation * (X - turn.center);
}

}  // namespace

Vector3 Support::target(const Vector3& X, const Conditions& c) const {
  const double moving_time = until ? std::min(c.time, *until) : c.time;
  const double factor = time_function.factor(c.time, c.load);
  Vector3 place_now = X + moving_time * velocity;
  if (rotate) {
    place_now += rotate->center + turned_arm(*rotate, factor, X) - X;
  } else {
    place_now += factor * (displacement + gradient * X);
  }
  return place_now;
}

bool Support::holds_after(double time) const {
  return (std::ranges::upper_bound(switches, time) - switches.begin()) % 2 == 0;
}

bool Support::moves() const {
  return !displacement.isZero(0) || !gradient.isZero(0) || rotate.has_value() || !velocity.isZero(0);
}

double Support::turn_between(const Conditions& from, const Conditions& to) const {
  if (!rotate || !holds) return 0;
  constexpr int num_samples = 16;  // number of samples of a function that goes up and down
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  const auto look_at = [&](double part) {
    const double factor = time_function.factor(from.time + part * (to.time - from.time),
                                               from.load + part * (to.load - from.load));
    least = std::min(least, factor);
    largest = std::max(largest, factor);
  };
  for (int i = 0; i <= num_samples; ++i) look_at(static_cast<double>(i) / num_samples);
  for (const double kink : time_function.kinks())
    if (kink > from.time && kink < to.time) look_at((kink - from.time) / (to.time - from.time));
  return std::abs(rotate->degrees) * (largest - least);
}

int num_steps_of_turn(double degrees) {
  return std::max(1, static_cast<int>(std::ceil(std::abs(degrees) / largest_turn_of_step - 1e-9)));
}

bool turns_at_once(const FixDescription& fix) {
  return fix.rotate && fix.time_function.is_constant() && num_steps_of_turn(fix.rotate->degrees) > 1;
}

double largest_turn(const std::vector<Support>& supports, const Conditions& from, const Conditions& to) {
  double largest = 0;
  for (const Support& support : supports) largest = std::max(largest, support.turn_between(from, to));
  return largest;
}

Vector3 Support::velocity_at(const Vector3& X, double time) const {
  const bool moves_on = !until || ActiveTime{.until = *until}.contains(time);
  const Vector3 steady = moves_on ? velocity : Vector3(Vector3::Zero());
  const double rate = time_function.rate(time);
  if (!rotate) return steady + rate * (displacement + gradient * X);
  const Vector3 spin = rate * radians(rotate->degrees) * rotate->axis.normalized();
  return steady + spin.cross(turned_arm(*rotate, time_function.value(time), X));
}

Vector3 Support::acceleration_at(const Vector3& X, double time) const {
  const double second_rate = time_function.second_rate(time);
  if (!rotate) return second_rate * (displacement + gradient * X);
  const Vector3 turn = radians(rotate->degrees) * rotate->axis.normalized();
  const Vector3 spin = time_function.rate(time) * turn;
  const Vector3 arm = turned_arm(*rotate, time_function.value(time), X);
  return second_rate * turn.cross(arm) + spin.cross(spin.cross(arm));
}

std::vector<std::int32_t> supports_of_unknowns(int dim, Index num_nodes,
                                               const std::vector<Support>& supports) {
  std::vector<std::int32_t> owner(static_cast<std::size_t>(num_nodes) * static_cast<std::size_t>(dim), -1);
  for (std::size_t s = 0; s < supports.size(); ++s) {
    if (!supports[s].holds) continue;
    for (const Index node : supports[s].nodes) {
      for (int k = 0; k < dim; ++k) {
        if (!supports[s].components[static_cast<std::size_t>(k)]) continue;
        std::int32_t& entry = owner[static_cast<std::size_t>(node * dim + k)];
        if (entry < 0) entry = static_cast<std::int32_t>(s);
      }
    }
  }
  return owner;
}

namespace {

/// Whether two supports ever hold at a time.
bool hold_together(const Support& a, const Support& b) {
  if (a.holds_after(0) && b.holds_after(0)) return true;
  for (const std::vector<double>* times : {&a.switches, &b.switches})
    for (const double time : *times)
      if (a.holds_after(time) && b.holds_after(time)) return true;
  return false;
}

}  // namespace

void check_support_conflicts(int dim, const std::vector<Support>& supports, const VectorX& rest_positions) {
  const auto num_nodes = static_cast<Index>(rest_positions.size() / dim);
  const std::vector<std::int32_t> first = supports_of_unknowns(dim, num_nodes, supports);
  const double size = rest_positions.size() > 0 ? rest_positions.cwiseAbs().maxCoeff() : 0;
  const Conditions now{.time = 1, .load = 1};
  for (std::size_t s = 0; s < supports.size(); ++s) {
    for (const Index node : supports[s].nodes) {
      for (int k = 0; k < dim; ++k) {
        const std::int32_t other = first[static_cast<std::size_t>(node * dim + k)];
        if (!supports[s].components[static_cast<std::size_t>(k)] || other == static_cast<std::int32_t>(s))
          continue;
        const Support& holder = supports[static_cast<std::size_t>(other)];
        const bool both_switch = !holder.switches.empty() && !supports[s].switches.empty();
        if (both_switch && (holder.moves() || supports[s].moves()))
          throw InputError(supports[s].place,
                           "vertices of its own for a support that moves and that a step releases",
                           "vertex " + std::to_string(node) + ", which is in " + holder.place + " too",
                           "separate the two selections");
        if (!hold_together(holder, supports[s])) continue;
        const Vector3 X = node_position(dim, node, rest_positions);
        const double mine = supports[s].target(X, now)[k];
        const double theirs = holder.target(X, now)[k];
        if (std::abs(mine - theirs) <= 1e-12 * std::max(size, std::abs(mine))) continue;
        throw InputError(supports[s].place, "one prescribed position for each vertex",
                         "vertex " + std::to_string(node) + " moved by " + format_number(mine - X[k]) +
                             " m along " + "xyz"[k] + " here and by " + format_number(theirs - X[k]) +
                             " m in " + holder.place,
                         "separate the two selections");
      }
    }
  }
}

namespace {

/// Writes the prescribed components of a vector at a node into `values`.
void write_prescribed(int dim, const Support& support, Index node, const Vector3& vector, VectorX& values) {
  for (int k = 0; k < dim; ++k) {
    if (support.components[static_cast<std::size_t>(k)]) values[Eigen::Index{node} * dim + k] = vector[k];
  }
}

}  // namespace

void place_supports(int dim, const std::vector<Support>& supports, const VectorX& places, const Conditions& c,
                    VectorX& x) {
  // Backwards, so that the first support wins where two agree up to rounding.
  for (auto support = supports.rbegin(); support != supports.rend(); ++support) {
    if (!support->holds) continue;
    for (const Index node : support->nodes) {
      write_prescribed(dim, *support, node, support->target(node_position(dim, node, places), c), x);
    }
  }
}

void place_supports(int dim, const std::vector<Support>& supports, const VectorX& places, double time,
                    Motion& motion) {
  place_supports(dim, supports, places, {.time = time, .load = 1}, motion.positions);
  for (auto support = supports.rbegin(); support != supports.rend(); ++support) {
    if (!support->holds) continue;
    for (const Index node : support->nodes) {
      const Vector3 X = node_position(dim, node, places);
      write_prescribed(dim, *support, node, support->velocity_at(X, time), motion.velocities);
      write_prescribed(dim, *support, node, support->acceleration_at(X, time), motion.accelerations);
    }
  }
}

}  // namespace resilin
