#include "resilin/world/contact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "resilin/contact/crossing.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/body_overlap.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

/// Layers between bodies are so much stiffer than those on colliders: bodies hit each other with corners and
/// ridges, by which soft layers are nearly used up, and Newton's method then needs many iterations.
constexpr double between_bodies = 10;
/// Share of the thinnest gap of a body to itself at rest: where its own parts begin to feel each other.
constexpr double share_of_gap = 0.5;

Index body_called(const World& world, const std::string& name, const std::string& place) {
  return static_cast<Index>(find_body(world, name, place + ".bodies"));
}

/// Whether contact of a pair acts in a phase.
bool acts_in(const ContactPairDescription& pair, const World& world, std::size_t phase) {
  const auto past = phase == 0 ? pair.switches.begin()
                               : std::ranges::upper_bound(pair.switches, world.switch_times[phase - 1]);
  return pair.is_enabled == ((past - pair.switches.begin()) % 2 == 0);
}

BodyMeetings meetings_in(const ContactDescription& description, const World& world, std::size_t phase) {
  BodyMeetings meetings(static_cast<Index>(world.bodies.size()), description.with_themselves);
  for (const ContactPairDescription& pair : description.pairs)
    meetings.set(body_called(world, pair.bodies[0], pair.place),
                 body_called(world, pair.bodies[1], pair.place), acts_in(pair, world, phase));
  return meetings;
}

/// Meetings by phase: one, unless steps switch contact pairs.
std::vector<BodyMeetings> meetings_of(const ContactDescription& description, const World& world) {
  const bool is_switched =
      std::ranges::any_of(description.pairs, [](const auto& pair) { return !pair.switches.empty(); });
  const std::size_t num_phases = is_switched ? world.switch_times.size() + 1 : 1;
  std::vector<BodyMeetings> all;
  for (std::size_t phase = 0; phase < num_phases; ++phase)
    all.push_back(meetings_in(description, world, phase));
  return all;
}

/// Bodies that meet in any phase.
BodyMeetings meetings_in_any(const std::vector<BodyMeetings>& phases) {
  BodyMeetings any = phases.front();
  for (const BodyMeetings& meetings : phases)
    for (Index a = 0; a < any.num_bodies(); ++a)
      for (Index b = 0; b <= a; ++b)
        if (meetings.meet(a, b)) any.set(a, b, true);
  return any;
}

bool any_meet(const BodyMeetings& meetings) {
  const Index n = meetings.num_bodies();
  return std::any_of(meetings.table(), meetings.table() + static_cast<std::ptrdiff_t>(n) * n,
                     [](unsigned char meet) { return meet != 0; });
}

bool any_meets_itself(const BodyMeetings& meetings) {
  for (Index body = 0; body < meetings.num_bodies(); ++body)
    if (meetings.meet(body, body)) return true;
  return false;
}

/// Coefficients of each body with each, row by row; empty where all are zero.
std::vector<double> friction_of(const ContactDescription& description, World& world) {
  const std::size_t n = world.bodies.size();
  check_friction(description.friction, description.place + ".friction", world);
  std::vector<double> table(n * n, description.friction);
  for (const ContactPairDescription& pair : description.pairs) {
    if (!pair.friction) continue;
    check_friction(*pair.friction, pair.place + ".friction", world);
    const auto a = static_cast<std::size_t>(body_called(world, pair.bodies[0], pair.place));
    const auto b = static_cast<std::size_t>(body_called(world, pair.bodies[1], pair.place));
    table[a * n + b] = table[b * n + a] = *pair.friction;
  }
  if (std::ranges::all_of(table, [](double coefficient) { return coefficient == 0; })) table.clear();
  return table;
}

/// Reach of the surface of a body.
Reach reach_along(int axis, const CollisionSurface& parts, Index body, const VectorX& places) {
  Reach reach{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t v = 0; v < parts.num_vertices(); ++v) {
    if (parts.bodies[v] != body) continue;
    const double at = places[static_cast<Eigen::Index>(v) * parts.dim + axis];
    reach = {std::min(reach.low, at), std::max(reach.high, at)};
  }
  return reach;
}

void check_fits_bodies(double activation_distance, const World& world, const std::string& place) {
  for (const Body& body : world.bodies) {
    const double half = 0.5 * thinnest_extent(world, body);
    if (activation_distance < half) continue;
    throw InputError(
        place + ".activation_distance",
        "less than half the thickness of every body, " + format_short(half) + " m for \"" + body.name + "\"",
        format_number(activation_distance), "leave it out for an automatic choice");
  }
}

/// How far along one axis the second body has to go for the box around its surface to leave that of the
/// first.
Vector3 way_apart(const SurfaceContact& contact, const World& world, Index body, Index other, double gap) {
  const VectorX places = contact.surface().places(world.start_positions);
  Vector3 way = Vector3::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < world.dimension; ++k) {
    const Reach a = reach_along(k, contact.surface().parts, body, places);
    const Reach b = reach_along(k, contact.surface().parts, other, places);
    for (const double along : {a.high - b.low + gap, a.low - b.high - gap}) {
      if (!(std::abs(along) < least)) continue;
      least = std::abs(along);
      way = along * Vector3::Unit(k);
    }
  }
  return way;
}

std::string cure(const SurfaceContact& contact, const World& world, Index body, Index other) {
  if (body == other) return "separate the parts of the body, or leave `self` out";
  const Vector3 way = way_apart(contact, world, body, other, 0.5 * contact.activation_distance());
  return "move \"" + world.bodies[static_cast<std::size_t>(other)].name + "\" by " + world.place_text(way) +
         " (translate), or disable contact: [contact] enabled = false, or a [[contact.pair]] of these two";
}

std::string both(const World& world, Index body, Index other) {
  const auto name = [&](Index b) { return '"' + world.bodies[static_cast<std::size_t>(b)].name + '"'; };
  return body == other ? "parts of " + name(body) : name(body) + " and " + name(other);
}

/// Checks of bodies that meet at the start.
class StartCheck {
 public:
  StartCheck(const SurfaceContact& contact, const World& world, std::string place)
      : contact_(contact), world_(world), place_(std::move(place)), parts_(contact.surface().parts) {}

  void check_overlaps() const {
    for (const BodyOverlap& overlap : overlapping_bodies(world_, world_.start_positions, &contact_)) {
      const auto body = static_cast<Index>(overlap.body), other = static_cast<Index>(overlap.other);
      if (contact_.meetings().meet(body, other))
        throw InputError(place_, "bodies that start apart", describe(world_, overlap),
                         cure(contact_, world_, body, other));
    }
  }

  void check_crossings() const {
    const VectorX places = contact_.surface().places(world_.start_positions);
    const auto crossing = first_crossing(parts_, contact_.meetings(), places);
    if (!crossing) return;
    const auto [vertex, other] = vertices_of(*crossing, parts_);
    const Index a = body_of(vertex), b = body_of(other);
    throw InputError(place_, "surfaces that start apart",
                     both(world_, a, b) + " penetrate each other near " + world_.place_text(vertex, places),
                     cure(contact_, world_, a, b));
  }

  void check_gap() const {
    if (!contact_.touches(world_.start_positions)) return;
    const SurfaceContact::Gap nearest = contact_.smallest_gap(world_.start_positions);
    const VectorX places = contact_.surface().places(world_.start_positions);
    const Index vertex = nearest.vertices[0];
    const Index other = nearest.vertices[static_cast<std::size_t>(num_first(nearest.kind))];
    const Index a = body_of(vertex), b = body_of(other);
    throw InputError(place_, "surfaces that start with a gap",
                     both(world_, a, b) + " touch near " + world_.place_text(vertex, places) + " and " +
                         world_.place_text(other, places),
                     cure(contact_, world_, a, b));
  }

 private:
  Index body_of(Index vertex) const { return parts_.bodies[static_cast<std::size_t>(vertex)]; }

  const SurfaceContact& contact_;
  const World& world_;
  std::string place_;
  const CollisionSurface& parts_;
};

/// How far apart a body's own parts are at rest, up to `distance`.
double thinnest_gap(const ContactSurface& surface, const BodyMeetings& meetings, double distance,
                    const World& world, const std::string& place) {
  const VectorX& rest = world.contact_shape();
  const SurfaceContact contact("gap", surface, meetings, distance, rest);
  const SurfaceContact::Gap gap = contact.smallest_gap(rest);
  if (!contact.touches(rest)) return gap.distance;
  const Index vertex = gap.vertices[0];
  const Index body = surface.parts.bodies[static_cast<std::size_t>(vertex)];
  throw InputError(place, "bodies without self-contact in the reference configuration",
                   both(world, body, body) + " touch near " + world.place_text(vertex, surface.places(rest)),
                   "merge coincident vertices, or leave `self` out");
}

}  // namespace

std::shared_ptr<const SurfaceContact> make_contact(const ContactDescription& description, World& world) {
  if (description.activation_distance)
    require_positive(*description.activation_distance, description.place + ".activation_distance");
  if (description.stiffness) require_positive(*description.stiffness, description.place + ".stiffness");
  world.contact_of_phases.clear();
  const std::vector<BodyMeetings> phases = meetings_of(description, world);
  const BodyMeetings meetings = meetings_in_any(phases);
  std::vector<double> friction = friction_of(description, world);
  if (!description.is_enabled || !any_meet(meetings) || world.modes) return nullptr;
  std::vector<ContactBody> bodies = contact_bodies(world, description.stiffness);
  if (!description.stiffness)
    for (ContactBody& body : bodies) body.stiffness *= between_bodies;
  const ContactSurface surface =
      make_contact_surface(world.dimension, bodies, world.contact_shape(), {}, depth_of(world));
  double distance = description.activation_distance.value_or(default_activation_distance(world));
  check_fits_bodies(distance, world, description.place);
  if (any_meets_itself(meetings)) {
    BodyMeetings alone(meetings.num_bodies());
    for (Index a = 0; a < alone.num_bodies(); ++a)
      for (Index b = 0; b < alone.num_bodies(); ++b) alone.set(a, b, a == b && meetings.meet(a, a));
    const double gap = thinnest_gap(surface, alone, distance, world, description.place);
    if (gap < distance && description.activation_distance)
      throw InputError(description.place + ".activation_distance",
                       "less than the thinnest gap of self-contact in the reference configuration, " +
                           format_short(gap) + " m",
                       format_number(distance), "leave it out for an automatic choice");
    distance = std::min(distance, share_of_gap * gap);
  }
  std::shared_ptr<SurfaceContact> contact;
  for (const BodyMeetings& of_phase : phases) {
    auto next =
        std::make_shared<SurfaceContact>("contact", surface, of_phase, distance, world.start_positions);
    if (!friction.empty()) next->set_friction(friction);
    if (!contact) contact = next;
    if (phases.size() > 1) world.contact_of_phases.push_back(std::move(next));
  }
  const StartCheck start(*contact, world, description.place);
  start.check_overlaps();
  start.check_crossings();
  start.check_gap();
  return contact;
}

void use_contact(World& world, const std::shared_ptr<const SurfaceContact>& contact) {
  if (contact == world.contact) return;
  world.terms[world.find_term({TermOrigin::Kind::contact}).value()] = contact;
  if (world.friction) {
    std::vector<std::shared_ptr<const FrictionSource>> sources = world.friction->sources();
    std::ranges::replace(sources, std::shared_ptr<const FrictionSource>(world.contact),
                         std::shared_ptr<const FrictionSource>(contact));
    world.friction = std::make_shared<Friction>(world.dimension, std::move(sources), world.friction->speed(),
                                                world.friction->factors());
    world.terms[world.find_term({TermOrigin::Kind::friction}).value()] = world.friction;
  }
  world.contact = contact;
}

std::string overlap_of_begun_contact(const World& world, const SurfaceContact& before,
                                     const VectorX& positions) {
  const SurfaceContact& contact = *world.contact;
  const CollisionSurface& parts = contact.surface().parts;
  const auto begins = [&](Index a, Index b) {
    return contact.meetings().meet(a, b) && !before.meetings().meet(a, b);
  };
  for (const BodyOverlap& overlap : overlapping_bodies(world, positions, &contact))
    if (begins(static_cast<Index>(overlap.body), static_cast<Index>(overlap.other)))
      return describe(world, overlap);
  BodyMeetings begun(contact.meetings().num_bodies());
  for (Index a = 0; a < begun.num_bodies(); ++a)
    for (Index b = 0; b <= a; ++b) begun.set(a, b, begins(a, b));
  const VectorX places = contact.surface().places(positions);
  const auto told = [&](Index vertex, Index other, const char* what) {
    return both(world, parts.bodies[static_cast<std::size_t>(vertex)],
                parts.bodies[static_cast<std::size_t>(other)]) +
           what + world.place_text(vertex, places);
  };
  if (const auto crossing = first_crossing(parts, begun, places)) {
    const auto [vertex, other] = vertices_of(*crossing, parts);
    return told(vertex, other, " penetrate each other near ");
  }
  const SurfaceContact of_begun("contact", contact.surface(), begun, contact.activation_distance(),
                                positions);
  if (!of_begun.touches(positions)) return "";
  const SurfaceContact::Gap nearest = of_begun.smallest_gap(positions);
  return told(nearest.vertices[0], nearest.vertices[static_cast<std::size_t>(num_first(nearest.kind))],
              " touch near ");
}

void change_contact(World& world, const ContactDescription& description) {
  World changed = world;
  for (const TermOrigin::Kind kind : {TermOrigin::Kind::contact, TermOrigin::Kind::friction})
    if (const auto number = changed.find_term({kind})) {
      changed.terms.erase(changed.terms.begin() + static_cast<std::ptrdiff_t>(*number));
      changed.origins.erase(changed.origins.begin() + static_cast<std::ptrdiff_t>(*number));
    }
  const auto add = [&changed](const std::shared_ptr<const Energy>& term, TermOrigin::Kind kind) {
    if (!term) return;
    changed.terms.insert(changed.terms.begin() + static_cast<std::ptrdiff_t>(changed.origins.size()), term);
    changed.origins.push_back({kind});
  };
  ContactDescription wished = description;
  for (const auto& [origin, distance] : world.shorter_distances)
    if (origin.kind == TermOrigin::Kind::contact && !wished.activation_distance)
      wished.activation_distance = distance;
  changed.contact = make_contact(wished, changed);
  add(changed.contact, TermOrigin::Kind::contact);
  changed.friction = make_friction(wished, changed);
  add(changed.friction, TermOrigin::Kind::friction);
  changed.warnings = world.warnings;
  changed.made_from.reset();
  world = std::move(changed);
}

}  // namespace resilin
