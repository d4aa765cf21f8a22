#include "resilin/contact/pressing_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "resilin/core/dual.hpp"

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

// Forces are numbers, or numbers that carry a slope.
double value_of(double force) { return force; }
double value_of(const Dual<double, 1>& force) { return force.value; }

template <class Force>
Force magnitude(const Force& force) {
  return value_of(force) < 0 ? -1.0 * force : force;
}

/// Takes what has to be given back from those that reach up to the feature or are a corner of it, the more
/// the nearer a force is to what they give back: so both vanish together. @return what none of them has [N]
template <class Force>
Force take_from_neighbours(std::size_t feature, std::span<const PartForce> parts,
                           std::span<const Force> forces, std::vector<Force>& left) {
  const Force back = -1.0 * forces[feature];
  std::vector<Force> weights(parts.size(), Force(0.0));
  Force sum(0.0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool is_near =
        parts[i].force > 0 && (has(parts[i], parts[feature]) || has(parts[feature], parts[i]));
    if (is_near) weights[i] = 1.0 / (magnitude(forces[i] - back) / back + Force(epsilon));
    sum = sum + weights[i];
  }
  if (value_of(sum) == 0) return back;
  for (std::size_t i = 0; i < parts.size(); ++i) left[i] = left[i] - back * weights[i] / sum;
  return Force(0.0);
}

/// The forces that press on one point, part by part, made of `forces`.
template <class Force>
std::vector<Force> pressing(std::span<const PartForce> parts, std::span<const Force> forces) {
  const auto gives_back = [](const PartForce& part) { return part.force < 0; };
  if (std::ranges::none_of(parts, gives_back)) return {forces.begin(), forces.end()};
  std::vector<Force> left;
  for (const Force& force : forces) left.push_back(value_of(force) > 0 ? force : Force(0.0));
  Force back(0.0), sum(0.0);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (gives_back(parts[i])) back = back + take_from_neighbours(i, parts, forces, left);
  for (Force& force : left) {
    if (value_of(force) < 0) {
      back = back - force;
      force = Force(0.0);
    }
    sum = sum + force;
  }
  const bool is_left = value_of(sum) > value_of(back);
  for (Force& force : left) force = is_left ? (1.0 - back / sum) * force : Force(0.0);
  return left;
}

/// Calls `visit(begin, end)` for the parts of each point, and for each other part by itself.
template <class Visit>
void for_each_point(const std::vector<PartForce>& forces, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < forces.size(); begin = end) {
    const auto is_of_point = [&](const PartForce& force) {
      return force.kind != PairKind::edge_edge && force.vertices[0] == forces[begin].vertices[0];
    };
    for (end = begin + 1; end < forces.size() && is_of_point(forces[end]);) ++end;
    visit(begin, end);
  }
}

}  // namespace

std::vector<PartForce> pressing_forces(std::vector<PartForce> forces) {
  std::vector<double> values;
  for (const PartForce& part : forces) values.push_back(part.force);
  const std::vector<PartForce> parts = forces;
  for_each_point(parts, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    const std::vector<double> left =
        pressing<double>(std::span(parts).subspan(begin, count), std::span(values).subspan(begin, count));
    for (std::size_t i = 0; i < count; ++i) forces[begin + i].force = left[i];
  });
  std::erase_if(forces, [](const PartForce& force) { return !(force.force > 0); });
  return forces;
}

std::vector<PressingForce> pressing_slopes(const std::vector<PartForce>& forces) {
  using Force = Dual<double, 1>;
  std::vector<PressingForce> all;
  for_each_point(forces, [&](std::size_t begin, std::size_t end) {
    const std::span<const PartForce> parts = std::span(forces).subspan(begin, end - begin);
    std::vector<PressingForce> found(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<Force> values;
      for (std::size_t i = 0; i < parts.size(); ++i)
        values.push_back(i == k ? Force::variable(parts[i].force, 0) : Force(parts[i].force));
      const std::vector<Force> left = pressing<Force>(parts, values);
      for (std::size_t i = 0; i < parts.size(); ++i) {
        found[i].part = begin + i;
        found[i].force = left[i].value;
        if (left[i].slope[0] != 0) found[i].slopes.emplace_back(begin + k, left[i].slope[0]);
      }
    }
    for (PressingForce& force : found)
      if (force.force > 0) all.push_back(std::move(force));
  });
  return all;
}

}  // namespace resilin
