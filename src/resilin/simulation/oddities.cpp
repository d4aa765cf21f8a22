#include "resilin/simulation/oddities.hpp"

#include <algorithm>
#include <span>

#include "resilin/core/text.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/world/body_overlap.hpp"

namespace resilin {
namespace {

std::string inversion_text(const World& world, const Body& body, const InvertedCells& inverted) {
  return world.place + ": " + std::to_string(inverted.count) + " of " + std::to_string(body.num_cells()) +
         " cells of \"" + body.name + "\" " + (inverted.count == 1 ? "is" : "are") + " inside out, cell " +
         std::to_string(inverted.worst) + " most, with volume ratio " + format_short(inverted.ratio) +
         ": no real body does that, and " + body.law +
         " allows it; take a law that needs J > 0, such as neo_hookean, or load it less";
}

}  // namespace

InvertedCells inverted_cells(const Body& body, const VectorX& x) {
  const std::vector<double> ratios = body.elastic->volume_ratios(x);
  const auto num_points = static_cast<std::size_t>(body.elastic->num_points());
  InvertedCells found;
  for (std::size_t first = 0; first < ratios.size(); first += num_points) {
    bool is_inverted = false;
    for (const double ratio : std::span(ratios).subspan(first, num_points)) {
      if (ratio > 0) continue;
      is_inverted = true;
      if (ratio >= found.ratio) continue;
      found.ratio = ratio;
      found.worst = static_cast<Index>(first / num_points);
    }
    if (is_inverted) ++found.count;
  }
  return found;
}

std::vector<std::string> oddities(const World& world, const State& state) {
  std::vector<std::string> found;
  if (world.modes) return found;  // drawn, not reached
  for (const Body& body : world.bodies)
    if (const InvertedCells inverted = inverted_cells(body, state.positions); inverted.count > 0)
      found.push_back(inversion_text(world, body, inverted));
  if (!world.is_dynamic)
    for (const std::string& text : describe_lost_digits(world, state))
      found.push_back(world.place + ": " + text);
  const std::vector<BodyOverlap> now = overlapping_bodies(world, state.positions);
  if (now.empty()) return found;
  const std::vector<BodyOverlap> before = overlapping_bodies(world, world.start_positions);
  for (const BodyOverlap& overlap : now) {
    const bool is_old = std::ranges::any_of(before, [&](const BodyOverlap& other) {
      return other.body == overlap.body && other.other == overlap.other;
    });
    if (!is_old)
      found.push_back(world.place + ": " + describe(world, overlap) + ": they went through each other, " +
                      (world.meet(overlap.body, overlap.other)
                           ? "although contact keeps them apart: this is a fault of the program"
                           : "for they are not to meet ([contact])"));
  }
  return found;
}

}  // namespace resilin
