#include "resilin/fields/cell_averages.hpp"

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_average_chunk = 1024;

}  // namespace

CellAverages::CellAverages(const World& world) : first_(static_cast<std::size_t>(world.num_nodes()) + 1, 0) {
  struct Entry {
    std::uint32_t node, cell;
    double volume;
  };
  const std::size_t count = first_.size() - 1;
  std::vector<Entry> entries;
  std::vector<double> volume_at(count, 0.0);
  std::uint32_t first_cell = 0;
  for (const Body& body : world.bodies) {
    const std::vector<double> volumes = body.domains.deformable_volumes();
    const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
    for (std::size_t i = 0; i < body.cells.size(); ++i) {
      const auto node = static_cast<std::uint32_t>(body.cells[i]);
      entries.push_back({node, first_cell + static_cast<std::uint32_t>(i / width), volumes[i / width]});
      volume_at[node] += volumes[i / width];
      ++first_[node + 1];
    }
    first_cell += static_cast<std::uint32_t>(volumes.size());
  }
  for (std::size_t node = 0; node < count; ++node) first_[node + 1] += first_[node];
  cells_at_.resize(entries.size());
  shares_.resize(entries.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Entry& entry : entries) {
    const std::uint32_t place = next[entry.node]++;
    cells_at_[place] = entry.cell;
    shares_[place] = entry.volume > 0 ? entry.volume / volume_at[entry.node] : 0;
  }
}

std::vector<double> CellAverages::at_nodes(std::span<const double> cell_values,
                                           std::size_t components) const {
  std::vector<double> values((first_.size() - 1) * components, 0.0);
  parallel_for(first_.size() - 1, nodes_per_average_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node)
      for (std::uint32_t i = first_[node]; i < first_[node + 1]; ++i)
        for (std::size_t k = 0; k < components; ++k)
          values[node * components + k] += shares_[i] * cell_values[cells_at_[i] * components + k];
  });
  return values;
}

}  // namespace resilin
