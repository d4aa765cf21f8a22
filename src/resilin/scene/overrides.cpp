#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/toml_depth.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {
namespace {

std::string place_of(std::string_view assignment) { return "--set " + printable(assignment); }

std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// Whether VALUE can be meant as a text without quotes: it starts like a word and holds nothing of TOML's
/// own.
bool is_bare_text(std::string_view text) {
  return !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) != 0 || text[0] == '/') &&
         text.find_first_of("=[]{}\"'\n\r#") == std::string_view::npos && text != "nan" && text != "inf";
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
                       '"' + printable(text) + '"', "a text with special signs needs \"quotes\" in it");
    }
    value.data = std::string(text);
  }
  set_source(value, std::make_shared<const std::string>(place_of(assignment)));
  return value;
}

std::vector<std::string> names_of(const SceneValue::Array& array) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < array.size(); ++i) {
    names.push_back(std::to_string(i));
    const SceneValue* name = array[i].find("name");
    if (name != nullptr && std::holds_alternative<std::string>(name->data)) {
      names.back() += " (" + printable(std::get<std::string>(name->data)) + ")";
    }
  }
  return names;
}

/// The entry of a list by number or by its `name`.
SceneValue& element(SceneValue::Array& array, const std::string& part, std::string_view assignment) {
  std::size_t number = 0;
  const char* end = part.data() + part.size();
  const auto parsed = std::from_chars(part.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end && number < array.size()) return array[number];
  for (SceneValue& entry : array) {
    const SceneValue* name = entry.find("name");
    if (name != nullptr && std::holds_alternative<std::string>(name->data) &&
        std::get<std::string>(name->data) == part) {
      return entry;
    }
  }
  throw InputError(place_of(assignment), "the number or the name of an entry of a list",
                   '"' + printable(part) + '"',
                   array.empty() ? "the list is empty" : "there are " + join(names_of(array)));
}

/// One step along the path; tables that are missing on the way are made.
SceneValue& descend(SceneValue& value, const std::string& part, std::string_view assignment) {
  if (value.is_array()) return element(value.array(), part, assignment);
  if (!value.is_table()) {
    throw InputError(place_of(assignment), "a table before \"" + printable(part) + "\"", describe(value));
  }
  if (SceneValue* child = value.find(part)) return *child;
  SceneValue child;
  child.source = std::make_shared<const std::string>(place_of(assignment));
  value.table().push_back({part, std::move(child)});
  return value.table().back().value;
}

}  // namespace

void apply_override(SceneValue& scene, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string_view path = assignment.substr(0, equals);
  const std::vector<std::string> parts = split_path(path);
  if (equals == std::string_view::npos || std::ranges::any_of(parts, &std::string::empty)) {
    throw InputError(place_of(assignment), "KEY=VALUE", '"' + printable(assignment) + '"',
                     "write it as in --set newton.tolerance=1e-6 or --set body.0.scale=2");
  }
  if (parts.size() > deepest_nesting) {
    throw InputError(place_of(assignment), "at most " + std::to_string(deepest_nesting) + " parts in KEY",
                     std::to_string(parts.size()));
  }
  SceneValue value = parse_value(assignment.substr(equals + 1), assignment);
  SceneValue* target = &scene;
  for (const std::string& part : parts) target = &descend(*target, part, assignment);
  *target = std::move(value);
}

}  // namespace resilin
