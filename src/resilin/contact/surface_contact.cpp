#include "resilin/contact/surface_contact.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "resilin/collision/collision_time.hpp"
#include "resilin/contact/pressing_forces.hpp"
#include "resilin/contact/second_order_forces.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/integrator/stage.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Share of the activation distance: what is nearer counts as touching.
constexpr double touching = 1e-6;

std::span<const double> numbers(const VectorX& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

}  // namespace

SurfaceContact::SurfaceContact(std::string name, ContactSurface surface, BodyMeetings meetings,
                               double activation_distance, const VectorX& positions)
    : name_(std::move(name)),
      surface_(std::make_shared<const ContactSurface>(std::move(surface))),
      barrier_{activation_distance},
      trees_(std::make_shared<const BroadPhase>(
          surface_->parts, std::move(meetings),
          moving_points(surface_->parts.dim, numbers(surface_->places(positions))))) {}

bool SurfaceContact::State::is_of(const VectorX& positions, const Conditions& c) const {
  return x.size() > 0 && time == c.time && delay == c.delay && x == positions;
}

template <class Use>
auto SurfaceContact::with_memory(const Use& use) const {
  if (memory_) return use(*memory_);
  Memory memory{.search = {trees_, barrier_.activation_distance}};
  return use(memory);
}

void SurfaceContact::cover(Memory& memory, const VectorX& from, const VectorX& to) const {
  const Stopwatch watch(timing_->search);
  if (memory.search.cover(from, to))
    for (State& state : memory.states) state.x.resize(0);  // they know of other candidates
}

void SurfaceContact::find_terms(Memory& memory, State& state) const {
  const Stopwatch watch(timing_->barrier);
  const SurfaceCandidates& candidates = memory.search.candidates();
  state.near = near_candidates(*surface_, candidates, state.places, barrier_.activation_distance);
  state.all = contact_terms(*surface_, candidates, state.near, barrier_.activation_distance);
  state.merged = merged_terms(*surface_, state.all, state.places);
  state.gradient.resize(0);
}

SurfaceContact::State& SurfaceContact::state_at(Memory& memory, const VectorX& x, const Conditions& c) const {
  auto& [newer, older] = memory.states;
  if (newer.is_of(x, c)) return newer;
  std::swap(newer, older);
  if (newer.is_of(x, c)) return newer;
  newer.places = surface_->places(x, c);
  cover(memory, newer.places, newer.places);
  newer.x = x;
  newer.time = c.time;
  newer.delay = c.delay;
  find_terms(memory, newer);
  return newer;
}

double SurfaceContact::value(const VectorX& x, const Conditions& c) const {
  return with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    const Stopwatch watch(timing_->barrier);
    return c.weight * sum_of_values(set_of(state), state.places);
  });
}

double SurfaceContact::difference(Memory& memory, const VectorX& from, const VectorX& to,
                                  const Conditions& c) const {
  const auto is_known = [&](const VectorX& x) {
    return std::ranges::any_of(memory.states, [&](const State& state) { return state.is_of(x, c); });
  };
  // Both states by the same candidates.
  if (!is_known(from) || !is_known(to)) cover(memory, surface_->places(from, c), surface_->places(to, c));
  state_at(memory, from, c);
  const State& after = state_at(memory, to, c);
  const State& before = memory.states[1];
  const Stopwatch watch(timing_->barrier);
  std::vector<ContactTerm> terms;
  if (before.near == after.near) {
    terms = terms_of_change(before.all, before.merged, after.merged);
  } else {
    NearCandidates near = before.near;
    near |= after.near;
    terms = contact_terms(*surface_, memory.search.candidates(), near, barrier_.activation_distance).terms;
  }
  return c.weight * sum_of_differences({*surface_, terms}, before.places, after.places);
}

double SurfaceContact::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  if (from == to) return 0;
  return with_memory([&](Memory& memory) { return difference(memory, from, to, c); });
}

const VectorX& SurfaceContact::gradient_at(Memory& memory, const VectorX& x, const Conditions& c) const {
  State& state = state_at(memory, x, c);
  const Stopwatch watch(timing_->barrier);
  if (state.gradient.size() == 0) state.gradient = sum_of_gradients(set_of(state), state.places);
  return state.gradient;
}

VectorX SurfaceContact::vertex_gradient(const VectorX& x, const Conditions& c) const {
  return with_memory([&](Memory& memory) { return VectorX(c.weight * gradient_at(memory, x, c)); });
}

void SurfaceContact::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  with_memory([&](Memory& memory) {
    if (state_at(memory, x, c).merged.terms.empty()) return;
    surface_->add_to_nodes(c.weight * gradient_at(memory, x, c), gradient);
  });
}

void SurfaceContact::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    const VectorX of_vertices = sum_of_gradients(set_of(state), state.places, GradientParts::magnitudes);
    surface_->add_magnitudes_to_nodes(c.weight * of_vertices, magnitude);
  });
}

void SurfaceContact::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                                 BlockMatrix& hessian) const {
  with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    const Stopwatch watch(timing_->barrier);
    add_node_hessian(set_of(state), state.places, c.weight, projection, hessian);
  });
}

void SurfaceContact::add_parameter_slopes(std::string_view /*name*/, const VectorX& x, const VectorX& w,
                                          const Conditions& c, VectorX& slopes) const {
  with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    const TermSet set = set_of(state);
    const std::vector<double> along = slopes_along(set, state.places, surface_->displacements(w));
    for (std::size_t k = 0; k < along.size(); ++k) {
      const SofterBodies softer = softer_bodies(*surface_, set.terms[k]);
      for (std::size_t side = 0; side < 2; ++side)
        slopes[softer.bodies[side]] += c.weight * softer.shares[side] * along[k];
    }
  });
}

void SurfaceContact::add_parameter_forces(std::string_view /*name*/, const VectorX& x, const VectorX& change,
                                          const Conditions& c, VectorX& gradient) const {
  with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    std::vector<ContactTerm> changes = state.merged.terms;
    for (ContactTerm& term : changes) {
      const SofterBodies softer = softer_bodies(*surface_, term);
      term.stiffness *=
          softer.shares[0] * change[softer.bodies[0]] + softer.shares[1] * change[softer.bodies[1]];
    }
    surface_->add_to_nodes(c.weight * sum_of_gradients({*surface_, changes}, state.places), gradient);
  });
}

double SurfaceContact::free_share(Memory& memory, const VectorX& places, const VectorX& displacements,
                                  double share_left) const {
  cover(memory, places, places + displacements);
  const Stopwatch watch(timing_->detection);
  const std::vector<MovingPoint> ways =
      moving_points(surface_->parts.dim, numbers(places), numbers(displacements));
  double share = 1;
  for (const PairKind kind : {PairKind::point_edge, PairKind::point_triangle, PairKind::edge_edge})
    share = std::min(share, earliest_collision_time(memory.search.candidates().list(kind, surface_->parts),
                                                    ways, {.share_left = share_left}));
  return share;
}

double SurfaceContact::free_share(const VectorX& places, const VectorX& displacements,
                                  double share_left) const {
  return with_memory([&](Memory& memory) { return free_share(memory, places, displacements, share_left); });
}

double SurfaceContact::max_step(const VectorX& x, const VectorX& p, const Conditions& c) const {
  return with_memory([&](Memory& memory) {
    return free_share(memory, surface_->places(x, c), surface_->displacements(p),
                      CollisionTimeOptions().share_left);
  });
}

bool SurfaceContact::add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                                             VectorX& forces) const {
  return with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    const Stopwatch watch(timing_->detection);
    const VectorX of_vertices =
        second_order_forces({*surface_, state.all.terms}, state.places, surface_->displacements(p));
    if (of_vertices.size() == 0) return false;
    surface_->add_to_nodes(c.weight * of_vertices, forces);
    return true;
  });
}

std::unique_ptr<Energy> SurfaceContact::begin_stage(const Stage&) const {
  auto own = std::make_unique<SurfaceContact>(*this);
  own->begin_memory();
  return own;
}

void SurfaceContact::prepare(const VectorX& x, const VectorX& p, const Conditions& c) {
  if (!memory_) return;
  const VectorX places = surface_->places(x, c);
  cover(*memory_, places, places + surface_->displacements(p));
}

void SurfaceContact::set_nodes_of(const PartForce& force, std::vector<WeightedNode>& nodes) const {
  nodes.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_vertices(force.kind)); ++i)
    if (force.weights[i] != 0)
      surface_->vertices.for_each_node(force.vertices[i], [&](Index node, double share) {
        add_weight(node, share * force.weights[i], nodes);
      });
}

void SurfaceContact::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  for (const PartForce& force : part_forces(x)) {
    held.push_back({.nodes = {}, .direction = force.normal});
    set_nodes_of(force, held.back().nodes);
  }
}

std::vector<PartForce> SurfaceContact::part_forces(const VectorX& x, const Conditions& c) const {
  return with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    return resilin::part_forces(set_of(state), state.places);
  });
}

std::vector<SurfaceContact::BodyContact> SurfaceContact::body_contacts(const VectorX& x,
                                                                       const Conditions& c) const {
  const std::vector<Index>& bodies = surface_->parts.bodies;
  std::map<std::array<Index, 2>, BodyContact> contacts;
  for (const PartForce& force : part_forces(x, c)) {
    const Index first = bodies[static_cast<std::size_t>(force.vertices[0])];
    const Index second =
        bodies[static_cast<std::size_t>(force.vertices[static_cast<std::size_t>(num_first(force.kind))])];
    const auto [low, high] = std::minmax(first, second);
    BodyContact& contact =
        contacts.try_emplace({low, high}, BodyContact{.body = low, .other = high}).first->second;
    ++contact.num_pairs;
    contact.gap = std::min(contact.gap, force.distance);
    if (low != high) contact.force += (first == high ? 1 : -1) * c.weight * force.force * force.normal;
  }
  std::vector<BodyContact> list;
  for (const auto& [pair, contact] : contacts) list.push_back(contact);
  return list;
}

void SurfaceContact::add_friction_contacts(const VectorX& x, const VectorX& start, const Conditions& c,
                                           FrictionContacts& contacts) const {
  if (friction_.empty()) return;
  const CollisionSurface& parts = surface_->parts;
  const auto body_of = [&](Index v) { return parts.bodies[static_cast<std::size_t>(v)]; };
  const VectorX places = surface_->places(x, c), start_places = surface_->places(start, c);
  const std::optional<ContactObstacle>& obstacle = surface_->obstacle;
  std::vector<WeightedNode> nodes;
  for (const PartForce& force : pressing_forces(part_forces(x, c))) {
    const auto split = static_cast<std::size_t>(num_first(force.kind));
    const double coefficient = friction_[static_cast<std::size_t>(
        body_of(force.vertices[0]) * meetings().num_bodies() + body_of(force.vertices[split]))];
    FrictionContact contact{.normal = sliding_normals_->normal_at(force, start_places),
                            .limit = coefficient * force.force};
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_vertices(force.kind)); ++i) {
      const Index vertex = force.vertices[i];
      if (force.weights[i] != 0 && obstacle && surface_->is_obstacle(vertex))  // its own part of the slip
        contact.velocity -=
            force.weights[i] *
            obstacle->motion.velocity_at(node_position(parts.dim, vertex, places), c.time - c.delay);
    }
    set_nodes_of(force, nodes);
    contacts.add(contact, nodes);
  }
}

std::vector<ContactTerm> SurfaceContact::terms_at(const VectorX& x, const Conditions& c) const {
  return with_memory([&](Memory& memory) { return state_at(memory, x, c).merged.terms; });
}

VectorX SurfaceContact::vertex_hessian_times(const VectorX& x, const Conditions& c,
                                             const VectorX& displacements) const {
  return with_memory([&](Memory& memory) {
    const State& state = state_at(memory, x, c);
    return VectorX(c.weight * hessian_times(set_of(state), state.places, displacements));
  });
}

bool SurfaceContact::touches(const VectorX& x, const Conditions& c) const {
  return smallest_gap(x, c).distance <= touching * activation_distance();
}

SurfaceContact::Gap SurfaceContact::smallest_gap(const VectorX& x, const Conditions& c) const {
  return with_memory([&](Memory& memory) {
    const VectorX places = surface_->places(x, c);
    cover(memory, places, places);
    const NearestCandidate nearest = nearest_candidate(*surface_, memory.search.candidates(), places);
    if (!(nearest.distance < barrier_.activation_distance)) return Gap{};
    return Gap{nearest.distance, nearest.kind, nearest.vertices};
  });
}

}  // namespace resilin
