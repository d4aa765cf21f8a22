#include "resilin/world/body_overlap.hpp"

#include "resilin/mesh/overlap.hpp"

namespace resilin {

std::vector<BodyOverlap> overlapping_bodies(const World& world, const VectorX& x) {
  const std::span<const double> positions(x.data(), static_cast<std::size_t>(x.size()));
  const auto cells_of = [&](const Body& body) { return PlacedCells{body.cell_kind, body.cells, positions}; };
  std::vector<BodyOverlap> all;
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b)
      if (const auto found = find_overlap(cells_of(world.bodies[a]), cells_of(world.bodies[b])))
        all.push_back(
            {.body = a, .other = b, .cell = found->cell, .other_cell = found->other, .place = found->place});
  return all;
}

std::string describe(const World& world, const BodyOverlap& overlap) {
  const std::string a = "\"" + world.bodies[overlap.body].name + "\"",
                    b = "\"" + world.bodies[overlap.other].name + "\"";
  return "bodies " + a + " and " + b + " share space, cell " + std::to_string(overlap.cell) + " of " + a +
         " and cell " + std::to_string(overlap.other_cell) + " of " + b + " near " +
         world.place_text(world.origin + overlap.place);
}

}  // namespace resilin
