#include "resilin/sensitivity/contact_links.hpp"

#include <algorithm>

namespace resilin {
namespace {

/// For each coefficient between bodies: the pair of the scene that says it, the last one of several.
std::vector<int> pairs_of(const World& world) {
  const std::size_t n = world.bodies.size();
  std::vector<int> pairs(n * n, -1);
  const std::vector<ContactPairDescription>& described = world.made_from->contact.pairs;
  for (std::size_t k = 0; k < described.size(); ++k) {
    if (!described[k].friction) continue;
    const auto number = [&](const std::string& name) {
      return static_cast<std::size_t>(std::ranges::find(world.bodies, name, &Body::name) -
                                      world.bodies.begin());
    };
    const std::size_t a = number(described[k].bodies[0]), b = number(described[k].bodies[1]);
    pairs[a * n + b] = pairs[b * n + a] = static_cast<int>(k);
  }
  return pairs;
}

}  // namespace

ContactLinks::ContactLinks(const World& world) {
  std::size_t exact = 0, of_facets = 0;
  for (std::size_t t = 0; t < world.terms.size(); ++t) {
    const std::shared_ptr<const Energy>& term = world.terms[t];
    if (exact < world.colliders.size() && term == world.colliders[exact]) {
      ++exact;
      collider_terms_.push_back(t);
    } else if (of_facets < world.mesh_colliders.size() && term == world.mesh_colliders[of_facets]) {
      ++of_facets;
      collider_terms_.push_back(t);
    }
    if (term->properties().category == EnergyCategory::friction) friction_ = static_cast<int>(t);
  }
  if (!world.friction) return;
  Eigen::Index coefficient = 0, stiffness = 0;
  for (const std::shared_ptr<const FrictionSource>& source : world.friction->sources()) {
    const auto found = std::ranges::find_if(
        world.terms, [&](const auto& term) { return term->friction_source() == source.get(); });
    sources_.push_back({.term = static_cast<std::size_t>(found - world.terms.begin()),
                        .coefficient = coefficient,
                        .num_coefficients = source->num_coefficients(),
                        .stiffness = stiffness,
                        .num_stiffnesses = source->num_stiffnesses()});
    if (*found == world.contact) sources_.back().pairs = pairs_of(world);
    coefficient += source->num_coefficients();
    stiffness += source->num_stiffnesses();
  }
}

const ContactLinks::Source* ContactLinks::source_of(std::size_t term) const {
  const auto found = std::ranges::find(sources_, term, &Source::term);
  return found == sources_.end() ? nullptr : &*found;
}

bool ContactLinks::moves_motion(const WorldChange& change) const {
  return std::ranges::any_of(change.colliders, &WorldChange::OfCollider::has_motion);
}

template <class Change, class Visit>
void ContactLinks::for_each_collider(Change& change, const Visit& visit) const {
  for (std::size_t k = 0; k < collider_terms_.size(); ++k) visit(change.colliders[k], collider_terms_[k]);
}

template <class Change, class Visit>
void ContactLinks::for_each_coefficient(Change& change, const Visit& visit) const {
  for_each_collider(change, [&](auto& collider, std::size_t term) {
    const Source* source = source_of(term);
    for (Eigen::Index i = 0; source != nullptr && collider.has_friction && i < source->num_coefficients; ++i)
      visit(source->coefficient + i, collider.friction);
  });
  for (const Source& source : sources_)
    for (std::size_t i = 0; change.contact.has_friction && i < source.pairs.size(); ++i)
      visit(source.coefficient + static_cast<Eigen::Index>(i),
            source.pairs[i] < 0 ? change.contact.friction
                                : change.contact.pairs[static_cast<std::size_t>(source.pairs[i])]);
}

void ContactLinks::add_zero(const WorldChange& asked, TermChanges& terms) const {
  for_each_collider(asked, [&](const WorldChange::OfCollider& collider, std::size_t term) {
    for (const std::string_view name : ColliderMotion::parameter_names)
      if (collider.has_motion) terms[term][std::string(name)] = VectorX::Zero(3);
  });
  if (sources_.empty()) return;
  auto& of_friction = terms[static_cast<std::size_t>(friction_)];
  if (moves_motion(asked))
    for (const std::string_view name : ColliderMotion::parameter_names)
      of_friction[std::string(name)] = VectorX::Zero(3 * static_cast<Eigen::Index>(sources_.size()));
  bool asks_for_friction = false;
  for_each_coefficient(asked, [&](Eigen::Index, double) { asks_for_friction = true; });
  const Source& last = sources_.back();
  if (asks_for_friction)
    of_friction["coefficients"] = VectorX::Zero(last.coefficient + last.num_coefficients);
  if (std::ranges::any_of(
          sources_, [&](const Source& source) { return terms[source.term].contains("barrier_stiffness"); }))
    of_friction["barrier_stiffness"] = VectorX::Zero(last.stiffness + last.num_stiffnesses);
}

namespace {

/// The number of a collider that a parameter of its motion is.
template <class Collider>
auto& motion_number(Collider& collider, std::string_view name) {
  if (name == "place") return collider.place;
  return name == "velocity" ? collider.velocity : collider.displacement;
}

}  // namespace

void ContactLinks::spread(const WorldChange& change, TermChanges& terms) const {
  for_each_collider(change, [&](const WorldChange::OfCollider& collider, std::size_t term) {
    if (!collider.has_motion) return;
    for (const std::string_view name : ColliderMotion::parameter_names) {
      const Vector3& by = motion_number(collider, name);
      terms[term].find(name)->second = by;
      const Source* source = source_of(term);
      if (source == nullptr) continue;
      auto& of_friction = terms[static_cast<std::size_t>(friction_)];
      of_friction.find(name)->second.segment<3>(3 * (source - sources_.data())) = by;
    }
  });
  if (sources_.empty()) return;
  auto& of_friction = terms[static_cast<std::size_t>(friction_)];
  for_each_coefficient(change, [&](Eigen::Index coefficient, double by) {
    of_friction.find("coefficients")->second[coefficient] = by;
  });
  for (const Source& source : sources_)
    if (const auto found = terms[source.term].find("barrier_stiffness"); found != terms[source.term].end())
      of_friction.find("barrier_stiffness")->second.segment(source.stiffness, source.num_stiffnesses) =
          found->second;
}

void ContactLinks::gather(const TermChanges& terms, WorldChange& slopes) const {
  for_each_collider(slopes, [&](WorldChange::OfCollider& collider, std::size_t term) {
    if (!collider.has_motion) return;
    for (const std::string_view name : ColliderMotion::parameter_names) {
      Vector3& by = motion_number(collider, name);
      by += terms[term].find(name)->second;
      const Source* source = source_of(term);
      if (source == nullptr) continue;
      const auto& of_friction = terms[static_cast<std::size_t>(friction_)];
      by += of_friction.find(name)->second.segment<3>(3 * (source - sources_.data()));
    }
  });
  for_each_coefficient(slopes, [&](Eigen::Index coefficient, double& by) {
    by += terms[static_cast<std::size_t>(friction_)].find("coefficients")->second[coefficient];
  });
}

VectorX ContactLinks::stiffness_slopes(std::size_t term, const TermChanges& terms) const {
  VectorX slopes = terms[term].find("barrier_stiffness")->second;
  if (const Source* source = source_of(term))
    slopes += terms[static_cast<std::size_t>(friction_)]
                  .find("barrier_stiffness")
                  ->second.segment(source->stiffness, source->num_stiffnesses);
  return slopes;
}

}  // namespace resilin
