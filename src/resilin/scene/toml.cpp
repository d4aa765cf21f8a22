#include <toml++/toml.h>

#include <regex>
#include <string>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/toml_depth.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {
namespace {

using Source = std::shared_ptr<const std::string>;

[[noreturn]] void refuse_type(const toml::node& node, const Source& source) {
  throw InputError(*source + ":" + std::to_string(node.source().begin.line),
                   "a number, a text, true or false, a list or a table", "a date or a time");
}

SceneValue convert(const toml::node& node, const Source& source) {
  SceneValue value;
  value.source = source;
  value.line = static_cast<int>(node.source().begin.line);
  switch (node.type()) {
    case toml::node_type::table: {
      SceneValue::Table table;
      for (const auto& [key, child] : *node.as_table()) {
        table.push_back({std::string(key.str()), convert(child, source)});
      }
      value.data = std::move(table);
      break;
    }
    case toml::node_type::array: {
      SceneValue::Array array;
      array.reserve(node.as_array()->size());
      for (const toml::node& child : *node.as_array()) array.push_back(convert(child, source));
      value.data = std::move(array);
      break;
    }
    case toml::node_type::boolean:
      value.data = node.as_boolean()->get();
      break;
    case toml::node_type::integer:
      value.data = node.as_integer()->get();
      break;
    case toml::node_type::floating_point:
      value.data = node.as_floating_point()->get();
      break;
    case toml::node_type::string:
      value.data = node.as_string()->get();
      break;
    default:
      refuse_type(node, source);
  }
  return value;
}

/// Whether the parser stopped at the comma of "= 1,5".
bool has_decimal_comma(std::string_view text, const toml::source_position& at) {
  for (std::uint32_t line = 1; line < at.line; ++line) {
    const std::size_t end = text.find('\n');
    if (end == text.npos) return false;
    text.remove_prefix(end + 1);
  }
  text = text.substr(0, text.find('\n'));
  // In an inline table it goes on to what it takes for the next key: "{ radius = 1,5, height = 2 }".
  static const std::regex number_of_table(R"(=\s*[-+]?[0-9]+,[0-9]+([eE][-+]?[0-9]+)?\s*[,}]?$)");
  const std::string_view before = text.substr(0, at.column);
  if (std::regex_search(before.begin(), before.end(), number_of_table)) return true;
  const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  const std::size_t comma = text.find(',', at.column >= 2 ? at.column - 2 : 0);
  return comma != text.npos && comma <= at.column && comma > 0 && is_digit(comma - 1) && is_digit(comma + 1);
}

}  // namespace

SceneValue parse_toml(std::string_view text, const std::string& name) {
  refuse_deep_toml(text, name);
  try {
    return convert(toml::parse(without_byte_order_mark(text, name), name),
                   std::make_shared<const std::string>(name));
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    const std::string cure = has_decimal_comma(text, at) ? "; write decimals with a point, not a comma" : "";
    throw InputError(name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column),
                     std::string(error.description()) + cure);
  }
}

}  // namespace resilin
