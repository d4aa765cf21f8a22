#include "resilin/view/surface_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/parallel.hpp"
#include "resilin/fields/quantities.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 1024;

}  // namespace

std::vector<ScalarField> SurfaceFields::quick(int dimension) {
  std::vector<ScalarField> quick = scalar_fields(dimension);
  std::erase_if(quick, [](const ScalarField& field) {
    return field.field->is_on_nodes && field.field->name.starts_with(nodal_prefix);
  });
  return quick;
}

SurfaceFields::SurfaceFields(const World& world, const ShownSurface& surface)
    : surface_(surface), nodal_(static_cast<std::size_t>(world.num_nodes())), first_(nodal_.size() + 1, 0) {
  struct Entry {
    std::uint32_t node, cell;
    double volume;
  };
  std::vector<Entry> entries;
  std::vector<double> volume_at(nodal_.size(), 0.0);
  std::uint32_t first_cell = 0;
  for (const Body& body : world.bodies) {
    const std::vector<double> volumes = body.elastic->rest_volumes();
    const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
    for (std::size_t i = 0; i < body.cells.size(); ++i) {
      const auto node = static_cast<std::uint32_t>(body.cells[i]);
      entries.push_back({node, first_cell + static_cast<std::uint32_t>(i / width), volumes[i / width]});
      volume_at[node] += volumes[i / width];
      ++first_[node + 1];
    }
    first_cell += static_cast<std::uint32_t>(volumes.size());
  }
  for (std::size_t node = 0; node < nodal_.size(); ++node) first_[node + 1] += first_[node];
  cells_at_.resize(entries.size());
  shares_.resize(entries.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Entry& entry : entries) {
    const std::uint32_t place = next[entry.node]++;
    cells_at_[place] = entry.cell;
    shares_[place] = entry.volume / volume_at[entry.node];
  }
}

void SurfaceFields::evaluate(const World& world, const State& state, std::string_view name,
                             std::span<float> out) {
  const ScalarField field = require_scalar_field(name, world.dimension, "field");
  FieldEvaluator evaluator(world);
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
    for (std::size_t node = begin; node < end; ++node)
      nodal_[node] =
          field.field->is_on_nodes ? field.at(values.values, node) : mean_at(field, values.values, node);
  });
  surface_.interpolate(nodal_, out);
  for (float& value : out)
    if (!std::isfinite(value)) value = std::numeric_limits<float>::quiet_NaN();
}

double SurfaceFields::mean_at(const ScalarField& field, std::span<const double> values,
                              std::size_t node) const {
  double sum = 0;
  for (std::uint32_t i = first_[node]; i < first_[node + 1]; ++i)
    sum += shares_[i] * field.at(values, cells_at_[i]);
  return sum;
}

}  // namespace resilin
