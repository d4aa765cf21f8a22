#include "resilin/world/fingerprint.hpp"

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <span>
#include <string_view>

#include "resilin/core/hash.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/description_members.hpp"
#include "resilin/world/event_times.hpp"
#include "resilin/world/support.hpp"

// All members of a description are in it (description_members.hpp), and a new one is, too, until somebody has
// said here that the steps do not depend on it.

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
  requires std::is_arithmetic_v<T> || std::is_same_v<T, Vector3>
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

std::string text(const ColliderTurn& turn) {
  const auto& [axis, center, degrees, degrees_per_second] = turn;
  return text(degrees) + " degrees and " + text(degrees_per_second) + " in a second about " + text(axis) +
         " through " + text(center);
}

template <class T>
  requires requires(const T& value) { text(value); }
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
  const auto& [kind, group, min, max, axis, at, tolerance, center, radius, vertices, face_at, normal, angle] =
      where;
  if (normal) {
    Where rest = where;
    rest.normal.reset();
    return text(rest) + ", normals within " + text(angle) + " degrees of " + text(*normal);
  }
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
    case Where::Kind::face:
      return "face at " + text(face_at) + ", angles up to " + text(angle) + " degrees";
  }
  return "";
}

std::string text(const ContactPairDescription& pair) {
  const auto& [place, bodies, is_enabled, friction, switches] = pair;
  return text(bodies[0]) + " and " + text(bodies[1]) + (is_enabled ? " meet" : " pass") +
         (friction ? ", friction " + text(*friction) : "") +
         (switches.empty() ? "" : ", switched at " + list_text(switches));
}

template <class T>
concept Worded = requires(const T& value) { text(value); };

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

// ---- which members the steps depend on, beside those that others of their struct make idle

template <class T>
bool is_seen(const T&, std::string_view member) {
  return !is_one_of(member, {"place", "name"});
}

bool is_seen(const BodyDescription& body, std::string_view member) {
  if (member == "skin") return body.contact_surface == MeetingSurface::skin;
  if (member == "contact_shape") return !body.contact_shape.empty();
  if (member == "rigid") return body.rigid.has_value();
  return !is_one_of(member, {"place", "name", "mesh_name"});
}

bool is_seen(const CableDescription& cable, std::string_view member) {
  if (is_one_of(member, {"elongations", "forces"})) return !cable.forces.empty();
  return !is_one_of(member, {"place", "name"});
}

bool is_seen(const RigidDescription& rigid, std::string_view member) {
  if (member == "region_of") return !rigid.region_of.empty();
  return !is_one_of(member, {"place", "name"});
}

bool is_seen(const RegionDescription& region, std::string_view member) {
  if (member == "rigid") return region.rigid.has_value();
  return !is_one_of(member, {"place", "name"});
}

bool is_seen(const FixDescription& fix, std::string_view member) {
  if (member == "switches") return !fix.switches.empty();
  return !is_one_of(member, {"place", "name", "reports_stiffness"});
}

bool is_seen(const ColliderDescription& collider, std::string_view member) {
  if (member == "friction_factor") return !collider.friction_factor.is_constant();
  return !is_one_of(member, {"place", "name"});
}

bool is_seen(const ContactDescription& contact, std::string_view member) {
  if (member == "friction_factor") return !contact.friction_factor.is_constant();
  return member != "place";
}

bool is_seen(const SkinDescription&, std::string_view member) {
  return !is_one_of(member, {"place", "surface_name"});
}

bool is_seen(const ShapeDescription&, std::string_view member) { return member != "mesh_name"; }

bool is_seen(const NewtonOptions&, std::string_view member) {
  return member != "max_failures";  // when to give up, not what is computed
}

bool is_seen(const LoadDescription& load, std::string_view member) {
  if (load.kind == "moment") return !is_one_of(member, {"place", "name"});  // a vector, in 2D a number
  return !is_one_of(member, {"place", "name", load.kind == "pressure" ? "value" : "pressure"});
}

bool is_seen(const Description& description, std::string_view member) {
  // `simulation.kind` says in one word what is_dynamic does; unstable modes are only counted, and jumps end a
  // run.
  if (is_one_of(member, {"place", "title", "is_dynamic", "max_steps", "unstable_modes", "on_jump", "probes",
                         "sections", "output", "end_time"}))
    return false;
  if (member == "gravity_function") return !description.gravity_function.is_constant();
  // Increments of a static run follow the durations of the steps. Forces of a support or a contact pair that
  // a step releases fade until the step ends.
  if (member == "steps") return !description.is_dynamic || has_phases(description);
  if (is_one_of(member, {"time_step", "integrator", "adaptive"})) return description.is_dynamic;
  if (is_one_of(member, {"load_steps", "load_control"})) return !description.is_dynamic;
  return true;
}

/// Adaptive steps meet the end, a turn at once is over before it, a collider without a function of time is at
/// its displacement then, and the path of a static run ends with it;
/// equal steps do not see it coming.
bool is_end_seen(const Description& description) {
  if (!description.is_dynamic) return follows_time(description);
  const auto goes_evenly = [](const ColliderDescription& collider) {
    return !collider.displacement.isZero(0) && collider.time_function.is_constant();
  };
  return description.adaptive.has_value() || std::ranges::any_of(description.fixes, turns_at_once) ||
         std::ranges::any_of(description.colliders, goes_evenly);
}

/// How a scene calls a member; empty when its parts stand beside the other members.
std::string key_of(std::string_view member) {
  if (member == "is_enabled") return "enabled";
  if (member == "with_themselves") return "self";
  if (member == "pairs") return "pair";
  if (member == "regions") return "region";
  if (member == "is_smooth") return "smooth";
  if (is_one_of(member, {"constants", "cell_constants", "shape"})) return "";
  return std::string(member == "pressure" ? "value" : member);
}

std::string table_of(std::string_view list) {
  constexpr std::pair<std::string_view, const char*> tables[] = {
      {"bodies", "body"},        {"fixes", "fix"},      {"ties", "tie"},     {"constraints", "constraint"},
      {"joints", "joint"},       {"springs", "spring"}, {"cables", "cable"}, {"loads", "load"},
      {"colliders", "collider"}, {"steps", "step"}};
  for (const auto& [name, table] : tables)
    if (list == name) return table;
  return std::string(list);
}

/// Collects the members that are seen under their names.
class Entries {
 public:
  explicit Entries(const Description& description) {
    const char* still = description.modes ? "modes" : "static";
    add("simulation.kind", std::string(description.is_dynamic ? "dynamic" : still));
    visit_members(description, [&](std::string_view member, const auto& value) {
      if (is_seen(description, member)) add_part(std::string(member), value);
    });
    if (is_end_seen(description))
      add("simulation.end_time", description.end_time);  // last: others make it seen
  }

  Fingerprint take() { return std::move(entries_); }

 private:
  // Parts of a scene.

  template <class T>
  void add_part(const std::string& member, const T& value) {
    add("simulation." + member, value);
  }
  void add_part(const std::string& member, const NewtonOptions& newton) { add(member, newton); }
  void add_part(const std::string& member, const SolverOptions& solver) { add(member, solver); }
  void add_part(const std::string& member, const ContactDescription& contact) { add(member, contact); }
  void add_part(const std::string&, const OutputOptions&) {}  // never seen
  template <class T>
  void add_part(const std::string& member, const std::vector<T>& list) {
    const std::string table = table_of(member);
    const bool is_rare = is_one_of(member, {"ties", "constraints", "joints", "springs", "cables"});
    if (is_rare && list.empty()) return;  // as before there were any
    std::vector<std::string> names;       // so that one that is new or gone is named as such
    for (const T& entry : list) names.push_back(text(entry.name));
    entries_.emplace_back(table, names.empty() ? "none" : join(names));
    for (const T& entry : list) add(table + "." + entry.name, entry);
  }

  // Values: in words, or by their own parts.

  template <Worded T>
  void add(const std::string& key, const T& value) {
    entries_.emplace_back(key, text(value));
  }
  template <class T>
    requires HasMembers<const T> && (!Worded<T>)
  void add(const std::string& key, const T& whole) {
    visit_members(whole, [&](std::string_view member, const auto& value) {
      if (!is_seen(whole, member)) return;
      const std::string own = key_of(member);
      add(own.empty() ? key : key + "." + own, value);
    });
  }
  void add(const std::string& key, const ModesOptions& modes) {
    const auto& [count, is_loaded] = modes;
    add(key + ".count", count);
    add(key + ".about", std::string(is_loaded ? "load" : "rest"));
  }
  template <class T>
    requires(!Worded<T>)
  void add(const std::string& key, const std::optional<T>& value) {
    add(key, value.has_value());
    if (value) add(key, *value);
  }
  template <class T>
  void add(const std::string& key, const std::map<std::string, T>& values) {
    for (const auto& [name, value] : values) add(std::string(key).append(".").append(name), value);
  }
  void add(const std::string& key, const std::vector<ContactPairDescription>& pairs) {
    for (const ContactPairDescription& pair : pairs) add(key, pair);
  }
  void add(const std::string& key, const std::array<TiedSurface, 2>& surfaces) {
    for (std::size_t i = 0; i < surfaces.size(); ++i) add(key + "." + std::to_string(i), surfaces[i]);
  }
  void add(const std::string& key, const std::vector<ConstraintTerm>& terms) {
    for (std::size_t i = 0; i < terms.size(); ++i) add(key + "." + std::to_string(i), terms[i]);
  }
  void add(const std::string& key, const std::vector<AnchorDescription>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) add(key + "." + std::to_string(i), points[i]);
  }
  void add(const std::string& key, const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const std::string& each : names) words.push_back(text(each));
    entries_.emplace_back(key, join(words));
  }
  void add(const std::string& key, const std::vector<RegionDescription>& regions) {
    if (regions.empty()) return;
    std::vector<std::string> names;  // so that a name that is new or gone is named as such
    for (const RegionDescription& region : regions) names.push_back(text(region.name));
    entries_.emplace_back(key, join(names));
    for (const RegionDescription& region : regions) add(key + "." + region.name, region);
  }
  void add(const std::string& key, const std::vector<std::vector<Vector3>>& lists) {
    for (std::size_t i = 0; i < lists.size(); ++i) add(key + "." + std::to_string(i), lists[i]);
  }

  Fingerprint entries_;
};

/// On one line, and not too long for one.
std::string shown(const std::string& text) {
  constexpr std::size_t longest = 100;
  return one_line(text.size() > longest ? text.substr(0, longest) + "..." : text);
}

bool has(const Fingerprint& fingerprint, const std::string& name) {
  return std::ranges::find(fingerprint, name, &Fingerprint::value_type::first) != fingerprint.end();
}

}  // namespace

Fingerprint fingerprint_of(const Description& description) { return Entries(description).take(); }

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
