#include "resilin/fields/extremes.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// The least and the greatest number that a place stands for.
std::pair<double, double> range_at(const FieldValues& field, std::size_t place) {
  const auto components = static_cast<std::size_t>(field.field->components());
  const double* values = field.values.data() + place * components;
  if (field.field->kind == FieldInfo::Kind::principal_values) return {values[2], values[0]};
  if (field.field->kind == FieldInfo::Kind::scalar) return {values[0], values[0]};
  const double length = Eigen::Map<const Vector3>(values).norm();
  return {length, length};
}

/// Fills in body, number and position of the place that was found.
Extreme located(const World& world, const State& state, bool is_on_nodes, double value, std::size_t place) {
  auto number = static_cast<Index>(place);
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const Index size = is_on_nodes ? body.num_nodes : body.num_cells();
    if (number >= size) {
      number -= size;
      continue;
    }
    Extreme extreme{.value = value, .body = b, .number = number};
    if (is_on_nodes) {
      extreme.position = world.place_of(body.first_node + number, state.positions);
      return extreme;
    }
    const auto count = static_cast<std::size_t>(num_nodes(body.cell_kind));
    for (std::size_t a = 0; a < count; ++a)
      extreme.position += node_position(
          world.dimension, body.cells[static_cast<std::size_t>(number) * count + a], state.positions);
    extreme.position = world.origin + extreme.position / static_cast<double>(count);
    return extreme;
  }
  return {};
}

/// Nodes that no cell uses carry nothing.
std::vector<bool> is_meant(const World& world, bool is_on_nodes, std::size_t count) {
  std::vector<bool> meant(count, !is_on_nodes);
  if (is_on_nodes)
    for (const Body& body : world.bodies)
      for (const Index node : body.cells) meant[static_cast<std::size_t>(node)] = true;
  return meant;
}

}  // namespace

std::optional<Extremes> extremes(const World& world, const State& state, const FieldValues& values) {
  const FieldInfo& field = *values.field;
  if (field.kind == FieldInfo::Kind::tensor || field.is_direction()) return std::nullopt;
  const std::size_t count = values.values.size() / static_cast<std::size_t>(field.components());
  const std::vector<bool> meant = is_meant(world, field.is_on_nodes(), count);
  double least = 0, greatest = 0;
  std::size_t place_of_least = count, place_of_greatest = count;
  for (std::size_t place = 0; place < count; ++place) {
    const auto [low, high] = range_at(values, place);
    if (!meant[place] || !std::isfinite(low) || !std::isfinite(high)) continue;
    if (place_of_least == count || low < least) {
      least = low;
      place_of_least = place;
    }
    if (place_of_greatest == count || high > greatest) {
      greatest = high;
      place_of_greatest = place;
    }
  }
  if (place_of_least == count) return std::nullopt;
  return Extremes{located(world, state, field.is_on_nodes(), least, place_of_least),
                  located(world, state, field.is_on_nodes(), greatest, place_of_greatest)};
}

}  // namespace resilin
