#include "resilin/view/surface_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 1024;

}  // namespace

std::vector<ScalarField> SurfaceFields::quick(int dimension) {
  std::vector<ScalarField> quick = vertex_fields(dimension);
  std::erase_if(quick,
                [](const ScalarField& field) { return field.field->source == FieldInfo::Source::fit; });
  return quick;
}

SurfaceFields::SurfaceFields(const World& world, const ShownSurface& surface)
    : surface_(surface),
      nodal_(static_cast<std::size_t>(world.num_nodes())),
      averages_(std::make_shared<const CellAverages>(world)) {
  for (const Body& body : world.bodies) {
    const auto begin = static_cast<std::size_t>(body.first_node);
    nodes_of_.push_back({begin, begin + static_cast<std::size_t>(body.num_nodes), body.rigid != nullptr});
    has_rigid_bodies_ = has_rigid_bodies_ || body.rigid != nullptr;
  }
}

void SurfaceFields::evaluate(const World& world, const State& state, std::string_view name,
                             std::span<float> out) {
  const ScalarField field = require_vertex_field(name, world.dimension, "field");
  FieldEvaluator evaluator(world, averages_);
  carry(field, evaluator.evaluate(state, {&field.field->name, 1}).front(), out);
}

void SurfaceFields::evaluate(FieldEvaluator& evaluator, const State& state,
                             std::span<const ScalarField> fields, std::span<std::vector<float>> out) {
  std::vector<std::string> names;
  for (const ScalarField& field : fields)
    if (std::ranges::find(names, field.field->name) == names.end()) names.push_back(field.field->name);
  const std::vector<FieldValues> values = evaluator.evaluate(state, names);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto found = std::ranges::find(names, fields[i].field->name) - names.begin();
    out[i].resize(static_cast<std::size_t>(surface_.num_vertices()));
    carry(fields[i], values[static_cast<std::size_t>(found)], out[i]);
  }
}

void SurfaceFields::carry(const ScalarField& field, const FieldValues& values, std::span<float> out) {
  parallel_for(nodal_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) nodal_[node] = field.at(values.values, node);
  });
  surface_.interpolate(nodal_, out);
  if (has_rigid_bodies_ && field.component < 0 && field.field->kind == FieldInfo::Kind::vector)
    carry_lengths(values, out);
  keep_skins_within_their_bodies(out);
  for (float& value : out)
    if (!std::isfinite(value)) value = std::numeric_limits<float>::quiet_NaN();
}

void SurfaceFields::carry_lengths(const FieldValues& values, std::span<float> out) {
  std::vector<float> component(out.size()), squares(out.size(), 0.0F);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t node = 0; node < nodal_.size(); ++node) nodal_[node] = values.values[3 * node + k];
    surface_.interpolate(nodal_, component);
    for (std::size_t v = 0; v < out.size(); ++v) squares[v] += component[v] * component[v];
  }
  for (const ShownSurface::Part& part : surface_.parts()) {
    if (!nodes_of_[part.body].is_rigid) continue;
    for (auto v = static_cast<std::size_t>(part.first_vertex);
         v < static_cast<std::size_t>(part.first_vertex + part.num_vertices); ++v)
      out[v] = std::sqrt(squares[v]);
  }
}

void SurfaceFields::keep_skins_within_their_bodies(std::span<float> out) const {
  for (const ShownSurface::Part& part : surface_.parts()) {
    if (part.kind != ShownSurface::Kind::skin || nodes_of_[part.body].is_rigid) continue;
    auto least = std::numeric_limits<float>::infinity(), greatest = -least;
    for (std::size_t node = nodes_of_[part.body].begin; node < nodes_of_[part.body].end; ++node) {
      if (!std::isfinite(nodal_[node])) continue;
      least = std::min(least, static_cast<float>(nodal_[node]));
      greatest = std::max(greatest, static_cast<float>(nodal_[node]));
    }
    for (float& value : out.subspan(static_cast<std::size_t>(part.first_vertex),
                                    static_cast<std::size_t>(part.num_vertices)))
      if (std::isfinite(value) && least <= greatest) value = std::clamp(value, least, greatest);
  }
}

}  // namespace resilin
