#include "resilin/results/frame_history.hpp"

#include <algorithm>

namespace resilin {
namespace {

Eigen::Index width_of(const Domain& domain) {
  const Index num_cells = domain.energy->num_cells();
  return domain.history && num_cells > 0 ? domain.history->num_history_values() / num_cells : 0;
}

/// Calls `copy(first in the history, first by cell, count)` for each cell that has internal variables. Terms
/// of domains stand body after body.
template <class Copy>
void for_each_cell(const World& world, const Copy& copy) {
  const Eigen::Index width = history_width(world);
  Eigen::Index in_history = 0, body_begin = 0;
  for (const Body& body : world.bodies) {
    for (const Domain& domain : body.domains) {
      const Eigen::Index count = width_of(domain);
      for (Index cell = 0; count > 0 && cell < domain.energy->num_cells(); ++cell, in_history += count)
        copy(in_history, body_begin + width * domain.number_of(cell), count);
    }
    body_begin += width * body.num_cells();
  }
}

}  // namespace

int history_width(const World& world) {
  Eigen::Index width = 0;
  for (const Body& body : world.bodies)
    for (const Domain& domain : body.domains) width = std::max(width, width_of(domain));
  return static_cast<int>(width);
}

std::vector<double> history_by_cell(const World& world, const VectorX& history) {
  std::size_t num_cells = 0;
  for (const Body& body : world.bodies) num_cells += static_cast<std::size_t>(body.num_cells());
  std::vector<double> by_cell(num_cells * static_cast<std::size_t>(history_width(world)), 0.0);
  for_each_cell(world, [&](Eigen::Index from, Eigen::Index to, Eigen::Index count) {
    std::copy_n(history.data() + from, count, by_cell.data() + to);
  });
  return by_cell;
}

VectorX history_of_cells(const World& world, const std::vector<double>& by_cell) {
  VectorX history = VectorX::Zero(world.num_history_values());
  for_each_cell(world, [&](Eigen::Index to, Eigen::Index from, Eigen::Index count) {
    std::copy_n(by_cell.data() + from, count, history.data() + to);
  });
  return history;
}

}  // namespace resilin
