#include "resilin/contact/pressing_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace resilin {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

std::span<const Index> second_part(const PartForce& force) {
  const auto first = static_cast<std::size_t>(num_first(force.kind)),
             count = static_cast<std::size_t>(num_vertices(force.kind));
  return std::span(force.vertices).subspan(first, count - first);
}

/// Whether a part of the surface reaches up to a vertex or an edge of it.
bool has(const PartForce& part, const PartForce& feature) {
  return std::ranges::all_of(second_part(feature), [&](Index vertex) {
    return std::ranges::find(second_part(part), vertex) != second_part(part).end();
  });
}

/// Takes what has to be given back from those that reach up to the feature or are a corner of it, the more
/// the nearer a force is to what they give back: so both vanish together. @return what none of them has [N]
double take_from_neighbours(const PartForce& feature, std::span<const PartForce> forces,
                            std::vector<double>& left) {
  const double back = -feature.force;
  const auto weight_of = [&](const PartForce& part) {
    const bool is_near = part.force > 0 && (has(part, feature) || has(feature, part));
    return is_near ? 1 / (std::abs(part.force - back) / back + epsilon) : 0;
  };
  double sum = 0;
  for (const PartForce& part : forces) sum += weight_of(part);
  if (sum == 0) return back;
  for (std::size_t i = 0; i < forces.size(); ++i) left[i] -= back * weight_of(forces[i]) / sum;
  return 0;
}

/// Of one point.
void make_pressing(std::span<PartForce> forces) {
  const auto gives_back = [](const PartForce& force) { return force.force < 0; };
  if (std::ranges::none_of(forces, gives_back)) return;
  std::vector<double> left;
  for (const PartForce& force : forces) left.push_back(std::max(force.force, 0.0));
  double back = 0;
  for (const PartForce& force : forces)
    if (gives_back(force)) back += take_from_neighbours(force, forces, left);
  double sum = 0;
  for (double& force : left) {
    back += std::max(-force, 0.0);
    force = std::max(force, 0.0);
    sum += force;
  }
  const double share = sum > back ? 1 - back / sum : 0;
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i].force = share * left[i];
}

}  // namespace

std::vector<PartForce> pressing_forces(std::vector<PartForce> forces) {
  for (std::size_t begin = 0, end = 0; begin < forces.size(); begin = end) {
    const auto is_of_point = [&](const PartForce& force) {
      return force.kind != PairKind::edge_edge && force.vertices[0] == forces[begin].vertices[0];
    };
    for (end = begin + 1; end < forces.size() && is_of_point(forces[end]);) ++end;
    make_pressing(std::span(forces).subspan(begin, end - begin));
  }
  std::erase_if(forces, [](const PartForce& force) { return !(force.force > 0); });
  return forces;
}

}  // namespace resilin
