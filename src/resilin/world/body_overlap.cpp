#include "resilin/world/body_overlap.hpp"

#include <algorithm>

#include "resilin/contact/crossing.hpp"
#include "resilin/mesh/overlap.hpp"

namespace resilin {

namespace {

/// Faces upon each other neither cross nor are inside; where anything touches, cells have the say.
bool surfaces_overlap(const SurfaceContact& contact, Index body, Index other, const VectorX& x) {
  BodyMeetings meetings(contact.meetings().num_bodies());
  for (Index a = 0; a < meetings.num_bodies(); ++a)
    for (Index b = 0; b < meetings.num_bodies(); ++b)
      meetings.set(a, b, std::minmax(a, b) == std::minmax(body, other));
  const VectorX places = contact.surface().places(x);
  return contact.touches(x) || first_crossing(contact.surface().parts, meetings, places) ||
         is_one_inside(contact.surface().parts, body, other, places);
}

}  // namespace

std::vector<BodyOverlap> overlapping_bodies(const World& world, const VectorX& x,
                                            const SurfaceContact* contact) {
  const std::span<const double> positions(x.data(), static_cast<std::size_t>(x.size()));
  const auto cells_of = [&](const Body& body) { return PlacedCells{body.cell_kind, body.cells, positions}; };
  std::vector<BodyOverlap> all;
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      const auto found = find_overlap(cells_of(world.bodies[a]), cells_of(world.bodies[b]));
      if (!found) continue;
      if (contact != nullptr && !surfaces_overlap(*contact, static_cast<Index>(a), static_cast<Index>(b), x))
        continue;
      all.push_back(
          {.body = a, .other = b, .cell = found->cell, .other_cell = found->other, .place = found->place});
    }
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
