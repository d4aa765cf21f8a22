#include "resilin/world/linear_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

using Weight = Dependents::Weight;
using Constant = LinearConstraints::Constant;

/// Relative to the largest coefficient of an equation. What is left of an equation that others have said is
/// the accuracy of the geometry: axes of joints that should meet miss each other by the rounding of a file.
constexpr double negligible_coefficient = 1e-6;

}  // namespace

bool LinearConstraints::ties(std::size_t body, std::size_t other) const {
  return std::ranges::any_of(tied_bodies, [&](const std::array<std::size_t, 2>& pair) {
    return pair == std::array{body, other} || pair == std::array{other, body};
  });
}

std::vector<Reaction> LinearConstraints::reactions(int dim, const VectorX& gradient,
                                                   const VectorX& positions) const {
  std::vector<Reaction> found(names.size());
  VectorX forces = gradient;  // chains pass their forces on
  std::vector<bool> is_face(names.size(), false);
  std::map<Index, std::size_t> owner_of;
  for (const auto& [owner, relation] : stated) owner_of.emplace(relation.unknown, owner);
  for (const auto& [owner, unknown, share] : on_faces) {
    is_face[owner] = true;
    found[owner].force[unknown % dim] += share * gradient[unknown];
  }
  const auto add = [&](std::size_t owner, Index unknown, double value) {
    if (is_face[owner]) return;
    Vector3 force = Vector3::Zero();
    force[unknown % dim] = value;
    found[owner].force += force;
    found[owner].torque += node_position(dim, unknown / dim, positions).cross(force);
  };
  for (const auto& [owner, relation] : stated) {
    const double force = forces[relation.unknown];
    add(owner, relation.unknown, force);
    for (const Weight& weight : relation.by) {
      if (!dependents.is_dependent(weight.unknown)) continue;
      forces[weight.unknown] += weight.value * force;
      // A part that others of the same name take stays within the surface.
      if (owner_of.at(weight.unknown) == owner) add(owner, weight.unknown, -weight.value * force);
    }
  }
  return found;
}

VectorX LinearConstraints::forces_of_joints(const VectorX& gradient) const {
  VectorX passed_on = gradient, forces = VectorX::Zero(gradient.size());
  for (const auto& [owner, relation] : stated) {
    const double force = passed_on[relation.unknown];
    const bool is_theirs = static_cast<std::ptrdiff_t>(owner) == joints;
    if (is_theirs) forces[relation.unknown] -= force;
    for (const Weight& weight : relation.by) {
      passed_on[weight.unknown] += weight.value * force;
      if (is_theirs) forces[weight.unknown] += weight.value * force;
    }
  }
  return forces;
}

VectorX LinearConstraints::forces(const VectorX& gradient) const {
  VectorX forces = VectorX::Zero(gradient.size());
  for (const Dependents::Relation& relation : dependents.relations()) {
    forces[relation.unknown] -= gradient[relation.unknown];
    for (const Weight& weight : relation.by)
      forces[weight.unknown] += weight.value * gradient[relation.unknown];
  }
  return forces;
}

void set_constants(const World& world, const Conditions& conditions, VectorX& targets) {
  if (!world.constraints) return;
  const LinearConstraints& all = *world.constraints;
  std::vector<double> factors;
  for (const TimeFunction& function : all.functions)
    factors.push_back(function.factor(conditions.time, conditions.load));
  for (std::size_t row = 0; row < all.constants.size(); ++row) {
    double sum = 0;
    for (const Constant& constant : all.constants[row])
      sum += constant.function < 0 ? constant.value
                                   : constant.value * factors[static_cast<std::size_t>(constant.function)];
    targets[all.dependents.relations()[row].unknown] = sum;
  }
}

void set_constants(const World& world, double time, Motion& constants) {
  if (!world.constraints) return;
  set_constants(world, {.time = time}, constants.positions);
  const LinearConstraints& all = *world.constraints;
  for (std::size_t row = 0; row < all.constants.size(); ++row) {
    const Index unknown = all.dependents.relations()[row].unknown;
    constants.velocities[unknown] = constants.accelerations[unknown] = 0;
    for (const Constant& constant : all.constants[row]) {
      if (constant.function < 0) continue;
      const TimeFunction& function = all.functions[static_cast<std::size_t>(constant.function)];
      constants.velocities[unknown] += constant.value * function.rate(time);
      constants.accelerations[unknown] += constant.value * function.second_rate(time);
    }
  }
}

RelationSystem::RelationSystem(int dim, const VectorX& rest_positions,
                               const std::vector<std::int32_t>& support_of,
                               std::vector<std::string> names_of_supports)
    : dim_(dim),
      rest_positions_(rest_positions),
      support_of_(support_of),
      entry_of_(support_of.size(), -1),
      names_of_supports_(std::move(names_of_supports)) {}

std::size_t RelationSystem::add_name(std::string name) {
  names_.push_back(std::move(name));
  return names_.size() - 1;
}

void RelationSystem::add_face(std::size_t owner, int axis, double length, std::size_t first_of_cell) {
  faces_.push_back({owner, axis, length, first_of_cell});
}

int RelationSystem::add_function(const TimeFunction& function) {
  functions_.push_back(function);
  return static_cast<int>(functions_.size()) - 1;
}

bool RelationSystem::is_taken(Index unknown) const {
  const auto i = static_cast<std::size_t>(unknown);
  return support_of_[i] >= 0 || entry_of_[i] >= 0;
}

void RelationSystem::substitute(std::vector<Weight>& by, std::vector<Constant>& constants) const {
  std::map<Index, double> weights;
  std::map<int, double> sums;
  for (const Constant& constant : constants) sums[constant.function] += constant.value;
  const auto add = [&](const auto& self, Index unknown, double weight) -> void {
    const Index number = entry_of_[static_cast<std::size_t>(unknown)];
    if (number < 0) {
      weights[unknown] += weight;
      return;
    }
    const Entry& entry = entries_[static_cast<std::size_t>(number)];
    for (const Constant& constant : entry.constants) sums[constant.function] += weight * constant.value;
    for (const Weight& each : entry.relation.by) self(self, each.unknown, weight * each.value);
  };
  for (const Weight& weight : by) add(add, weight.unknown, weight.value);
  by.clear();
  for (const auto& [unknown, weight] : weights)
    if (weight != 0) by.push_back({unknown, weight});
  constants.clear();
  for (const auto& [function, value] : sums)
    if (value != 0) constants.push_back({function, value});
}

std::string RelationSystem::what_determines(const std::vector<Weight>& terms) const {
  std::vector<std::string> words;
  const auto add = [&](const auto& self, Index unknown) -> void {
    std::string word;
    if (const std::int32_t support = support_of_[static_cast<std::size_t>(unknown)]; support >= 0) {
      if (static_cast<std::size_t>(support) < names_of_supports_.size())
        word = "[[fix]] \"" + names_of_supports_[static_cast<std::size_t>(support)] + '"';
    } else if (const Index number = entry_of_[static_cast<std::size_t>(unknown)]; number >= 0) {
      const Entry& entry = entries_[static_cast<std::size_t>(number)];
      if (!names_[entry.owner].empty()) word = '"' + names_[entry.owner] + '"';
      for (const Weight& weight : entry.relation.by) self(self, weight.unknown);
    }
    if (!word.empty() && std::ranges::find(words, word) == words.end()) words.push_back(std::move(word));
  };
  for (const Weight& term : terms) add(add, term.unknown);
  return join(words, " and ");
}

void RelationSystem::follow(std::size_t owner, Index unknown, std::vector<Weight> by,
                            std::vector<Constant> constants, const std::string& place) {
  std::vector<Weight> all = by;
  std::vector<Constant> all_constants = constants;
  substitute(all, all_constants);
  if (std::ranges::find(all, unknown, &Weight::unknown) != all.end())
    throw InputError(place, "surfaces of which one follows the other", "a circle: what is followed follows",
                     "leave one of the two ties or constraints out");
  entry_of_[static_cast<std::size_t>(unknown)] = static_cast<Index>(entries_.size());
  entries_.push_back({owner, {unknown, std::move(by)}, std::move(constants)});
}

void RelationSystem::add_equation(std::size_t owner, std::vector<Weight> terms,
                                  std::vector<Constant> constants, const std::string& place) {
  const std::vector<Weight> stated = terms;
  double largest = 0;
  for (const Weight& term : terms) largest = std::max(largest, std::abs(term.value));
  for (Constant& constant : constants) constant.value = -constant.value;
  substitute(terms, constants);
  const Weight* pivot = nullptr;
  for (const Weight& term : terms)
    if (support_of_[static_cast<std::size_t>(term.unknown)] < 0 &&
        std::abs(term.value) > negligible_coefficient * largest &&
        (pivot == nullptr || std::abs(term.value) > std::abs(pivot->value)))
      pivot = &term;
  if (pivot == nullptr) {
    std::erase_if(
        terms, [&](const Weight& term) { return std::abs(term.value) <= negligible_coefficient * largest; });
    const double round_off = 1e-10 * rest_positions_.cwiseAbs().maxCoeff();
    std::erase_if(constants,
                  [&](const Constant& constant) { return std::abs(constant.value) <= round_off * largest; });
    if (terms.empty() && constants.empty()) return;  // says again what others have said
    double off = 0;
    for (const Constant& constant : constants) off += constant.value;
    const std::string others = what_determines(stated);
    throw InputError(
        place, "a constraint with a displacement that nothing else prescribes",
        "one between displacements that " +
            (others.empty() ? "boundary conditions and other constraints" : others) + " determine" +
            (terms.empty() ? ", which differ from it by " + format_short(std::abs(off)) + " m" : ""),
        "leave it out, or remove vertices from `where`");
  }
  const Weight chosen = *pivot;
  std::vector<Weight> by;
  for (const Weight& term : terms)
    if (term.unknown != chosen.unknown) by.push_back({term.unknown, -term.value / chosen.value});
  for (Constant& constant : constants) constant.value /= -chosen.value;
  follow(owner, chosen.unknown, std::move(by), std::move(constants), place);
}

std::shared_ptr<LinearConstraints> RelationSystem::build() const {
  if (entries_.empty()) return nullptr;
  // Relations that were added after the ones that they appear in are put in place there.
  std::vector<Dependents::Relation> relations;
  std::vector<std::vector<Constant>> constants;
  for (const Entry& entry : entries_) {
    Dependents::Relation relation = entry.relation;
    std::vector<Constant> own = entry.constants;
    substitute(relation.by, own);
    double at_rest = rest_positions_[relation.unknown];
    for (const Weight& weight : relation.by) at_rest -= weight.value * rest_positions_[weight.unknown];
    own.push_back({-1, at_rest});
    relations.push_back(std::move(relation));
    constants.push_back(std::move(own));
  }
  // Work of the mean displacement gradient: a vertex on an edge follows along two axes at once.
  std::vector<LinearConstraints::OnFace> on_faces;
  for (const Face& face : faces_) {
    std::size_t end_of_cell = face.first_of_cell;
    for (const Face& other : faces_)
      if (other.first_of_cell == face.first_of_cell) end_of_cell = std::max(end_of_cell, other.owner + 1);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].owner < face.first_of_cell || entries_[i].owner >= end_of_cell) continue;
      const auto at = [&](Index unknown) {
        return rest_positions_[Eigen::Index{unknown / dim_} * dim_ + face.axis];
      };
      double distance = at(relations[i].unknown);
      for (const Weight& weight : relations[i].by) distance -= weight.value * at(weight.unknown);
      on_faces.push_back({face.owner, relations[i].unknown, distance / face.length});
    }
  }
  // In the order in which forces are passed on.
  std::vector<int> num_followers(entries_.size(), 0);
  const auto for_each_entry_of = [&](const Entry& entry, const auto& visit) {
    for (const Weight& weight : entry.relation.by)
      if (const Index of = entry_of_[static_cast<std::size_t>(weight.unknown)]; of >= 0)
        visit(static_cast<std::size_t>(of));
  };
  for (const Entry& entry : entries_) for_each_entry_of(entry, [&](std::size_t of) { ++num_followers[of]; });
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (num_followers[i] == 0) order.push_back(i);
  std::vector<LinearConstraints::Stated> stated;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Entry& entry = entries_[order[k]];
    stated.push_back({entry.owner, entry.relation});
    for_each_entry_of(entry, [&](std::size_t of) {
      if (--num_followers[of] == 0) order.push_back(of);
    });
  }
  return std::make_shared<LinearConstraints>(LinearConstraints{
      .dependents = Dependents(dim_, static_cast<Index>(rest_positions_.size()), std::move(relations)),
      .constants = std::move(constants),
      .functions = functions_,
      .names = names_,
      .stated = std::move(stated),
      .on_faces = std::move(on_faces),
      .tied_bodies = {},
      .joints = -1});
}

}  // namespace resilin
