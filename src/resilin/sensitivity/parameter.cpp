#include "resilin/sensitivity/parameter.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "resilin/core/error.hpp"
#include "resilin/sensitivity/body_parameters.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/description_members.hpp"

namespace resilin {
namespace {

/// "load.tip.": by the name, or by the place where it has none (from 1).
std::string prefix(const std::string& kind, const std::string& name, std::size_t number) {
  return kind + "." + (name.empty() ? std::to_string(number + 1) : name) + ".";
}

/// A vector of the description and of the world's change.
template <class Change>
Parameter vector_parameter(const std::string& name, int dim, const Vector3& value, Change change,
                           std::function<void(WorldChange&)> ask,
                           const std::function<Vector3&(Description&)>& member) {
  Parameter parameter{.name = name, .shape = {dim}, .value = value.head(dim)};
  parameter.ask = std::move(ask);
  parameter.spread = [=](const VectorX& by, WorldChange& world) { change(world).head(dim) += by; };
  parameter.gather = [=](const WorldChange& world, VectorX& slopes) { slopes += change(world).head(dim); };
  parameter.set = [=](const VectorX& to, Description& description) { member(description).head(dim) = to; };
  return parameter;
}

Parameter gravity(const World& world, const std::string& name) {
  return vector_parameter(
      name, world.dimension, world.gravity, [](auto& of) -> auto& { return of.gravity; },
      [](WorldChange& of) { of.has_gravity = true; }, [](Description& of) -> Vector3& { return of.gravity; });
}

/// The numbers of a load by their key: members of its description, `value` as its kind has it.
double* numbers_of(LoadDescription& load, const std::string& key, Eigen::Index size) {
  if (key == "value" && size == 1) return &load.pressure;
  double* numbers = nullptr;
  visit_members(load, [&](std::string_view name, auto& member) {
    using Type = std::remove_cvref_t<decltype(member)>;
    if (name != key) return;
    if constexpr (std::is_same_v<Type, Vector3>) {
      numbers = member.data();
    } else if constexpr (std::is_same_v<Type, double>) {
      numbers = &member;
    }
  });
  if (numbers == nullptr) throw std::logic_error("a load has no numbers \"" + key + "\"");
  return numbers;
}

Parameter load_parameter(const World& world, std::size_t l, const std::string& name, const std::string& key) {
  const LoadDescription& load = world.made_from->loads[l];
  const Energy& term = *world.terms[world.term_of_load(l)];
  const auto parameters = term.parameters();
  const auto found = std::ranges::find(parameters, key, &EnergyParameter::name);
  const Eigen::Index size = found->size;
  LoadDescription copy = load;
  Parameter parameter{
      .name = name, .shape = {}, .value = Eigen::Map<const VectorX>(numbers_of(copy, key, size), size)};
  if (size > 1) parameter.shape = {size};
  parameter.ask = [=](WorldChange& of) { of.loads[l][key] = VectorX::Zero(size); };
  parameter.spread = [=](const VectorX& by, WorldChange& of) { of.loads[l][key] += by; };
  parameter.gather = [=](const WorldChange& of, VectorX& slopes) { slopes += of.loads[l].at(key); };
  parameter.set = [=](const VectorX& to, Description& of) {
    Eigen::Map<VectorX>(numbers_of(of.loads[l], key, size), size) = to;
  };
  return parameter;
}

/// A number of a joint, a spring or a cable: of its term and of its description.
Parameter coupling_parameter(std::size_t term, const std::string& name, const std::string& of_term,
                             double value, const std::function<double&(Description&)>& member) {
  Parameter parameter{.name = name, .shape = {}, .value = VectorX::Constant(1, value)};
  parameter.ask = [=](WorldChange& of) { of.couplings[term][of_term] = VectorX::Zero(1); };
  parameter.spread = [=](const VectorX& by, WorldChange& of) { of.couplings[term][of_term] += by; };
  parameter.gather = [=](const WorldChange& of, VectorX& slopes) {
    slopes += of.couplings.at(term).at(of_term);
  };
  parameter.set = [=](const VectorX& to, Description& of) { member(of) = to[0]; };
  return parameter;
}

Parameter support_parameter(const World& world, std::size_t s, const std::string& name,
                            const std::string& key) {
  const int dim = world.dimension;
  const FixDescription& fix = world.made_from->fixes[s];
  const auto ask = [s](WorldChange& of) { of.supports[s].is_asked = true; };
  if (key == "displacement")
    return vector_parameter(
        name, dim, fix.displacement, [s](auto& of) -> auto& { return of.supports[s].displacement; }, ask,
        [s](Description& of) -> Vector3& { return of.fixes[s].displacement; });
  if (key == "velocity")
    return vector_parameter(
        name, dim, fix.velocity, [s](auto& of) -> auto& { return of.supports[s].velocity; }, ask,
        [s](Description& of) -> Vector3& { return of.fixes[s].velocity; });
  Parameter parameter{.name = name, .shape = {dim, dim}, .value = VectorX(dim * dim)};
  for (int i = 0; i < dim * dim; ++i) parameter.value[i] = fix.gradient(i / dim, i % dim);
  parameter.ask = ask;
  parameter.spread = [=](const VectorX& by, WorldChange& of) {
    for (int i = 0; i < dim * dim; ++i) of.supports[s].gradient(i / dim, i % dim) += by[i];
  };
  parameter.gather = [=](const WorldChange& of, VectorX& slopes) {
    for (int i = 0; i < dim * dim; ++i) slopes[i] += of.supports[s].gradient(i / dim, i % dim);
  };
  parameter.set = [=](const VectorX& to, Description& of) {
    for (int i = 0; i < dim * dim; ++i) of.fixes[s].gradient(i / dim, i % dim) = to[i];
  };
  return parameter;
}

/// One number of the world's change and of the description.
template <class Change>
Parameter number_parameter(const std::string& name, double value, Change change,
                           std::function<void(WorldChange&)> ask,
                           const std::function<void(double, Description&)>& set) {
  Parameter parameter{.name = name, .shape = {}, .value = VectorX::Constant(1, value)};
  parameter.ask = std::move(ask);
  parameter.spread = [=](const VectorX& by, WorldChange& world) { change(world) += by[0]; };
  parameter.gather = [=](const WorldChange& world, VectorX& slopes) { slopes[0] += change(world); };
  parameter.set = [=](const VectorX& to, Description& description) { set(to[0], description); };
  return parameter;
}

Parameter collider_friction(const World& world, std::size_t k, const std::string& name) {
  return number_parameter(
      name, world.made_from->colliders[k].friction,
      [k](auto& of) -> auto& { return of.colliders[k].friction; },
      [k](WorldChange& of) { of.colliders[k].has_friction = true; },
      [k](double to, Description& of) { of.colliders[k].friction = to; });
}

/// A vector of a collider's description and what it is of its motion.
Parameter collider_vector(const World& world, std::size_t k, const std::string& name,
                          Vector3 WorldChange::OfCollider::* change,
                          const std::function<Vector3&(ColliderDescription&)>& member) {
  ColliderDescription copy = world.made_from->colliders[k];
  return vector_parameter(
      name, world.dimension, member(copy), [k, change](auto& of) -> auto& { return of.colliders[k].*change; },
      [k](WorldChange& of) { of.colliders[k].has_motion = true; },
      [k, member](Description& of) -> Vector3& { return member(of.colliders[k]); });
}

/// The key by which a kind of collider is placed; empty: by several.
std::string place_key(const std::string& kind) {
  if (kind == "half_space") return "point";
  if (kind == "sphere" || kind == "box") return "center";
  return kind == "mesh" ? "translate" : "";
}

Vector3& place_of(ColliderDescription& collider) {
  const std::string key = place_key(collider.kind);
  if (key == "point") return collider.shape.point;
  return key == "center" ? collider.shape.center : collider.shape.translate;
}

/// @param pair  the number of the pair; -1: of all others
Parameter contact_friction(const World& world, int pair, const std::string& name) {
  const auto ask = [](WorldChange& of) { of.contact.has_friction = true; };
  if (pair < 0)
    return number_parameter(
        name, world.made_from->contact.friction, [](auto& of) -> auto& { return of.contact.friction; }, ask,
        [](double to, Description& of) { of.contact.friction = to; });
  const auto k = static_cast<std::size_t>(pair);
  return number_parameter(
      name, world.made_from->contact.pairs[k].friction.value_or(0),
      [k](auto& of) -> auto& { return of.contact.pairs[k]; }, ask,
      [k](double to, Description& of) { of.contact.pairs[k].friction = to; });
}

/// A parameter and how it is made.
struct Entry {
  std::string name;
  std::function<Parameter()> make;
  bool is_friction_of_none = false;  ///< a coefficient that is zero
  bool is_roller = false;            ///< the place of a collider that turns where it is
  bool moves_constraints = false;    ///< changes by which unknowns follow from others
};

/// Numbers of springs, cables, and of the springs and motors of joints.
void add_couplings(const World& world, std::vector<Entry>& all) {
  using Kind = TermOrigin::Kind;
  const Description& description = *world.made_from;
  const auto add = [&](const TermOrigin& origin, const std::string& name, const std::string& of_term,
                       double value, const std::function<double&(Description&)>& member) {
    if (const std::optional<std::size_t> term = world.find_term(origin))
      all.push_back(
          {.name = name, .make = [=] { return coupling_parameter(*term, name, of_term, value, member); }});
  };
  const auto add_cables = [&](std::vector<CableDescription> Description::* list, Kind kind,
                              const std::string& word, std::size_t first) {
    for (std::size_t i = 0; i < (description.*list).size(); ++i) {
      const CableDescription& cable = (description.*list)[i];
      const Cable::Law& law = world.cables[first + i]->law();
      const std::string start = prefix(word, cable.name, i);
      const auto of_cable = [&](const std::string& key, double value, auto member) {
        add({kind, i}, start + key, key, value,
            [=](Description& of) -> double& { return member((of.*list)[i]); });
      };
      if (cable.tension) {
        of_cable("tension", *cable.tension, [](CableDescription& of) -> double& { return *of.tension; });
        continue;
      }
      if (cable.forces.empty())
        of_cable("stiffness", cable.stiffness, [](CableDescription& of) -> double& { return of.stiffness; });
      of_cable("rest_length", law.rest_length, [](CableDescription& of) -> double& {
        return of.rest_length ? *of.rest_length : of.rest_length.emplace();
      });
      if (kind == Kind::cable)
        of_cable("shortening", cable.shortening,
                 [](CableDescription& of) -> double& { return of.shortening; });
    }
  };
  add_cables(&Description::springs, Kind::spring, "spring", 0);
  add_cables(&Description::cables, Kind::cable, "cable", description.springs.size());
  for (std::size_t j = 0; j < description.joints.size(); ++j) {
    const JointDescription& joint = description.joints[j];
    const Joint& made = world.joints[j];
    const std::string start = prefix("joint", joint.name, j);
    const auto of_joint = [&](std::size_t term, const std::string& key, const std::string& of_term,
                              double value, auto member) {
      add({Kind::joint, j, term}, start + key, of_term, value,
          [=](Description& of) -> double& { return member(of.joints[j]); });
    };
    if (joint.stiffness > 0) {  // behind the energies that keep the joint closed
      of_joint(made.gaps.size(), "stiffness", "stiffness", joint.stiffness,
               [](JointDescription& of) -> double& { return of.stiffness; });
      of_joint(made.gaps.size(), "rest", "rest", joint.rest,
               [](JointDescription& of) -> double& { return of.rest; });
    }
    if (!joint.motor) continue;
    const std::size_t last = made.terms.size() - 1;
    if (joint.motor->effort)
      of_joint(last, joint.kind == JointKind::hinge ? "motor.torque" : "motor.force", "effort",
               *joint.motor->effort, [](JointDescription& of) -> double& { return *of.motor->effort; });
    else if (joint.motor->velocity)
      of_joint(last, "motor.velocity", "velocity", *joint.motor->velocity,
               [](JointDescription& of) -> double& { return *of.motor->velocity; });
    else
      of_joint(last, "motor.position", "position", joint.motor->position,
               [](JointDescription& of) -> double& { return of.motor->position; });
  }
}

void add_friction(const World& world, std::vector<Entry>& all) {
  const Description& description = *world.made_from;
  for (std::size_t k = 0; k < description.colliders.size(); ++k) {
    const ColliderDescription& collider = description.colliders[k];
    const std::string name = prefix("collider", collider.name, k) + "friction";
    all.push_back(
        {name, [&world, k, name] { return collider_friction(world, k, name); }, !(collider.friction > 0)});
  }
  if (!world.contact) return;
  all.push_back({.name = "contact.friction",
                 .make = [&world] { return contact_friction(world, -1, "contact.friction"); },
                 .is_friction_of_none = !(description.contact.friction > 0)});
  for (std::size_t k = 0; k < description.contact.pairs.size(); ++k) {
    const std::optional<double>& friction = description.contact.pairs[k].friction;
    const std::string name = prefix("contact.pair", "", k) + "friction";
    if (!friction) continue;
    all.push_back({name, [&world, k, name] { return contact_friction(world, static_cast<int>(k), name); },
                   !(*friction > 0)});
  }
}

void add_motions(const World& world, bool passes_time, std::vector<Entry>& all) {
  using Of = WorldChange::OfCollider;
  const Description& description = *world.made_from;
  for (std::size_t k = 0; k < description.colliders.size(); ++k) {
    const ColliderDescription& collider = description.colliders[k];
    const std::string start = prefix("collider", collider.name, k);
    const auto add = [&](const std::string& key, Vector3 Of::* change,
                         const std::function<Vector3&(ColliderDescription&)>& member) {
      const std::string name = start + key;
      all.push_back({.name = name, .make = [&world, k, name, change, member] {
                       return collider_vector(world, k, name, change, member);
                     }});
    };
    if (const std::string key = place_key(collider.kind); !key.empty()) {
      add(key, &Of::place, place_of);
      all.back().is_roller = motion_of(collider, world.end_time).turns_in_place;
    }
    if (!passes_time) continue;
    add("velocity", &Of::velocity, [](ColliderDescription& of) -> Vector3& { return of.velocity; });
    add("displacement", &Of::displacement,
        [](ColliderDescription& of) -> Vector3& { return of.displacement; });
  }
}

std::vector<Entry> entries(const World& world) {
  std::vector<Entry> all;
  const Description& description = *world.made_from;
  // At rest there is time where something follows it.
  const bool passes_time = world.is_dynamic || world.path_time > 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    for (const std::string& key : keys_of_body(world, b)) {
      const std::string name = prefix("body", world.bodies[b].name, b) + key;
      all.push_back({name, [&world, b, name, key] { return parameter_of_body(world, b, name, key); }});
      all.back().moves_constraints =
          world.constraints && (key == "rest_positions" || key.starts_with("initial_"));
    }
  for (std::size_t l = 0; l < description.loads.size(); ++l)
    for (const EnergyParameter& of_term : world.terms[world.term_of_load(l)]->parameters()) {
      if (of_term.name == "rest_positions" || (of_term.name == "velocity" && !passes_time)) continue;
      const std::string key(of_term.name), name = prefix("load", description.loads[l].name, l) + key;
      all.push_back({name, [&world, l, name, key] { return load_parameter(world, l, name, key); }});
    }
  for (std::size_t s = 0; s < description.fixes.size(); ++s) {
    std::vector<std::string> keys;
    if (passes_time) keys.emplace_back("velocity");
    if (!description.fixes[s].rotate) {
      keys.emplace_back("displacement");
      const bool is_on_rigid_body = std::ranges::any_of(world.bodies, [&](const Body& body) {
        return body.rigid && (body.name == description.fixes[s].body || world.bodies.size() == 1);
      });
      if (!is_on_rigid_body) keys.emplace_back("gradient");
    }
    for (const std::string& key : keys) {
      const std::string name = prefix("fix", description.fixes[s].name, s) + key;
      all.push_back({name, [&world, s, name, key] { return support_parameter(world, s, name, key); }});
    }
  }
  add_couplings(world, all);
  add_motions(world, passes_time, all);
  add_friction(world, all);
  all.push_back({"simulation.gravity", [&world] { return gravity(world, "simulation.gravity"); }});
  return all;
}

/// Why the scene cannot be differentiated by an entry, where it cannot.
std::optional<InputError> refusal_of(const World& world, const Entry& entry) {
  const std::string& name = entry.name;
  if (entry.is_roller)
    return InputError(
        name, "a collider that does not rotate in place", "one that does",
        "elsewhere its axis would not be its own: use its velocity or displacement, which the axis follows");
  if (entry.moves_constraints)
    return InputError(name, "a scene without ties, constraints, joints and rigid regions", "one with them",
                      "take other parameters: these would change which positions follow from which");
  if (entry.is_friction_of_none)
    return InputError(name, "a friction coefficient above 0", "0",
                      "give a small value: without it there is no friction to differentiate");
  if (name == "simulation.gravity" && world.gravity.head(world.dimension).isZero(0))
    return InputError(name, "a scene with gravity", "none",
                      "give a small simulation.gravity: without it there is no weight to differentiate");
  return {};
}

}  // namespace

std::vector<std::string> parameter_names(const World& world) {
  std::vector<std::string> names;
  for (const Entry& entry : entries(world))
    if (!refusal_of(world, entry)) names.push_back(entry.name);
  return names;
}

Parameter find_parameter(const World& world, const std::string& name) {
  std::vector<std::string> names;
  // `density` stands in the material, of which it is no constant.
  const std::string in_material = ".material.density";
  std::string wanted = name;
  if (name.ends_with(in_material))
    wanted.replace(name.size() - in_material.size(), std::string::npos, ".density");
  for (const Entry& entry : entries(world)) {
    if (entry.name == wanted) {
      if (const auto refusal = refusal_of(world, entry)) throw *refusal;
      Parameter parameter = entry.make();
      parameter.name = name;
      return parameter;
    }
    names.push_back(entry.name);
  }
  refuse_word("parameter", name, names);
}

void keep_elements(Description& description, const World& world) {
  for (std::size_t b = 0; b < description.bodies.size(); ++b)
    description.bodies[b].element = world.bodies[b].element;
}

Parameter find_parameter_of(const World& world, const std::string& name, Eigen::Index count) {
  Parameter parameter = find_parameter(world, name);
  const Eigen::Index has = parameter.value.size();
  if (count != has && !(has == 1 && name.find(".material.") != std::string::npos))
    throw InputError(name, std::to_string(has) + " numbers", std::to_string(count));
  return parameter;
}

Description with_values(const Description& description, const std::map<std::string, VectorX>& values) {
  return values.empty() ? description : with_values(World(Description(description)), values);
}

Description with_values(const World& world, const std::map<std::string, VectorX>& values) {
  Description changed = *world.made_from;
  for (const auto& [name, value] : values) find_parameter_of(world, name, value.size()).set(value, changed);
  return changed;
}

}  // namespace resilin
