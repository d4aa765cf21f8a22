#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/node.hpp"
#include "resilin/scene/toml_depth.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {
namespace {

std::string place_of(std::string_view assignment) { return "--set " + printable(assignment); }

/// The parts between dots; what stands in double quotes is one part. Empty when a part is, or when a quote is
/// not closed.
std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> parts(1);
  bool is_quoted = false;
  for (const char c : path) {
    if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == '.' && !is_quoted) {
      if (parts.back().empty()) return {};
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (is_quoted || parts.back().empty()) return {};
  return parts;
}

/// Whether VALUE can be meant as a text without quotes: it starts like a word and holds nothing of TOML's
/// own.
bool is_bare_text(std::string_view text) {
  return !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) != 0 || text[0] == '/') &&
         text.find_first_of("=[]{}\"'\n\r#") == std::string_view::npos && text != "nan" && text != "inf";
}

/// "0,01", as many languages write it.
bool has_comma_for_point(std::string_view text) {
  const std::size_t comma = text.find(',');
  return comma != std::string_view::npos &&
         text.find_first_not_of("0123456789+-,.eE") == std::string_view::npos;
}

void set_source(SceneValue& value, const std::shared_ptr<const std::string>& source) {
  value.source = source;
  value.line = 0;
  if (value.is_table()) {
    for (SceneMember& member : value.table()) set_source(member.value, source);
  } else if (value.is_array()) {
    for (SceneValue& element : value.array()) set_source(element, source);
  }
}

SceneValue parse_value(std::string_view text, std::string_view assignment) {
  SceneValue value;
  try {
    SceneValue document = parse_toml("value = " + std::string(text), "--set");
    if (document.table().size() != 1) {
      throw InputError(place_of(assignment), "one value", "more than one line");
    }
    value = std::move(document.table().front().value);
  } catch (const InputError&) {
    if (!is_bare_text(text)) {
      throw InputError(place_of(assignment), "a number, true, false, a text, [a, list] or { a = \"table\" }",
                       '"' + printable(text) + '"',
                       has_comma_for_point(text) ? "write decimals with a point, not a comma"
                                                 : "a text with special signs needs \"quotes\" in it");
    }
    value.data = std::string(text);
  }
  set_source(value, std::make_shared<const std::string>(place_of(assignment)));
  return value;
}

/// "the entries are "beam" (0), "foot" (1)": the first of many.
std::string entries_text(const SceneValue::Array& array) {
  constexpr std::size_t most = 12;
  if (array.empty()) return "the list is empty";
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < std::min(array.size(), most); ++i) {
    const SceneValue* name = array[i].find("name");
    const auto* text = name == nullptr ? nullptr : std::get_if<std::string>(&name->data);
    const std::string number = std::to_string(i);
    entries.push_back(text == nullptr ? number : '"' + printable(*text) + "\" (" + number + ")");
  }
  if (array.size() > most) entries.push_back("and so on, up to " + std::to_string(array.size() - 1));
  return (array.size() == 1 ? "the one entry is " : "the entries are ") + join(entries);
}

/// The number of an entry of a list that is named by it or by its `name`.
std::size_t entry_number(const SceneValue::Array& array, const std::string& part, const std::string& place) {
  std::size_t number = 0;
  const char* end = part.data() + part.size();
  const auto parsed = std::from_chars(part.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end && number < array.size()) return number;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < array.size(); ++i) {
    const SceneValue* name = array[i].find("name");
    if (name == nullptr || !std::holds_alternative<std::string>(name->data)) continue;
    names.push_back(std::get<std::string>(name->data));
    if (names.back() == part) return i;
  }
  const std::string nearest = did_you_mean(part, names);
  throw UnknownKeyError(place, "the number or the name of an entry of a list", '"' + printable(part) + '"',
                        (nearest.empty() ? "" : nearest + " ") + entries_text(array));
}

/// One step along the path; tables that are missing on the way are made.
SceneValue& descend(SceneValue& value, const std::string& part, const std::string& place) {
  if (value.is_array()) return value.array()[entry_number(value.array(), part, place)];
  if (!value.is_table())
    throw UnknownKeyError(place, "a table before \"" + printable(part) + "\"", describe(value));
  if (SceneValue* child = value.find(part)) return *child;
  SceneValue child;
  child.source = std::make_shared<const std::string>(place);
  value.table().push_back({part, std::move(child)});
  return value.table().back().value;
}

std::vector<std::string> checked_parts(std::string_view key, const std::string& place,
                                       const std::string& expected, std::string_view got,
                                       const std::string& cure) {
  std::vector<std::string> parts = split_path(key);
  if (parts.empty()) throw InputError(place, expected, '"' + printable(got) + '"', cure);
  if (parts.size() > deepest_nesting) {
    throw InputError(place, "at most " + std::to_string(deepest_nesting) + " parts in KEY",
                     std::to_string(parts.size()));
  }
  return parts;
}

std::vector<std::string> parts_of_key(std::string_view key, const std::string& place) {
  return checked_parts(key, place, "a key of the scene such as newton.tolerance or body.0.scale", key, "");
}

void set_at(SceneValue& scene, const std::vector<std::string>& parts, SceneValue value,
            const std::string& place) {
  SceneValue* target = &scene;
  for (const std::string& part : parts) target = &descend(*target, part, place);
  *target = std::move(value);
}

}  // namespace

void set_value(SceneValue& scene, std::string_view key, SceneValue value, const std::string& place) {
  set_at(scene, parts_of_key(key, place), std::move(value), place);
}

std::string numbered_key(const SceneValue& scene, std::string_view key, const std::string& place) {
  std::string numbered;
  const SceneValue* value = &scene;
  for (const std::string& part : parts_of_key(key, place)) {
    numbered += numbered.empty() ? "" : ".";
    if (value != nullptr && value->is_array()) {
      const std::size_t number = entry_number(value->array(), part, place);
      numbered += std::to_string(number);
      value = &value->array()[number];
    } else {
      numbered += part;
      value = value == nullptr ? nullptr : value->find(part);
    }
  }
  return numbered;
}

void apply_override(SceneValue& scene, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string place = place_of(assignment);
  const std::string_view path = equals == std::string_view::npos ? "" : assignment.substr(0, equals);
  const std::vector<std::string> parts =
      checked_parts(path, place, "KEY=VALUE", assignment,
                    "write it as in --set newton.tolerance=1e-6 or --set body.0.scale=2");
  set_at(scene, parts, parse_value(assignment.substr(equals + 1), assignment), place);
}

}  // namespace resilin
