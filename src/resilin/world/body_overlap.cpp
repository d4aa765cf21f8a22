#include "resilin/world/body_overlap.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resilin/contact/crossing.hpp"
#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/overlap.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {

namespace {

/// A vertex of one of two bodies that is inside the surface of the other, where none cross.
std::optional<Vector3> place_inside(const World& world, const SurfaceContact& contact, Index body,
                                    Index other, const VectorX& places) {
  const CollisionSurface& parts = contact.surface().parts;
  for (const auto& [in, around] : {std::pair{body, other}, std::pair{other, body}}) {
    if (!has_inside(world, world.bodies[static_cast<std::size_t>(around)])) continue;
    if (const auto place = place_of_piece_inside(parts, in, around, places)) return place;
  }
  return std::nullopt;
}

Box box_around(const CollisionSurface& parts, Index body, const VectorX& places) {
  Box box;
  for (std::size_t v = 0; v < parts.num_vertices(); ++v)
    if (parts.bodies[v] == body) box.add(node_position(parts.dim, static_cast<Index>(v), places));
  return box;
}

/// Faces upon each other neither cross nor are inside; where anything touches, cells have the say.
bool surfaces_overlap(const World& world, const SurfaceContact& contact, Index body, Index other,
                      const VectorX& x) {
  BodyMeetings meetings(contact.meetings().num_bodies());
  for (Index a = 0; a < meetings.num_bodies(); ++a)
    for (Index b = 0; b < meetings.num_bodies(); ++b)
      meetings.set(a, b, std::minmax(a, b) == std::minmax(body, other));
  const VectorX places = contact.surface().places(x);
  return contact.touches(x) || first_crossing(contact.surface().parts, meetings, places) ||
         place_inside(world, contact, body, other, places);
}

/// Where cells do not tell: of bodies that meet with a skin. Skins that cross are told as surfaces.
std::optional<Vector3> place_in_both(const World& world, const SurfaceContact& contact, Index body,
                                     Index other, const VectorX& places) {
  const CollisionSurface& parts = contact.surface().parts;
  if (!box_around(parts, body, places).meets(box_around(parts, other, places))) return std::nullopt;
  return place_inside(world, contact, body, other, places);
}

}  // namespace

std::vector<BodyOverlap> overlapping_bodies(const World& world, const VectorX& x,
                                            const SurfaceContact* contact) {
  const std::span<const double> positions(x.data(), static_cast<std::size_t>(x.size()));
  const auto cells_of = [&](const Body& body) { return PlacedCells{body.cell_kind, body.cells, positions}; };
  std::vector<BodyOverlap> all;
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      const auto body = static_cast<Index>(a), other = static_cast<Index>(b);
      const bool has_skin = world.bodies[a].meets_with_skin() || world.bodies[b].meets_with_skin();
      if (contact != nullptr && has_skin && contact->meetings().meet(body, other)) {
        if (const auto place = place_in_both(world, *contact, body, other, contact->surface().places(x)))
          all.push_back({.body = a, .other = b, .place = *place});
        continue;
      }
      if (world.bodies[a].rigid || world.bodies[b].rigid)
        continue;  // cells of control nodes are no part of the body
      const auto found = find_overlap(cells_of(world.bodies[a]), cells_of(world.bodies[b]));
      if (!found) continue;
      if (contact != nullptr && !surfaces_overlap(world, *contact, body, other, x)) continue;
      all.push_back(
          {.body = a, .other = b, .cell = found->cell, .other_cell = found->other, .place = found->place});
    }
  return all;
}

std::string describe(const World& world, const BodyOverlap& overlap) {
  const std::string a = "\"" + world.bodies[overlap.body].name + "\"",
                    b = "\"" + world.bodies[overlap.other].name + "\"";
  const std::string cells = overlap.cell < 0
                                ? ""
                                : ", cell " + std::to_string(overlap.cell) + " of " + a + " and cell " +
                                      std::to_string(overlap.other_cell) + " of " + b;
  return "bodies " + a + " and " + b + " overlap" + cells + " near " +
         world.place_text(world.origin + overlap.place);
}

}  // namespace resilin
