#include <algorithm>
#include <cmath>

#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

using Table = TimeFunction::Table;
using Sine = TimeFunction::Sine;
using Ramp = TimeFunction::Ramp;

Table read_points_in_time(const SceneNode& node) {
  const NumberTable points = read_pairs(node, "points [t, f]", "point in time");
  if (points.num_columns != 2 || points.num_rows() == 0)
    node.fail("points [t, f], at least one", "such as table = [[0, 0], [0.5, 1]]");
  Table table;
  for (std::size_t i = 0; i < points.num_rows(); ++i) {
    table.times.push_back(points.values[2 * i]);
    table.values.push_back(points.values[2 * i + 1]);
    if (i > 0 && !(table.times[i] > table.times[i - 1])) {
      node.fail_with("expected rising times, got " + format_number(table.times[i]) + " after " +
                     format_number(table.times[i - 1]) + " in point " + std::to_string(i) +
                     "; for a jump put two points close to each other");
    }
  }
  if (!std::ranges::all_of(points.values, [](double x) { return std::isfinite(x); }))
    node.fail_with("expected finite numbers, got inf or nan");
  return table;
}

Keys<Sine> sine_keys() {
  return {
      key<Sine>({"frequency", "number > 0", "Hz", "required", "Frequency."},
                [](const SceneNode& node, Sine& s) { s.frequency = read_number(node, positive); }),
      number_key("amplitude", &Sine::amplitude, "", any_number, "Amplitude."),
      number_key("phase", &Sine::phase, "degrees", any_number, "Phase at time 0."),
      number_key("offset", &Sine::offset, "", any_number, "Mean value."),
  };
}

Keys<Ramp> ramp_keys() {
  return {
      number_key("from", &Ramp::from, "s", any_number, "The ramp is 0 until this time, ..."),
      number_key("until", &Ramp::until, "s", any_number, "... 1 from this time on."),
  };
}

Keys<TimeFunction> time_function_keys() {
  using F = TimeFunction;
  return {
      key<F>({"table", "text or list of [t, f]", "s", "",
              "Points, or a CSV file of points: linear between them, constant before the first and after the "
              "last."},
             [](const SceneNode& node, F& f) { f.form = read_points_in_time(node); }),
      key<F>({"sine", "{ frequency, amplitude, phase, offset }", "", "",
              "offset + amplitude sin(2 pi frequency t + phase)."},
             [](const SceneNode& node, F& f) { read_table(node, sine_keys(), f.form.emplace<Sine>()); }),
      key<F>({"ramp", "{ from, until }", "s", "", "Linear ramp from 0 to 1."},
             [](const SceneNode& node, F& f) {
               Ramp& ramp = f.form.emplace<Ramp>();
               read_table(node, ramp_keys(), ramp);
               if (!(ramp.until > ramp.from)) {
                 node.fail_with("expected `until` after `from`, got " + format_number(ramp.from) + " and " +
                                format_number(ramp.until));
               }
             }),
  };
}

Keys<AdaptiveSteps> adaptive_keys() {
  using A = AdaptiveSteps;
  return {
      number_key(
          "tolerance", &A::tolerance, "", positive,
          "Error tolerance per step for the position of any vertex, relative to the scene's largest extent."),
      key<A>({"min_step", "number > 0", "s", "1e-6 time_step", "Shortest step."},
             [](const SceneNode& node, A& a) { a.min_step = read_number(node, positive); }),
      key<A>({"max_step", "number > 0", "s", "end_time", "Longest step."},
             [](const SceneNode& node, A& a) { a.max_step = read_number(node, positive); }),
  };
}

Keys<ModesOptions> modes_keys() {
  using M = ModesOptions;
  return {
      integer_key("count", &M::count, at_least_one, "Number of modes, from the lowest frequency on."),
      key<M>(
          {"about", one_of({"rest", "load"}), "", "\"rest\"",
           "Modes about the unloaded reference configuration, or about the equilibrium under the loads."},
          [](const SceneNode& node, M& m) { m.is_loaded = read_choice(node, {"rest", "load"}) == "load"; }),
  };
}

Keys<DampingDescription> damping_keys() {
  using D = DampingDescription;
  return {
      number_key("mass", &D::mass, "1/s", not_negative, "Mass-proportional (Rayleigh) damping."),
      number_key(
          "stiffness", &D::stiffness, "s", not_negative,
          "Stiffness-proportional (Rayleigh) damping with the reference stiffness; rotation is not damped."),
      number_key("shear_viscosity", &D::shear_viscosity, "Pa s", not_negative,
                 "Kelvin-Voigt shear viscosity of the material."),
      number_key("bulk_viscosity", &D::bulk_viscosity, "Pa s", not_negative,
                 "Kelvin-Voigt bulk viscosity of the material."),
  };
}

template <class T>
void append_keys(TableDoc& doc, const std::string& prefix, const Keys<T>& keys) {
  for (const Key<T>& key : keys) {
    doc.keys.push_back(key.doc);
    doc.keys.back().name = prefix + key.doc.name;
  }
}

}  // namespace

NumberTable read_pairs(const SceneNode& node, const std::string& of_what, const std::string& of_one) {
  if (std::holds_alternative<std::string>(node.value->data)) return read_csv(read_path(node));
  if (const auto* numbers = std::get_if<SceneValue::Numbers>(&node.value->data)) return **numbers;
  expect_list(node, of_what);
  return read_rows(node, node.value->array().size(), 2, of_one);
}

void read_time_function(const SceneNode& node, TimeFunction& function) {
  if (!node.value->is_table() || node.value->table().size() != 1) {
    node.fail("a table with one of table, sine, ramp", "such as { ramp = { from = 0, until = 0.5 } }");
  }
  read_table(node, time_function_keys(), function);
}

TableDoc time_function_doc() {
  TableDoc doc = document(
      "time_function",
      "A factor f(t), t the time in seconds; in a static run t is the load factor times simulation.end_time, "
      "and f replaces the load factor, so that loads can follow each other. One of",
      time_function_keys());
  append_keys(doc, "sine.", sine_keys());
  append_keys(doc, "ramp.", ramp_keys());
  return doc;
}

void read_adaptive_steps(const SceneNode& node, std::optional<AdaptiveSteps>& adaptive) {
  if (!node.context->is_dynamic)
    node.fail_with("applies to dynamics only; set simulation.kind = \"dynamic\" or leave it out");
  adaptive.emplace();
  read_table(node, adaptive_keys(), *adaptive);
  if (adaptive->min_step && adaptive->max_step && *adaptive->min_step > *adaptive->max_step)
    node.child("min_step").fail("at most max_step");
}

void read_modes(const SceneNode& node, std::optional<ModesOptions>& modes) {
  if (!modes) node.fail_with("applies to simulation.kind = \"modes\" only; set that or leave it out");
  read_table(node, modes_keys(), *modes);
}

TableDoc modes_doc() {
  return document("modes",
                  "Modal analysis, `simulation.kind = \"modes\"`: each mode is a frame of the results.",
                  modes_keys());
}

void read_damping(const SceneNode& node, DampingDescription& damping) {
  if (!node.context->is_dynamic)
    node.fail_with("applies to dynamics only; set simulation.kind = \"dynamic\" or leave it out");
  read_table(node, damping_keys(), damping);
}

TableDoc damping_doc() {
  return document("damping",
                  "A small vibration of angular frequency w has the damping ratio mass/(2w) + stiffness w/2 "
                  "([theory](theory/damping.md)).",
                  damping_keys());
}

TableDoc adaptive_doc() {
  return document(
      "adaptive",
      "Adaptive time steps by an error estimate; `time_step` is the first. Steps end at the knots of time "
      "functions, where loads begin and end, and at end_time. `{}` takes the defaults.",
      adaptive_keys());
}

}  // namespace resilin
