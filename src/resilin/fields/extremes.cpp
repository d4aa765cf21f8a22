#include "resilin/fields/extremes.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/mesh/facet.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

/// The least and the greatest number that a place stands for.
std::pair<double, double> range_at(const FieldInfo& field, const double* values) {
  if (field.kind == FieldInfo::Kind::principal_values) return {values[2], values[0]};
  if (field.kind == FieldInfo::Kind::scalar) return {values[0], values[0]};
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

/// Nodes that no cell uses carry nothing, and those of a rigid body stand for its vertices.
std::vector<bool> is_meant(const World& world, bool is_on_nodes, std::size_t count) {
  std::vector<bool> meant(count, !is_on_nodes);
  if (is_on_nodes)
    for (const Body& body : world.bodies)
      for (const Index node : body.rigid ? SharedIndices() : body.cells)
        meant[static_cast<std::size_t>(node)] = true;
  return meant;
}

}  // namespace

std::optional<Extremes> extremes(const World& world, const State& state, const FieldValues& values) {
  const FieldInfo& field = *values.field;
  if (field.kind == FieldInfo::Kind::tensor || field.is_direction()) return std::nullopt;
  const std::size_t count = values.values.size() / static_cast<std::size_t>(field.components());
  const std::vector<bool> meant = is_meant(world, field.is_on_nodes(), count);
  Extremes found;
  bool is_found = false;
  const auto look_at = [&](const double* numbers, const auto& where) {
    const auto [low, high] = range_at(field, numbers);
    if (!std::isfinite(low) || !std::isfinite(high)) return;
    if (!is_found || low < found.min.value) found.min = where(low);
    if (!is_found || high > found.max.value) found.max = where(high);
    is_found = true;
  };
  const auto width = static_cast<std::size_t>(field.components());
  for (std::size_t place = 0; place < count; ++place)
    if (meant[place])
      look_at(values.values.data() + place * width,
              [&](double value) { return located(world, state, field.is_on_nodes(), value, place); });
  for (std::size_t b = 0; field.is_on_nodes() && b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (!body.rigid || body.rigid->is_region()) continue;
    const std::vector<double> carried =
        body.rigid->at_vertices(values.values, field.components(), body.first_node);
    const CarriedPoints points = body.rigid->carried_vertices(body.first_node);
    for (Index v = 0; v < points.num_points(); ++v)
      look_at(carried.data() + static_cast<std::size_t>(v) * width, [&](double value) {
        return Extreme{value, b, v, world.origin + points.at(world.dimension, v, state.positions)};
      });
  }
  if (!is_found) return std::nullopt;
  return found;
}

}  // namespace resilin
