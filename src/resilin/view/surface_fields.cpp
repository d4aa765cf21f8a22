#include "resilin/view/surface_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/evaluator.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 1024;

bool is_known(const FieldInfo& field) {
  // The length of a vector is shown; directions, which have no unit, have none to show.
  const bool is_of_node = field.is_on_nodes && field.kind == FieldInfo::Kind::vector && !field.unit.empty();
  const bool is_of_cell = !field.is_on_nodes && field.kind == FieldInfo::Kind::scalar;
  return is_of_node || is_of_cell;
}

}  // namespace

std::vector<const FieldInfo*> SurfaceFields::known() {
  std::vector<const FieldInfo*> known;
  for (const FieldInfo& field : fields())
    if (is_known(field)) known.push_back(&field);
  return known;
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
  const FieldInfo& field = require_field(name, "field");
  if (!is_known(field)) {
    std::vector<std::string> names;
    for (const FieldInfo* info : known()) names.push_back(info->name);
    throw InputError("field", "one of " + join(names), "\"" + std::string(name) + "\"");
  }
  const FieldValues found = FieldEvaluator(world).evaluate(state, std::vector{std::string(name)}).front();
  parallel_for(nodal_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node)
      nodal_[node] = field.is_on_nodes ? length_at(found.values, node) : mean_at(found.values, node);
  });
  surface_.interpolate(nodal_, out);
  for (float& value : out)
    if (!std::isfinite(value)) value = std::numeric_limits<float>::quiet_NaN();
}

double SurfaceFields::mean_at(std::span<const double> cells, std::size_t node) const {
  double sum = 0;
  for (std::uint32_t i = first_[node]; i < first_[node + 1]; ++i) sum += shares_[i] * cells[cells_at_[i]];
  return sum;
}

double SurfaceFields::length_at(std::span<const double> vectors, std::size_t node) {
  return Eigen::Map<const Vector3>(vectors.data() + 3 * node).norm();
}

}  // namespace resilin
