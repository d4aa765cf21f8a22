#include "resilin/contact/surface_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "resilin/collision/collision_time.hpp"
#include "resilin/collision/feature.hpp"
#include "resilin/contact/pair_barrier.hpp"
#include "resilin/integrator/stage.hpp"

namespace resilin {
namespace {

/// Of the activation distance, that vertices may leave the boxes of a search by.
constexpr double share_of_slack = 0.25;
/// Of the activation distance: what is nearer counts as touching.
constexpr double touching = 1e-6;

/// Where the vertices of a term are.
template <int dim>
class Places {
 public:
  Places(const ContactTerm& term, const VectorX& all) : count_(term.used_vertices().size()) {
    std::size_t k = 0;
    for (const Index v : term.used_vertices()) corners_[k++] = all.segment<dim>(Eigen::Index{v} * dim);
  }
  operator std::span<const Vector<dim>>() const { return std::span(corners_).first(count_); }

 private:
  std::array<Vector<dim>, most_pair_vertices> corners_;
  std::size_t count_;
};

std::optional<EdgeMollifier> mollifier_of(const ContactTerm& term) {
  if (term.mollifier_threshold > 0) return EdgeMollifier{term.mollifier_threshold};
  return std::nullopt;
}

template <int dim>
PairBarrier<dim> barrier_of(const ContactTerm& term, const ClampedLogBarrier& barrier,
                            const VectorX& places) {
  return {barrier, term.kind, Places<dim>(term, places), term.stiffness, mollifier_of(term)};
}

template <class Visit>
auto in_dimension(int dim, const Visit& visit) {
  return dim == 3 ? visit(std::integral_constant<int, 3>()) : visit(std::integral_constant<int, 2>());
}

std::span<const double> numbers(const VectorX& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

}  // namespace

SurfaceContact::SurfaceContact(std::string name, ContactSurface surface, BodyMeetings meetings,
                               double activation_distance, const VectorX& positions)
    : name_(std::move(name)),
      surface_(std::make_shared<const ContactSurface>(std::move(surface))),
      barrier_{activation_distance},
      broad_phase_(surface_->parts, std::move(meetings),
                   moving_points(surface_->parts.dim, numbers(surface_->places(positions)))) {}

double SurfaceContact::slack() const { return share_of_slack * barrier_.activation_distance; }

bool SurfaceContact::Found::covers(const VectorX& places, int dim, double slack) const {
  for (std::size_t v = 0; v < ways.size(); ++v)
    for (int k = 0; k < dim; ++k) {
      const double from = ways[v].x[k], way = ways[v].p[k];
      const double y = places[static_cast<Eigen::Index>(v) * dim + k];
      if (!(y >= from + std::min(way, 0.0) - slack && y <= from + std::max(way, 0.0) + slack)) return false;
    }
  return true;
}

SurfaceContact::Found SurfaceContact::find(BroadPhase& broad_phase, const VectorX& places,
                                           const VectorX& displacements) const {
  Found found;
  found.ways = moving_points(surface_->parts.dim, numbers(places), numbers(displacements));
  found.candidates = broad_phase.find(found.ways, barrier_.activation_distance + 2 * slack());
  return found;
}

std::vector<ContactTerm> SurfaceContact::terms_at(std::initializer_list<const VectorX*> states) const {
  const int dim = surface_->parts.dim;
  const auto is_covered = [&](const VectorX* state) { return found_->covers(*state, dim, slack()); };
  const std::span<const VectorX* const> all(states.begin(), states.size());
  if (found_ && std::ranges::all_of(all, is_covered))
    return contact_terms(*surface_, found_->candidates, all, barrier_.activation_distance);
  BroadPhase broad_phase = broad_phase_;
  const VectorX& from = *all.front();
  const Found found = find(broad_phase, from, *all.back() - from);
  return contact_terms(*surface_, found.candidates, all, barrier_.activation_distance);
}

double SurfaceContact::value(const VectorX& x, const Conditions& c) const {
  const VectorX places = surface_->places(x);
  double sum = 0;
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&places}))
      sum += barrier_of<dim>(term, barrier_, places).value();
  });
  return c.contact_weight * sum;
}

double SurfaceContact::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const VectorX before = surface_->places(from), after = surface_->places(to);
  double sum = 0;
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&before, &after}))
      sum += pair_barrier_difference<dim>(barrier_, term.kind, Places<dim>(term, before),
                                          Places<dim>(term, after), term.stiffness, mollifier_of(term));
  });
  return c.contact_weight * sum;
}

template <class Change>
void SurfaceContact::add_gradients(const VectorX& x, const Change& change, VectorX& sum) const {
  const VectorX places = surface_->places(x);
  VectorX of_vertices = VectorX::Zero(places.size());
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&places})) {
      const PairBarrier<dim> pair = barrier_of<dim>(term, barrier_, places);
      if (!pair.is_active()) continue;
      const PairVector<dim> gradient = change(pair.gradient());
      Eigen::Index k = 0;
      for (const Index v : term.used_vertices())
        of_vertices.segment<dim>(Eigen::Index{v} * dim) += gradient.template segment<dim>(dim * k++);
    }
  });
  surface_->add_to_nodes(of_vertices, sum);
}

void SurfaceContact::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  add_gradients(x, [&c](const auto& of_pair) { return (c.contact_weight * of_pair).eval(); }, gradient);
}

void SurfaceContact::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  add_gradients(
      x, [&c](const auto& of_pair) { return (c.contact_weight * of_pair.cwiseAbs()).eval(); }, magnitude);
}

template <int dim>
void SurfaceContact::add_hessian_of(const VectorX& places, double weight, Projection projection,
                                    BlockMatrix& hessian) const {
  // What several terms have of one feature is summed before it is projected.
  std::map<Feature, ContactTerm> merged;
  std::vector<ContactTerm> edges;  // whose mollifiers are their own
  for (const ContactTerm& term : terms_at({&places})) {
    const PairBarrier<dim> pair = barrier_of<dim>(term, barrier_, places);
    if (!pair.is_active()) continue;
    if (term.kind == PairKind::edge_edge) {
      edges.push_back(term);
      continue;
    }
    const Feature feature = closest_feature(term.kind, term.used_vertices(), pair.distance().weights);
    merged.try_emplace(feature, ContactTerm{feature.kind, feature.vertices, 0, 0}).first->second.stiffness +=
        term.stiffness;
  }
  const auto add = [&](const ContactTerm& term) {
    const PairMatrix<dim> matrix = weight * barrier_of<dim>(term, barrier_, places).hessian(projection);
    std::array<double, static_cast<std::size_t>(dim * dim)> block;
    const std::span<const Index> vertices = term.used_vertices();
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (std::size_t j = 0; j < vertices.size(); ++j)
        surface_->for_each_pair_of_nodes(vertices[i], vertices[j], [&](Index a, Index b, double share) {
          if (a > b) return;  // the other half of the matrix
          const auto row = static_cast<Eigen::Index>(i) * dim, column = static_cast<Eigen::Index>(j) * dim;
          for (int r = 0; r < dim; ++r)
            for (int s = 0; s < dim; ++s)
              block[static_cast<std::size_t>(r * dim + s)] = share * matrix(row + r, column + s);
          hessian.add_block(a, b, block.data());
        });
  };
  for (const auto& [feature, term] : merged)
    if (term.stiffness != 0) add(term);
  for (const ContactTerm& term : edges) add(term);
}

void SurfaceContact::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                                 BlockMatrix& hessian) const {
  const VectorX places = surface_->places(x);
  in_dimension(surface_->parts.dim,
               [&](auto dim) { add_hessian_of<dim>(places, c.contact_weight, projection, hessian); });
}

double SurfaceContact::max_step(const VectorX& x, const VectorX& p, const Conditions&) const {
  const VectorX places = surface_->places(x), displacements = surface_->places(p);
  const VectorX ends = places + displacements;
  const int dim = surface_->parts.dim;
  const bool is_found = found_ && found_->covers(places, dim, slack()) && found_->covers(ends, dim, slack());
  Found here;
  if (!is_found) {
    BroadPhase broad_phase = broad_phase_;
    here = find(broad_phase, places, displacements);
  }
  const SurfaceCandidates& candidates = is_found ? found_->candidates : here.candidates;
  const std::vector<MovingPoint> ways = moving_points(dim, numbers(places), numbers(displacements));
  double step = 1;
  for (const PairKind kind : {PairKind::point_edge, PairKind::point_triangle, PairKind::edge_edge})
    step = std::min(step, earliest_collision_time(candidates.list(kind, surface_->parts), ways));
  return step;
}

std::unique_ptr<Energy> SurfaceContact::begin_stage(const Stage& stage) const {
  auto own = std::make_unique<SurfaceContact>(*this);
  const VectorX places = surface_->places(stage.shape.size() > 0 ? stage.shape : stage.base_positions);
  own->found_ = own->find(own->broad_phase_, places, VectorX::Zero(places.size()));
  return own;
}

void SurfaceContact::prepare(const VectorX& x, const VectorX& p, const Conditions&) {
  found_ = find(broad_phase_, surface_->places(x), surface_->places(p));
}

std::vector<SurfaceContact::BodyContact> SurfaceContact::body_contacts(const VectorX& x,
                                                                       const Conditions& c) const {
  const VectorX places = surface_->places(x);
  std::map<std::array<Index, 2>, BodyContact> contacts;
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&places})) {
      const PairBarrier<dim> pair = barrier_of<dim>(term, barrier_, places);
      if (!pair.is_active()) continue;
      const std::span<const Index> vertices = term.used_vertices();
      const auto split = static_cast<std::size_t>(num_first(term.kind));
      const auto body_of = [&](Index v) { return surface_->parts.bodies[static_cast<std::size_t>(v)]; };
      const Index first = body_of(vertices[0]), second = body_of(vertices[split]);
      const auto [low, high] = std::minmax(first, second);
      BodyContact& contact =
          contacts.try_emplace({low, high}, BodyContact{.body = low, .other = high}).first->second;
      ++contact.num_pairs;
      contact.gap = std::min(contact.gap, pair.distance().distance);
      if (low == high) continue;
      const PairVector<dim> gradient = pair.gradient();
      const bool is_first_the_other = first == high;
      for (std::size_t i = is_first_the_other ? 0 : split; i < (is_first_the_other ? split : vertices.size());
           ++i)
        contact.force.template head<dim>() -=
            c.contact_weight * gradient.template segment<dim>(static_cast<Eigen::Index>(i) * dim);
    }
  });
  std::vector<BodyContact> list;
  for (const auto& [bodies, contact] : contacts) list.push_back(contact);
  return list;
}

void SurfaceContact::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  const VectorX places = surface_->places(x);
  const auto first_node = [&](Index v) {
    return surface_->nodes[surface_->row_begin[static_cast<std::size_t>(v)]];
  };
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&places})) {
      const PairBarrier<dim> pair = barrier_of<dim>(term, barrier_, places);
      if (!pair.is_active()) continue;
      Vector3 normal = Vector3::Zero();
      normal.head<dim>() = pair.distance().normal;
      const std::span<const Index> vertices = term.used_vertices();
      const auto num_of_first = static_cast<std::size_t>(num_first(term.kind));
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (pair.distance().weights[i] == 0) continue;
        const Index other = vertices[i < num_of_first ? num_of_first : 0];
        surface_->for_each_node(
            vertices[i], [&](Index node, double) { held.push_back({node, normal, first_node(other)}); });
      }
    }
  });
}

bool SurfaceContact::touches(const VectorX& x) const {
  return smallest_gap(x).distance <= touching * activation_distance();
}

SurfaceContact::Gap SurfaceContact::smallest_gap(const VectorX& x) const {
  const VectorX places = surface_->places(x);
  Gap smallest;
  in_dimension(surface_->parts.dim, [&](auto dim) {
    for (const ContactTerm& term : terms_at({&places})) {
      const double distance = std::sqrt(squared_distance<dim>(term.kind, Places<dim>(term, places)));
      if (distance < smallest.distance) smallest = {distance, term.kind, term.vertices};
    }
  });
  return smallest;
}

}  // namespace resilin
