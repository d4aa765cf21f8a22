#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {
namespace {

constexpr std::size_t widest = 118;  // letters of a line

std::string toml_string(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') result += '\\';
    if (code >= 0x20 && code != 0x7f) {
      result += c;
    } else {
      result += "\\u00";
      result += digits[code >> 4];
      result += digits[code & 15];
    }
  }
  return result + '"';
}

std::string key_text(const std::string& key) {
  const auto is_bare = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !key.empty() && std::ranges::all_of(key, is_bare) ? key : toml_string(key);
}

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const std::string text = format_number(value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

bool is_list_of_tables(const SceneValue& value) {
  return value.is_array() && !value.array().empty() &&
         std::ranges::all_of(value.array(), [](const SceneValue& entry) { return entry.is_table(); });
}

/// A value behind its key. Long arrays go on in further lines.
std::string inline_text(const SceneValue& value);

std::string array_text(const SceneValue::Array& array) {
  std::string text = "[";
  std::size_t line = 0;  // where it begins
  for (std::size_t i = 0; i < array.size(); ++i) {
    const std::string entry = inline_text(array[i]) + (i + 1 < array.size() ? ", " : "");
    if (text.size() - line + entry.size() > widest && text.size() > line + 1) {
      while (text.back() == ' ') text.pop_back();
      line = text.size() + 1;
      text += "\n  ";
    }
    text += entry;
  }
  return text + ']';
}

std::string table_text(const SceneValue::Table& table) {
  if (table.empty()) return "{}";
  std::string text = "{ ";
  for (std::size_t i = 0; i < table.size(); ++i)
    text += (i > 0 ? ", " : "") + key_text(table[i].key) + " = " + inline_text(table[i].value);
  return text + " }";
}

std::string inline_text(const SceneValue& value) {
  return std::visit(
      Overloaded{
          [](bool flag) { return std::string(flag ? "true" : "false"); },
          [](std::int64_t number) { return std::to_string(number); },
          [](double number) { return real_text(number); },
          [](const std::string& text) { return toml_string(text); },
          [](const SceneValue::Array& array) { return array_text(array); },
          [](const SceneValue::Table& table) { return table_text(table); },
          [](const SceneValue::Numbers&) -> std::string {
            throw InputError("scene", "values that a file can hold", "an array that a program handed over");
          },
          [](const SceneValue::MeshHandle&) -> std::string {
            throw InputError("scene", "values that a file can hold", "a mesh that a program handed over");
          },
      },
      value.data);
}

/// The order in which people look for them; others follow.
constexpr std::array<std::string_view, 7> first_keys = {"title", "kind", "name", "body",
                                                        "mesh",  "law",  "where"};

/// Lines "key = value" of a table, its own tables inline.
std::string lines_of(SceneValue::Table table) {
  const auto rank = [](const SceneMember& member) {
    return std::ranges::find(first_keys, member.key) - first_keys.begin();
  };
  std::ranges::stable_sort(table, {}, rank);
  std::string text;
  for (const SceneMember& member : table)
    text += key_text(member.key) + " = " + inline_text(member.value) + '\n';
  return text;
}

}  // namespace

std::string toml_text(const SceneValue& scene) {
  SceneValue::Table plain, sections;
  for (const SceneMember& member : scene.table())
    (member.value.is_table() || is_list_of_tables(member.value) ? sections : plain).push_back(member);
  constexpr std::array<std::string_view, 4> first = {"simulation", "body", "contact", "fix"};
  std::ranges::stable_sort(sections, {}, [&first](const SceneMember& section) {
    return std::ranges::find(first, section.key) - first.begin();
  });
  std::string text = lines_of(std::move(plain));
  for (const SceneMember& section : sections) {
    const std::string key = key_text(section.key);
    if (section.value.is_table()) {
      text += "\n[" + key + "]\n" + lines_of(section.value.table());
      continue;
    }
    for (const SceneValue& entry : section.value.array())
      text += "\n[[" + key + "]]\n" + lines_of(entry.table());
  }
  return text;
}

}  // namespace resilin
