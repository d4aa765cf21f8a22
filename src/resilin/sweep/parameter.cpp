#include "resilin/sweep/parameter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "resilin/core/hash.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/sweep/scene_hash.hpp"

namespace resilin {
namespace {

constexpr std::uint64_t most_values = 1000000000000;  // most values of one parameter

const std::vector<std::string>& form_names() {
  static const std::vector<std::string> names = {"values", "linspace", "logspace",
                                                 "range",  "uniform",  "log_uniform"};
  return names;
}

template <class Number>
SceneValue number_value(Number x, const SceneValue& origin) {
  SceneValue value = origin;
  value.data = x;
  return value;
}

SceneValue origin_of(const SceneNode& node) {
  SceneValue origin;
  origin.source = node.value->source;
  origin.line = node.value->line;
  return origin;
}

double number_at(const SceneNode& list, std::size_t i) { return read_number(list.element(i)); }

void read_ends(const SceneNode& node, bool is_logarithmic, SweepParameter& parameter) {
  parameter.from = number_at(node, 0);
  parameter.to = number_at(node, 1);
  parameter.is_logarithmic = is_logarithmic;
  if (is_logarithmic && !(parameter.from > 0 && parameter.to > 0))
    node.fail_with("expected ends > 0, which are values and not exponents, got " +
                   format_number(std::min(parameter.from, parameter.to)));
}

void read_spaced(const SceneNode& node, bool is_logarithmic, SweepParameter& parameter) {
  expect_list(node, "numbers: the first value, the last value, how many", 3);
  parameter.kind = SweepParameter::Kind::spaced;
  read_ends(node, is_logarithmic, parameter);
  parameter.count = static_cast<std::uint64_t>(read_integer(node.element(2), at_least_one));
}

void read_interval(const SceneNode& node, bool is_logarithmic, SweepParameter& parameter) {
  expect_list(node, "numbers: the ends of the interval", 2);
  parameter.kind = SweepParameter::Kind::interval;
  read_ends(node, is_logarithmic, parameter);
  if (!(parameter.from < parameter.to))
    node.fail_with("expected ends that rise, got " + format_number(parameter.from) + " and " +
                   format_number(parameter.to));
}

/// [first, last] or [first, last, step]; the last is one of the values where the steps reach it.
void read_range(const SceneNode& node, SweepParameter& parameter) {
  expect_list(node, "numbers: the first value, the last value and, unless 1, the step");
  const SceneValue::Array& entries = node.value->array();
  if (entries.size() != 2 && entries.size() != 3) node.fail("a list of 2 or 3 numbers");
  const double first = number_at(node, 0), last = number_at(node, 1);
  const double step = entries.size() == 3 ? number_at(node, 2) : 1;
  const double steps = (last - first) / step;
  if (!(steps >= 0) || !std::isfinite(steps))
    node.fail_with("expected a step that leads from the first value to the last");
  if (steps >= static_cast<double>(most_values)) node.fail_with("expected fewer than 1e12 values");
  const double whole_steps = std::floor(steps * (1 + 4e-16) + 1e-9);  // 0.1 is none of the doubles
  parameter.kind = SweepParameter::Kind::spaced;
  parameter.from = first;
  parameter.to = first + whole_steps * step;
  parameter.count = static_cast<std::uint64_t>(whole_steps) + 1;
  parameter.is_whole = std::ranges::all_of(
      entries, [](const SceneValue& entry) { return std::holds_alternative<std::int64_t>(entry.data); });
}

void read_form(const SceneNode& node, const std::string& form, SweepParameter& parameter) {
  if (form == "linspace" || form == "logspace") return read_spaced(node, form == "logspace", parameter);
  if (form == "uniform" || form == "log_uniform")
    return read_interval(node, form == "log_uniform", parameter);
  if (form == "range") return read_range(node, parameter);
  expect_list(node, "values");
  if (node.value->array().empty()) node.fail("a list of at least one value");
  parameter.values = node.value->array();
}

/// A word that is nearly a form is no key of a scene; `value` beside `values` is one.
void refuse_misspelt_form(const SceneNode& node, const std::string& word) {
  if (!node.value->is_array()) return;  // the name of a body, say
  const std::vector<std::string> forms(form_names().begin() + 1, form_names().end());
  if (const std::string cure = did_you_mean(word, forms); !cure.empty())
    node.fail_with("expected one of " + join(form_names()) + ", got \"" + one_line(word) + "\"; " + cure);
}

void read_into(const SceneNode& node, const std::string& key, std::vector<SweepParameter>& parameters) {
  if (!is_parameter_values(*node.value)) {
    if (!node.value->is_table() || node.value->table().empty())
      node.fail("a list of values or a table with one of " + join(form_names()),
                "a single value belongs into the base scene, or is a list of one");
    for (const SceneMember& member : node.value->table()) {
      refuse_misspelt_form(node.child(member.key), member.key);
      const bool has_dots = member.key.find('.') != std::string::npos;
      // A key in quotes is a path already, "body.0.scale", unless it continues one.
      const std::string part = has_dots && !key.empty() ? '"' + member.key + '"' : member.key;
      std::string longer = key;
      if (!key.empty()) longer += '.';
      longer += part;
      read_into(node.child(member.key), longer, parameters);
    }
    return;
  }
  SweepParameter parameter;
  parameter.keys = {key};
  parameter.name = key;
  parameter.place = node.place();
  parameter.origin = origin_of(node);
  read_parameter_values(node, parameter);
  parameters.push_back(std::move(parameter));
}

}  // namespace

SceneValue SweepParameter::value(std::uint64_t i) const {
  if (kind == Kind::list) return values[static_cast<std::size_t>(i)];
  const double share = count == 1 ? 0 : static_cast<double>(i) / static_cast<double>(count - 1);
  if (is_whole)
    return number_value(static_cast<std::int64_t>(std::llround(from + share * (to - from))), origin);
  if (i == 0) return number_value(from, origin);
  if (i + 1 == count) return number_value(to, origin);
  if (is_logarithmic) return number_value(from * std::pow(to / from, share), origin);
  return number_value(from + share * (to - from), origin);
}

SceneValue SweepParameter::at(double x) const {
  if (kind == Kind::interval)
    return number_value(is_logarithmic ? from * std::pow(to / from, x) : from + x * (to - from), origin);
  const auto i = static_cast<std::uint64_t>(x * static_cast<double>(size()));
  return value(std::min(i, size() - 1));
}

bool is_parameter_values(const SceneValue& value) {
  if (value.is_array()) return true;
  return value.is_table() && value.table().size() == 1 &&
         std::ranges::find(form_names(), value.table().front().key) != form_names().end();
}

void read_parameter_values(const SceneNode& node, SweepParameter& parameter) {
  if (!node.value->is_table()) return read_form(node, "values", parameter);
  const std::string form = node.value->table().front().key;
  read_form(node.child(form), form, parameter);
}

void read_parameters(const SceneNode& node, std::vector<SweepParameter>& parameters) {
  expect_table(node);
  if (node.value->table().empty()) node.fail("keys of the scene with their values");
  for (const SceneMember& member : node.value->table())
    read_into(node.child(member.key), member.key, parameters);
  // TOML tables come in the order of the alphabet.
  std::ranges::stable_sort(parameters, {},
                           [](const SweepParameter& parameter) { return parameter.origin.line; });
}

SweepParameter read_parameter(const SceneNode& node) {
  expect_table(node);
  std::vector<std::string> known = form_names();
  known.insert(known.begin(), {"key", "name"});
  refuse_unknown_keys(node, known);
  SweepParameter parameter;
  parameter.place = node.place();
  parameter.origin = origin_of(node);
  if (!node.has("key")) node.fail_with("the key \"key\" is missing; give the key of the scene that varies");
  const SceneNode key = node.child("key");
  if (key.value->is_array()) {
    for (std::size_t i = 0; i < key.value->array().size(); ++i)
      parameter.keys.push_back(read_text(key.element(i)));
    if (parameter.keys.empty()) key.fail("a key of the scene, or a list of them");
  } else {
    parameter.keys = {read_text(key)};
  }
  parameter.name = node.has("name") ? read_text(node.child("name")) : parameter.keys.front();
  if (parameter.name.empty()) node.child("name").fail("a text that is not empty");
  std::vector<std::string> given;
  for (const std::string& form : form_names())
    if (node.has(form)) given.push_back(form);
  if (given.size() != 1)
    node.fail_with("expected one of " + join(form_names()) + ", got " +
                   (given.empty() ? "none" : join(given, " and ")));
  read_form(node.child(given.front()), given.front(), parameter);
  return parameter;
}

std::string describe_values(const SweepParameter& parameter) {
  if (parameter.kind == SweepParameter::Kind::list) {
    std::string list;
    FileHashes no_files{""};
    for (const SceneValue& value : parameter.values)
      list += (list.empty() ? "" : ", ") + shown_value(value, no_files);
    constexpr std::size_t longest = 200;
    if (list.size() <= longest) return "[" + list + "]";
    return std::to_string(parameter.values.size()) + " values (hash " + hash_text(hash_of(list)) + ")";
  }
  std::string text = parameter.is_logarithmic ? "logarithmic " : parameter.is_whole ? "whole " : "";
  text += "from " + format_number(parameter.from) + " to " + format_number(parameter.to);
  if (parameter.kind == SweepParameter::Kind::spaced)
    text += ", " + std::to_string(parameter.count) + " values";
  return text;
}

}  // namespace resilin
