#include "resilin/world/fingerprint.hpp"

#include <algorithm>
#include <cstdio>
#include <span>
#include <string_view>

#include "resilin/core/hash.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/event_times.hpp"
#include "resilin/world/support.hpp"

// Each struct of a description is taken apart into all of its members: a new member does not compile until
// somebody has said here whether the steps depend on it.

namespace resilin {
namespace {

std::string text(double value) { return format_number(value); }
std::string text(int value) { return std::to_string(value); }
std::string text(bool value) { return value ? "true" : "false"; }
std::string text(const std::string& value) { return '"' + value + '"'; }
template <Spelled Choice>
std::string text(Choice value) {
  return text(spelling(value));
}
template <class Numbers>
std::string list_text(const Numbers& numbers) {
  std::string list;
  for (const auto number : numbers) list += (list.empty() ? "[" : ", ") + text(number);
  return list + "]";
}
std::string text(const Vector3& value) { return list_text(value); }
std::string text(const std::array<bool, 3>& value) { return list_text(value); }
std::string text(const Eigen::Matrix3d& value) {
  return "[" + text(Vector3(value.row(0))) + ", " + text(Vector3(value.row(1))) + ", " +
         text(Vector3(value.row(2))) + "]";
}
std::string hash_text(std::uint64_t hash) {
  char digits[32];
  std::snprintf(digits, sizeof digits, " (hash %016llx)", static_cast<unsigned long long>(hash));
  return digits;
}

/// The bytes of numbers in a row, without padding.
template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

constexpr std::size_t longest_list = 8;  ///< written out; longer ones by their hash

template <class T>
std::string text(const std::vector<T>& values) {
  if (values.empty()) return "none";
  if constexpr (std::is_arithmetic_v<T>) {
    if (values.size() <= longest_list) return list_text(values);
  }
  return std::to_string(values.size()) + (values.size() == 1 ? " value" : " values") +
         hash_text(hash_of(bytes_of(values)));
}

std::uint64_t hash_of_group(const Group& group, std::uint64_t seed) {
  const auto& [name, cells, vertices] = group;
  std::uint64_t hash = hash_of(bytes_of(vertices), hash_of(name, seed));
  for (const std::vector<Index>& numbers : cells) hash = hash_of(bytes_of(numbers), hash);
  return hash;
}

std::string text(const Mesh& mesh) {
  const auto& [vertices, blocks, groups, cell_fields] = mesh;
  std::string words = std::to_string(vertices.size()) + " vertices";
  std::uint64_t hash = hash_of(bytes_of(vertices));
  for (const CellBlock& block : blocks) {
    const auto& [kind, nodes] = block;
    words += ", " + std::to_string(block.num_cells()) + " " + std::string(name(kind));
    hash = hash_of(bytes_of(nodes), hash + static_cast<std::uint64_t>(kind));
  }
  for (const Group& group : groups) hash = hash_of_group(group, hash);
  // `cell_fields` act through the constants and fibres that are read from them.
  return words + hash_text(hash);
}

std::string text(const Rotation& rotation) {
  const auto& [axis, center, degrees] = rotation;
  return text(degrees) + " degrees about " + text(axis) + " through " + text(center);
}

template <class T>
std::string text(const std::optional<T>& value) {
  return value ? text(*value) : "not given";
}

std::string text(const TimeFunction& function) {
  const auto& [form] = function;
  if (const auto* table = std::get_if<TimeFunction::Table>(&form)) {
    const auto& [times, values] = *table;
    return "table of " + text(times) + ", " + text(values);
  }
  if (const auto* sine = std::get_if<TimeFunction::Sine>(&form)) {
    const auto& [frequency, amplitude, phase, offset] = *sine;
    return "sine" + list_text(std::array{frequency, amplitude, phase, offset});
  }
  if (const auto* ramp = std::get_if<TimeFunction::Ramp>(&form)) {
    const auto& [from, until] = *ramp;
    return "ramp" + list_text(std::array{from, until});
  }
  return "none";
}

std::string text(const Where& where) {
  const auto& [kind, group, min, max, axis, at, tolerance, center, radius, vertices] = where;
  switch (kind) {
    case Where::Kind::all:
      return "all";
    case Where::Kind::group:
      return "group " + text(group);
    case Where::Kind::box:
      return "box " + text(min) + " to " + text(max);
    case Where::Kind::plane:
      return "plane " + std::string(1, "xyz"[std::clamp(axis, 0, 2)]) + " = " + text(at) + ", tolerance " +
             text(tolerance);
    case Where::Kind::sphere:
      return "sphere of radius " + text(radius) + " about " + text(center);
    case Where::Kind::vertices:
      return "vertices " + text(vertices);
  }
  return "";
}

/// Collects entries under one prefix after another.
class Entries {
 public:
  void begin(std::string prefix) { prefix_ = std::move(prefix); }

  template <class T>
  void add(const std::string& key, const T& value) {
    entries_.emplace_back(prefix_ + key, text(value));
  }

  /// The names of a list's entries, so that one that is new or gone is named as such.
  template <class T>
  void add_names(const std::string& key, const std::vector<T>& list) {
    std::vector<std::string> names;
    for (const T& entry : list) names.push_back(text(entry.name));
    begin("");
    entries_.emplace_back(key, names.empty() ? "none" : join(names));
  }

  Fingerprint take() { return std::move(entries_); }

 private:
  std::string prefix_;
  Fingerprint entries_;
};

void add_material(const MaterialDescription& material, Entries& entries) {
  const auto& [place, law, constants, cell_constants, fibres, density] = material;
  entries.add("law", law);
  for (const auto& [name, value] : constants) entries.add(name, value);
  for (const auto& [name, values] : cell_constants) entries.add(name, values);
  for (std::size_t i = 0; i < fibres.size(); ++i) entries.add("fibres." + std::to_string(i), fibres[i]);
  entries.add("density", density);
}

void add_damping(const DampingDescription& damping, Entries& entries) {
  const auto& [mass, stiffness, shear_viscosity, bulk_viscosity] = damping;
  entries.add("damping.mass", mass);
  entries.add("damping.stiffness", stiffness);
  entries.add("damping.shear_viscosity", shear_viscosity);
  entries.add("damping.bulk_viscosity", bulk_viscosity);
}

void add_body(const BodyDescription& body, Entries& entries) {
  const auto& [place, name, mesh, mesh_name, element, quadrature, material, scale, rotate, translate,
               velocity, velocity_gradient, initial_positions, initial_velocities, mass, damping, skin] =
      body;
  const std::string prefix = "body." + name + ".";
  entries.begin(prefix);
  entries.add("mesh", mesh);
  entries.add("element", element);
  entries.add("quadrature", quadrature);
  entries.begin(prefix + "material.");
  add_material(material, entries);
  entries.begin(prefix);
  entries.add("scale", scale);
  entries.add("rotate", rotate);
  entries.add("translate", translate);
  entries.add("velocity", velocity);
  entries.add("velocity_gradient", velocity_gradient);
  entries.add("initial_positions", initial_positions);
  entries.add("initial_velocities", initial_velocities);
  entries.add("mass", mass);
  add_damping(damping, entries);
}

void add_fix(const FixDescription& fix, Entries& entries) {
  const auto& [place, name, body, where, components, displacement, gradient, rotate, velocity, until,
               time_function] = fix;
  entries.begin("fix." + name + ".");
  entries.add("body", body);
  entries.add("where", where);
  entries.add("components", components);
  entries.add("displacement", displacement);
  entries.add("gradient", gradient);
  entries.add("rotate", rotate);
  entries.add("velocity", velocity);
  entries.add("until", until);
  entries.add("time_function", time_function);
}

void add_load(const LoadDescription& load, Entries& entries) {
  const auto& [place, name, body, kind, where, value, pressure, stiffness, displacement, velocity, from,
               until, time_function] = load;
  entries.begin("load." + name + ".");
  entries.add("body", body);
  entries.add("kind", kind);
  entries.add("where", where);
  if (kind == "pressure") {
    entries.add("value", pressure);
  } else {
    entries.add("value", value);
  }
  entries.add("stiffness", stiffness);
  entries.add("displacement", displacement);
  entries.add("velocity", velocity);
  entries.add("from", from);
  entries.add("until", until);
  entries.add("time_function", time_function);
}

void add_collider(const ColliderDescription& collider, Entries& entries) {
  const auto& [place, name, kind, shape, velocity, until, activation_distance, stiffness] = collider;
  const auto& [point, normal, center, radius] = shape;
  entries.begin("collider." + name + ".");
  entries.add("kind", kind);
  entries.add("point", point);
  entries.add("normal", normal);
  entries.add("center", center);
  entries.add("radius", radius);
  entries.add("velocity", velocity);
  entries.add("until", until);
  entries.add("activation_distance", activation_distance);
  entries.add("stiffness", stiffness);
}

void add_motion(const Description& d, Entries& entries) {
  entries.add("time_step", d.time_step);
  entries.add("integrator", d.integrator);
  entries.add("adaptive", d.adaptive.has_value());
  if (!d.adaptive) return;
  const auto& [tolerance, min_step, max_step] = *d.adaptive;
  entries.add("adaptive.tolerance", tolerance);
  entries.add("adaptive.min_step", min_step);
  entries.add("adaptive.max_step", max_step);
  entries.add("end_time", d.end_time);  // adaptive steps meet it; equal ones do not see it coming
}

void add_numerics(const NewtonOptions& newton, const SolverOptions& solver, Entries& entries) {
  const auto& [tolerance, max_iterations, projection, inversion_bound] = newton;
  entries.begin("newton.");
  entries.add("tolerance", tolerance);
  entries.add("max_iterations", max_iterations);
  entries.add("projection", projection);
  entries.add("inversion_bound", inversion_bound);
  const auto& [kind, max_solver_iterations] = solver;
  entries.begin("solver.");
  entries.add("kind", kind);
  entries.add("max_iterations", max_solver_iterations);
}

/// On one line, and not too long for one.
std::string shown(const std::string& text) {
  constexpr std::size_t longest = 100;
  std::string line = text.size() > longest ? text.substr(0, longest) + "..." : text;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return line;
}

bool has(const Fingerprint& fingerprint, const std::string& name) {
  return std::ranges::find(fingerprint, name, &Fingerprint::value_type::first) != fingerprint.end();
}

}  // namespace

Fingerprint fingerprint_of(const Description& description) {
  const auto& [place, title, is_dynamic, dimension, gravity, time_step, end_time, integrator, adaptive, modes,
               load_steps, load_control, max_steps, unstable_modes, bodies, fixes, loads, colliders, probes,
               sections, newton, solver, output] = description;
  Entries entries;
  entries.begin("simulation.");
  entries.add("kind", std::string(modes ? "modes" : is_dynamic ? "dynamic" : "static"));
  entries.add("dimension", dimension);
  entries.add("gravity", gravity);
  if (is_dynamic) {
    add_motion(description, entries);
  } else {
    entries.add("load_steps", load_steps);
    entries.add("load_control", load_control);
  }
  if (modes) {
    const auto& [count, is_loaded] = *modes;
    entries.add("modes.count", count);
    entries.add("modes.about", std::string(is_loaded ? "load" : "rest"));
  }
  entries.add_names("body", bodies);
  for (const BodyDescription& body : bodies) add_body(body, entries);
  entries.add_names("fix", fixes);
  for (const FixDescription& fix : fixes) add_fix(fix, entries);
  entries.add_names("load", loads);
  for (const LoadDescription& load : loads) add_load(load, entries);
  entries.add_names("collider", colliders);
  for (const ColliderDescription& collider : colliders) add_collider(collider, entries);
  // The path of a static run ends with it, and a turn at once is over before.
  if (is_dynamic ? !adaptive && std::ranges::any_of(fixes, turns_at_once) : follows_time(description)) {
    entries.begin("simulation.");
    entries.add("end_time", end_time);
  }
  add_numerics(newton, solver, entries);
  return entries.take();
}

std::optional<FingerprintDifference> first_difference(const Fingerprint& before, const Fingerprint& now) {
  const auto [old_entry, new_entry] = std::ranges::mismatch(before, now);
  if (old_entry == before.end() && new_entry == now.end()) return std::nullopt;
  if (old_entry == before.end()) return FingerprintDifference{new_entry->first, {}, new_entry->second};
  if (new_entry == now.end() || !has(now, old_entry->first))
    return FingerprintDifference{old_entry->first, old_entry->second, {}};
  if (old_entry->first != new_entry->first)
    return FingerprintDifference{new_entry->first, {}, new_entry->second};
  return FingerprintDifference{old_entry->first, old_entry->second, new_entry->second};
}

std::string describe(const FingerprintDifference& difference) {
  const std::string name = shown(difference.name), before = shown(difference.before);
  const std::string now = shown(difference.now);
  if (now.empty()) return name + " is " + before + ", which the scene does not have";
  if (before.empty()) return name + " is not there, and is " + now + " in the scene";
  return name + " is " + before + ", not " + now + " as in the scene";
}

}  // namespace resilin
