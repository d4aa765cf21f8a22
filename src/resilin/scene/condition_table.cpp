#include <algorithm>
#include <array>

#include "resilin/scene/tables.hpp"
#include "resilin/world/load_catalog.hpp"

namespace resilin {
namespace {

void expect_order(const SceneNode& table, double from, const std::optional<double>& until) {
  if (until && *until < from) table.child("until").fail("a time at or after `from`");
}

std::vector<std::string> load_kind_names() {
  std::vector<std::string> names;
  for (const LoadKind& kind : load_kinds()) names.push_back(kind.name);
  return names;
}

/// "body_force per rest volume, traction per rest area, ..."
std::string load_kind_texts() {
  std::vector<std::string> texts;
  for (const LoadKind& kind : load_kinds()) texts.push_back(kind.name + " " + kind.text);
  return join(texts, "; ") + ".";
}

/// Keys that some kinds have and others do not.
std::vector<std::string> keys_of_kinds() {
  std::vector<std::string> keys;
  for (const LoadKind& kind : load_kinds())
    for (const auto* some : {&kind.needs, &kind.has}) keys.insert(keys.end(), some->begin(), some->end());
  return keys;
}

/// Keys of other kinds are refused, since they would do nothing.
void expect_keys_of_kind(const SceneNode& table, const LoadKind& kind) {
  const auto in = [](const std::vector<std::string>& words, const std::string& word) {
    return std::ranges::find(words, word) != words.end();
  };
  for (const std::string& name : kind.needs) {
    if (!table.has(name)) table.fail_with("a " + kind.name + " needs the key \"" + name + "\"");
  }
  for (const std::string& name : keys_of_kinds()) {
    if (table.has(name) && !in(kind.needs, name) && !in(kind.has, name)) {
      table.child(name).fail_with("a " + kind.name + " has no such key; it has " + join(kind.needs) +
                                  (kind.has.empty() ? "" : ", " + join(kind.has)));
    }
  }
}

}  // namespace

void read_components(const SceneNode& node, std::array<bool, 3>& components) {
  const std::string letters = std::string("xyz").substr(0, static_cast<std::size_t>(node.context->dimension));
  components = {false, false, false};
  for (const char letter : read_text(node)) {
    const std::size_t i = letters.find(letter);
    if (i == std::string::npos || components[i]) node.fail("letters of \"" + letters + "\", each once");
    components[i] = true;
  }
  if (std::ranges::count(components, true) == 0) node.fail("at least one letter of \"" + letters + "\"");
}

Keys<FixDescription> fix_keys() {
  using F = FixDescription;
  return {
      text_key("name", &F::name, "fix[0] ...", "Name of the reaction in the report."),
      text_key("body", &F::body, "the only body", "Name of the constrained body."),
      key<F>({"where", "[where](#where)", "", "required", "Which vertices."},
             [](const SceneNode& node, F& f) { read_where(node, f.where); }),
      key<F>({"components", "letters of \"xyz\"", "", "all", "Prescribed components."},
             [](const SceneNode& node, F& f) { read_components(node, f.components); }),
      vector_key("displacement", &F::displacement, "m", "Prescribed displacement at load factor 1."),
      matrix_key("gradient", &F::gradient, "",
                 "Adds gradient * X to the displacement, X the reference position."),
      key<F>({"rotate", "[rotate](#rotate)", "", "none",
              "Prescribed rotation, in place of displacement and gradient."},
             [](const SceneNode& node, F& f) { read_rotation(node, f.rotate); }),
      vector_key("velocity", &F::velocity, "m/s", "Prescribed velocity ..."),
      key<F>({"until", "number >= 0", "s", "the end", "... until this time; then the vertices stay."},
             [](const SceneNode& node, F& f) { f.until = read_number(node, not_negative); }),
      key<F>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on displacement, gradient and rotate in place of the load factor."},
             [](const SceneNode& node, F& f) { read_time_function(node, f.time_function); }),
      key<F>({"stiffness", "true or false", "", "false",
              "The report has its tangent stiffness at the end of a static run."},
             [](const SceneNode& node, F& f) { f.reports_stiffness = read_flag(node); }),
  };
}

void read_fix(const SceneNode& node, FixDescription& fix) {
  fix.place = node.place();
  fix.name = node.path;
  read_table(node, fix_keys(), fix);
  if (node.has("time_function") && !node.has("displacement") && !node.has("gradient") && !fix.rotate) {
    node.child("time_function")
        .fail_with("is a factor on displacement, gradient or rotate; give one of them");
  }
  if (fix.rotate && (node.has("displacement") || node.has("gradient"))) {
    node.child("rotate").fail_with("replaces displacement and gradient; give one or the other");
  }
}

Keys<LoadDescription> load_keys() {
  using L = LoadDescription;
  return {
      text_key("name", &L::name, "load[0] ...", "Name in messages and for `--set`."),
      key<L>({"kind", one_of(load_kind_names()), "", "required", load_kind_texts()},
             [](const SceneNode& node, L& l) { l.kind = read_choice(node, load_kind_names()); }),
      text_key("body", &L::body, "the only body", "Name of the loaded body."),
      key<L>({"where", "[where](#where)", "", "required but for a body_force: all",
              "Loaded vertices or surface."},
             [](const SceneNode& node, L& l) { read_where(node, l.where); }),
      key<L>({"value", "vector; number for a pressure and for a moment in 2D", "N/m^3, N/m^2, N, N m or Pa",
              "required but for a spring", "The load at load factor 1; a positive pressure acts inwards."},
             [](const SceneNode& node, L& l) {
               if (require_load_kind(l.kind, "").has_number(node.context->dimension)) {
                 l.pressure = read_number(node);
               } else {
                 l.value = read_vector(node);
               }
             }),
      key<L>({"point", "vector", "m", "the centroid of the area",
              "Force: its point of attack, on the body or off it; adds the moment of the force about the "
              "centroid."},
             [](const SceneNode& node, L& l) { l.point = read_vector(node); }),
      number_key("stiffness", &L::stiffness, "N/m", positive, "Spring: stiffness at each vertex."),
      vector_key("displacement", &L::displacement, "m",
                 "Spring: its far end is at the reference position + this ..."),
      vector_key("velocity", &L::velocity, "m/s", "... and moves at this velocity."),
      number_key("from", &L::from, "s", not_negative, "The load acts from this time ..."),
      key<L>({"until", "number >= 0", "s", "the end", "... until this time."},
             [](const SceneNode& node, L& l) { l.until = read_number(node, not_negative); }),
      key<L>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on the value (for a spring on its displacement) in place of the load factor."},
             [](const SceneNode& node, L& l) { read_time_function(node, l.time_function); }),
  };
}

void read_load(const SceneNode& node, LoadDescription& load) {
  load.place = node.place();
  load.name = node.path;
  read_table(node, load_keys(), load);
  const LoadKind& kind = require_load_kind(load.kind, node.place() + ".kind");
  expect_keys_of_kind(node, kind);
  const bool is_led = std::ranges::find(kind.has, "displacement") != kind.has.end();
  if (is_led && node.has("time_function") && !node.has("displacement")) {
    node.child("time_function").fail_with("is a factor on the " + kind.name + "'s displacement; give one");
  }
  expect_order(node, load.from, load.until);
}

}  // namespace resilin
