#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/scene/tables.hpp"
#include "resilin/world/load_catalog.hpp"

namespace resilin {
namespace {

/// An entry of [[step]].
struct StepTable {
  std::string name;
  double duration = 0;  ///< [s]; 0: not given
  std::vector<std::string> activate, deactivate;
};

void read_names(const SceneNode& node, std::vector<std::string>& names) {
  expect_list(node, "names such as \"load.press\"");
  for (std::size_t i = 0; i < node.value->array().size(); ++i) names.push_back(read_text(node.element(i)));
}

Keys<StepTable> step_keys() {
  using S = StepTable;
  return {
      text_key("name", &S::name, "step[0] ...", "Name of the step in messages."),
      key<S>({"duration", "number > 0", "s", "static: 1; dynamic: required",
              "Its duration. Those of all steps add up to the end of the run."},
             [](const SceneNode& node, S& s) { s.duration = read_number(node, positive); }),
      key<S>({"activate", "list of texts", "", "none",
              "What acts, or moves by its displacement, from this step on: `load.NAME`, `fix.NAME`, "
              "`collider.NAME`, `collider.NAME.friction`, `contact.friction`, `contact.BODY/BODY` (a contact "
              "pair), `gravity`."},
             [](const SceneNode& node, S& s) { read_names(node, s.activate); }),
      key<S>({"deactivate", "list of texts", "", "none",
              "Loads, gravity and friction that cease, colliders that go back to where they started, contact "
              "pairs that end, and supports that let go, in this step."},
             [](const SceneNode& node, S& s) { read_names(node, s.deactivate); }),
  };
}

/// A part of the scene that a step can switch.
struct Switched {
  TimeFunction* function;
  bool is_load = false;  ///< else something that moves
  std::string refusal;   ///< why no step may activate it; empty: one may
  FixDescription* fix = nullptr;
  std::array<std::string, 2> pair{};  ///< names of the bodies of a contact pair
  bool is_on = false;
  bool is_named = false;
  TimeFunction::Table table{};

  void add(double time, double value) {
    table.times.push_back(time);
    table.values.push_back(value);
  }
  /// Goes to `value` in a step; at once or evenly.
  void lead_to(double value, double begin, double end, bool at_once) {
    const double before = 1 - value;
    if (!at_once || begin > 0) add(begin, before);
    add(at_once ? begin : end, value);
  }
};

std::string why_not(const LoadDescription& load) {
  if (load.kind == "spring") return "a spring acts from the start; give it `from` and `until` instead";
  if (!load.time_function.is_constant() || load.from > 0 || load.until)
    return "its own `time_function`, `from` or `until` says when it acts; leave that out, or the name here";
  return "";
}

bool is_displaced(const FixDescription& fix) {
  return !fix.displacement.isZero(0) || !fix.gradient.isZero(0) || fix.rotate.has_value();
}

std::string why_not(const FixDescription& fix) {
  if (fix.time_function.is_constant() && fix.velocity.isZero(0)) return "";
  return "its own `time_function` or `velocity` says when it moves; leave that out, or the name here";
}

std::string why_not(const ColliderDescription& collider) {
  if (!collider.time_function.is_constant())
    return "its own `time_function` says when it moves; leave that out, or the name here";
  return collider.displacement.isZero(0) ? "it has no displacement for a step to lead it by; give it one"
                                         : "";
}

using SwitchedByName = std::map<std::string, Switched>;

SwitchedByName all_switched(Description& d) {
  SwitchedByName all;
  for (LoadDescription& load : d.loads)
    all["load." + load.name] = {.function = &load.time_function, .is_load = true, .refusal = why_not(load)};
  for (FixDescription& fix : d.fixes) {
    all["fix." + fix.name] = {.function = &fix.time_function, .refusal = why_not(fix), .fix = &fix};
    all["fix." + fix.name].is_on = true;  // it holds
  }
  for (ColliderDescription& collider : d.colliders)
    all["collider." + collider.name] = {.function = &collider.time_function, .refusal = why_not(collider)};
  for (ColliderDescription& collider : d.colliders)
    if (collider.friction > 0)
      all["collider." + collider.name + ".friction"] = {
          .function = &collider.friction_factor, .is_load = true, .refusal = ""};
  if (d.contact.friction > 0 || std::ranges::any_of(d.contact.pairs, [](const ContactPairDescription& pair) {
        return pair.friction.value_or(0) > 0;
      }))
    all["contact.friction"] = {.function = &d.contact.friction_factor, .is_load = true, .refusal = ""};
  if (!d.gravity.isZero(0))
    all["gravity"] = {.function = &d.gravity_function, .is_load = true, .refusal = ""};
  return all;
}

/// Contact pairs that a step can name, in both orders.
void add_pairs(const Description& d, SwitchedByName& all) {
  if (!d.contact.is_enabled) return;
  for (const BodyDescription& a : d.bodies)
    for (const BodyDescription& b : d.bodies)
      all["contact." + a.name + "/" + b.name] = {
          .function = nullptr, .refusal = "", .pair = {a.name, b.name}, .is_on = true};
}

bool is_pair(const ContactPairDescription& pair, const std::array<std::string, 2>& bodies) {
  return pair.bodies == bodies || (pair.bodies[0] == bodies[1] && pair.bodies[1] == bodies[0]);
}

/// The entry of a contact pair that counts, made if there is none.
ContactPairDescription& find_pair(Description& d, const std::array<std::string, 2>& bodies,
                                  const std::string& place) {
  std::vector<ContactPairDescription>& pairs = d.contact.pairs;
  for (auto pair = pairs.rbegin(); pair != pairs.rend(); ++pair)
    if (is_pair(*pair, bodies)) return *pair;
  ContactPairDescription& pair = pairs.emplace_back();
  pair.place = place;
  pair.bodies = bodies;
  return pair;
}

Switched& find_switched(const SceneNode& node, const std::string& name, const Description& d,
                        SwitchedByName& all) {
  if (name.starts_with("contact.") && name.find('/') != std::string::npos) {
    if (!d.contact.is_enabled) node.fail_with("contact between bodies is disabled; set contact.enabled");
    if (!all.contains(name)) add_pairs(d, all);
  }
  const auto found = all.find(name);
  if (found == all.end()) {
    std::vector<std::string> names;
    for (const auto& [known, entry] : all) names.push_back(known);
    const std::string nearest = did_you_mean(name, names);
    node.fail(
        "what a step can switch in this scene (load.NAME, fix.NAME, collider.NAME, "
        "collider.NAME.friction, contact.friction, contact.BODY/BODY, gravity)",
        nearest.empty() ? "there are " + (names.empty() ? "none" : join(names)) : nearest);
  }
  return found->second;
}

/// In statics, entries that no step names belong to the first one.
void ramp_in(TimeFunction& function, double end) {
  if (function.is_constant()) function.form = TimeFunction::Ramp{.from = 0, .until = end};
}

template <class T>
void ramp_in(std::vector<T>& entries, double end) {
  for (T& entry : entries) ramp_in(entry.time_function, end);
}

void refuse_beside_steps(const SceneNode& root, const Description& d) {
  const SceneNode list = root.child("step");
  if (d.modes) list.fail_with("a modal analysis has no steps; leave them out");
  if (!d.is_dynamic && d.load_control == LoadControlKind::arc_length)
    list.fail_with("arc length follows one load path; leave out load_control, or the steps");
  if (!root.has("simulation")) return;
  const SceneNode simulation = root.child("simulation");
  if (simulation.has("end_time"))
    simulation.child("end_time").fail_with("the durations of the steps add up to the end; leave it out");
}

/// When a step happens.
struct StepTimes {
  double begin, end, first_end;
  bool is_dynamic;
};

/// A support takes hold where its vertices are and moves by its displacement, or lets go.
void switch_support(const SceneNode& node, const std::string& name, bool is_on, const StepTimes& times,
                    Switched& entry) {
  FixDescription& fix = *entry.fix;
  const bool has_let_go = !entry.is_on;
  if (is_on && !has_let_go && !is_displaced(fix))
    node.fail_with("\"" + name + "\": it has no displacement for a step to lead it by; give it one");
  if (is_on && !has_let_go && entry.is_named)
    node.fail_with("\"" + name + "\" is active already; leave it out here");
  if (!is_on && has_let_go) node.fail_with("\"" + name + "\" is not active here; leave it out");
  const bool is_led = is_displaced(fix) && entry.refusal.empty();
  if (!is_on && !entry.is_named && is_led && times.begin > 0) {
    // No step has led it: in statics the first one does, in motion it is there from the start.
    if (!times.is_dynamic) entry.add(0, 0);
    entry.add(times.is_dynamic ? 0 : times.first_end, 1);
  }
  if (is_on && is_led) entry.lead_to(1, times.begin, times.end, false);
  if (is_on == has_let_go) fix.switches.push_back(times.begin);
  entry.is_on = is_on;
}

/// A contact pair acts from the start, unless the first step that names it activates it.
void switch_pair(const SceneNode& node, const std::string& name, bool is_on, const StepTimes& times,
                 SwitchedByName& all, Description& d) {
  const std::array<std::string, 2> bodies = all[name].pair;
  Switched& entry = all["contact." + std::min(bodies[0], bodies[1]) + "/" + std::max(bodies[0], bodies[1])];
  ContactPairDescription& pair = find_pair(d, bodies, node.path);
  if (!entry.is_named) pair.is_enabled = entry.is_on = !is_on;
  entry.is_named = true;
  if (entry.is_on == is_on)
    node.fail_with("\"" + name + "\" is " + (is_on ? "" : "not ") + "active " + (is_on ? "already" : "here") +
                   "; leave it out" + (is_on ? " here" : ""));
  entry.is_on = is_on;
  if (!pair.switches.empty() && pair.switches.back() == times.begin)
    node.fail_with("\"" + name + "\" is twice in one step");
  if (times.begin > 0)
    pair.switches.push_back(times.begin);
  else
    pair.is_enabled = is_on;
}

void switch_other(const SceneNode& node, const std::string& name, bool is_on, const StepTimes& times,
                  Switched& entry) {
  if (is_on && entry.is_on) node.fail_with("\"" + name + "\" is active already; leave it out here");
  if (!is_on && !entry.is_on && entry.is_named)
    node.fail_with("\"" + name + "\" is not active here; leave it out");
  if (!is_on && !entry.is_named)
    node.fail_with("no step before activates \"" + name + "\"; name it in `activate` of the first one");
  entry.is_on = is_on;
  entry.lead_to(is_on ? 1 : 0, times.begin, times.end, times.is_dynamic && entry.is_load);
}

/// Applies `activate` or `deactivate` of one step.
void switch_all(const SceneNode& step, const char* key, const std::vector<std::string>& names,
                const StepTimes& times, SwitchedByName& all, std::set<std::string>& in_this_step,
                Description& d) {
  const bool is_on = std::string_view(key) == "activate";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const SceneNode node = step.child(key).element(i);
    Switched& entry = find_switched(node, names[i], d, all);
    if (!entry.refusal.empty() && (is_on || entry.fix == nullptr))
      node.fail_with("\"" + names[i] + "\": " + entry.refusal);
    if (!in_this_step.insert(names[i]).second) node.fail_with("\"" + names[i] + "\" is twice in one step");
    if (!entry.pair[0].empty()) {
      switch_pair(node, names[i], is_on, times, all, d);
      continue;
    }
    entry.fix != nullptr ? switch_support(node, names[i], is_on, times, entry)
                         : switch_other(node, names[i], is_on, times, entry);
    entry.is_named = true;
  }
}

}  // namespace

TableDoc step_doc() {
  return document("[[step]]",
                  "Steps in sequence: what acts and moves when ([steps](steps.md)). They are read into time "
                  "functions.",
                  step_keys());
}

void read_steps(const SceneNode& root, Description& d) {
  if (!root.has("step")) return;
  const SceneNode list = root.child("step");
  if (!list.value->is_array() || list.value->array().empty())
    list.fail("a list of tables, each headed [[step]]");
  refuse_beside_steps(root, d);
  SwitchedByName all = all_switched(d);
  std::set<std::string> step_names;
  double begin = 0, first_end = 0;
  const std::size_t num_steps = list.value->array().size();
  for (std::size_t i = 0; i < num_steps; ++i) {
    const SceneNode node = list.element(i);
    StepTable step;
    step.name = node.path;
    read_table(node, step_keys(), step);
    if (!step_names.insert(step.name).second)
      node.child("name").fail_with("another step is called \"" + step.name + "\"; give it another name");
    if (step.duration == 0 && d.is_dynamic)
      node.fail_with("a step of a dynamic run needs the key \"duration\"");
    const double end = begin + (step.duration == 0 ? 1 : step.duration);
    if (i == 0) first_end = end;
    std::set<std::string> in_this_step;
    const StepTimes times{.begin = begin, .end = end, .first_end = first_end, .is_dynamic = d.is_dynamic};
    switch_all(node, "activate", step.activate, times, all, in_this_step, d);
    switch_all(node, "deactivate", step.deactivate, times, all, in_this_step, d);
    d.steps.push_back({.place = node.path, .name = step.name, .end = end});
    begin = end;
  }
  for (auto& [name, entry] : all)
    if (!entry.table.times.empty()) entry.function->form = std::move(entry.table);
  d.end_time = begin;
  if (d.is_dynamic) return;
  d.load_steps *= static_cast<int>(num_steps);
  if (!d.gravity.isZero(0)) ramp_in(d.gravity_function, first_end);
  ramp_in(d.loads, first_end);
  ramp_in(d.fixes, first_end);
  ramp_in(d.constraints, first_end);
  ramp_in(d.colliders, first_end);
}

}  // namespace resilin
