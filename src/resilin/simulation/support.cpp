#include "resilin/simulation/support.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/facet.hpp"

namespace resilin {

Vector3 Support::target(const Vector3& X, const Conditions& c) const {
  const double moving_time = until ? std::min(c.time, *until) : c.time;
  Vector3 place_now = X + moving_time * velocity;
  if (rotate) {
    const double angle = c.load * rotate->degrees * std::numbers::pi / 180;
    const Eigen::AngleAxisd rotation(angle, rotate->axis.normalized());
    place_now += rotate->center + rotation * (X - rotate->center) - X;
  } else {
    place_now += c.load * (displacement + gradient * X);
  }
  return place_now;
}

std::vector<std::int32_t> supports_of_unknowns(int dim, Index num_nodes,
                                               const std::vector<Support>& supports) {
  std::vector<std::int32_t> owner(static_cast<std::size_t>(num_nodes) * static_cast<std::size_t>(dim), -1);
  for (std::size_t s = 0; s < supports.size(); ++s) {
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
        const Vector3 X = node_position(dim, node, rest_positions);
        const double mine = supports[s].target(X, now)[k];
        const double theirs = holder.target(X, now)[k];
        if (std::abs(mine - theirs) <= 1e-12 * std::max(size, std::abs(mine))) continue;
        throw InputError(supports[s].place, "one place for each vertex",
                         "vertex " + std::to_string(node) + " moved by " + format_number(mine - X[k]) +
                             " m along " + "xyz"[k] + " here and by " + format_number(theirs - X[k]) +
                             " m in " + holder.place,
                         "let the two selections not overlap");
      }
    }
  }
}

void place_supports(int dim, const std::vector<Support>& supports, const VectorX& rest_positions,
                    const Conditions& c, VectorX& x) {
  // Backwards, so that the first support wins where two agree up to rounding.
  for (auto support = supports.rbegin(); support != supports.rend(); ++support) {
    for (const Index node : support->nodes) {
      const Vector3 target = support->target(node_position(dim, node, rest_positions), c);
      for (int k = 0; k < dim; ++k) {
        if (support->components[static_cast<std::size_t>(k)]) x[Eigen::Index{node} * dim + k] = target[k];
      }
    }
  }
}

}  // namespace resilin
