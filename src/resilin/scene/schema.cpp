#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "resilin/scene/scene.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

using Json = nlohmann::ordered_json;

Json number_list() { return {{"type", "array"}, {"items", {{"type", "number"}}}}; }

Json reference(const std::string& name) { return {{"$ref", "#/$defs/" + name}}; }

/// "[collider.rotate](#colliderrotate)" -> "colliderrotate"
std::optional<std::string> anchor_of(const std::string& type) {
  const std::size_t begin = type.find("](#");
  if (begin == type.npos) return std::nullopt;
  const std::size_t end = type.find(')', begin);
  return type.substr(begin + 3, end - begin - 3);
}

/// The heading of a table as a name of its definition: "[[contact.pair]]" -> "contact.pair".
std::string plain_title(const std::string& title) {
  std::string name = title;
  std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
  return name;
}

/// As links to headings are written: without points.
std::string anchor_name(const std::string& title) {
  std::string name = plain_title(title);
  std::erase(name, '.');
  return name;
}

/// All words between quotes.
Json quoted_words(const std::string& type) {
  Json words = Json::array();
  for (std::size_t at = type.find('"'); at != type.npos;) {
    const std::size_t end = type.find('"', at + 1);
    words.push_back(type.substr(at + 1, end - at - 1));
    at = type.find('"', end + 1);
  }
  return words;
}

/// The bounds that stand behind "number": "> 0", ">= 1", "> -1 and < 0.5", "above 0", "not below 0", "from 0
/// to 1".
void add_bounds(const std::string& type, Json& schema) {
  const auto number_behind = [&type](const std::string& words) -> std::optional<double> {
    const std::size_t at = type.find(words);
    if (at == type.npos) return std::nullopt;
    return std::stod(type.substr(at + words.size()));
  };
  const auto add = [&](const char* words, const char* key) {
    if (const std::optional<double> bound = number_behind(words)) schema[key] = *bound;
  };
  add(" >= ", "minimum");
  add(" > ", "exclusiveMinimum");
  add(" < ", "exclusiveMaximum");
  add(" above ", "exclusiveMinimum");
  add(" not below ", "minimum");
  add(" from ", "minimum");
  add(" to ", "maximum");
}

Json of_number(const std::string& type, const char* name) {
  Json schema = {{"type", name}};
  add_bounds(type, schema);
  return schema;
}

/// Schema of a type of the reference. One that is not known here allows anything, so that no scene is called
/// wrong which the program takes.
Json of_type(const std::string& type) {
  const auto begins = [&type](const char* words) { return type.starts_with(words); };
  if (type == "true or false") return {{"type", "boolean"}};
  if (type == "true") return {{"const", true}};
  if (type == "2, 3, \"plane_stress\" or \"axisymmetric\"")
    return {{"enum", {2, 3, "plane_stress", "axisymmetric"}}};
  if (begins("[[")) return {{"type", "array"}, {"items", reference(plain_title(type))}};
  const std::optional<std::string> anchor = anchor_of(type);
  if (anchor && begins("text or ")) return {{"anyOf", {{{"type", "string"}}, reference(*anchor)}}};
  if (anchor && begins("true")) return {{"anyOf", {{{"type", "boolean"}}, reference(*anchor)}}};
  if (anchor) return reference(*anchor);
  if (begins("list of \"")) return {{"type", "array"}, {"items", {{"enum", quoted_words(type)}}}};
  if (begins("list of names") || type.ends_with("texts"))
    return {{"type", "array"}, {"items", {{"type", "string"}}}};
  if (begins("list of whole numbers")) return {{"type", "array"}, {"items", {{"type", "integer"}}}};
  if (begins("\"")) return {{"enum", quoted_words(type)}};
  if (begins("number")) return of_number(type, "number");
  if (begins("whole number")) return of_number(type, "integer");
  if (begins("vector; number for ")) return {{"anyOf", {number_list(), {{"type", "number"}}}}};
  if (begins("vector")) return number_list();
  if (type == "matrix") return {{"type", "array"}, {"items", number_list()}};
  if (begins("text or ")) return {{"anyOf", {{{"type", "string"}}, {{"type", "array"}}}}};
  if (type == "text" || begins("letters of")) return {{"type", "string"}};
  if (begins("{") || type == "table") return {{"type", "object"}};
  if (type == "[min, max]") return {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}};
  return Json::object();
}

/// A constant of a material may vary from cell to cell.
Json of_constant(const Json& number) {
  return {{"anyOf", {number, {{"type", "array"}}, {{"type", "object"}}}}};
}

std::string description_of(const KeyDoc& key) {
  std::string text = key.text;
  if (!key.unit.empty()) text += " [" + key.unit + "]";
  if (!key.default_text.empty() && key.default_text != "required")
    text += " Default: " + key.default_text + ".";
  return text;
}

/// Keys with a point stand in the table of the part before it.
Json of_table(const TableDoc& table) {
  Json schema = {{"type", "object"}, {"description", table.text}, {"additionalProperties", false}};
  schema["properties"] = Json::object();
  for (const KeyDoc& key : table.keys) {
    Json value = of_type(key.type);
    if (table.title == "material" && key.type.starts_with("number") && key.name != "density")
      value = of_constant(value);
    value["description"] = description_of(key);
    Json* owner = &schema;
    std::string name = key.name;
    if (const std::size_t point = name.find('.'); point != name.npos) {
      owner = &schema["properties"][name.substr(0, point)];
      (*owner)["additionalProperties"] = false;
      name = name.substr(point + 1);
    }
    (*owner)["properties"][name] = std::move(value);
    if (key.default_text == "required") (*owner)["required"].push_back(name);
  }
  return schema;
}

/// Adds the short form that may stand in place of a table, which the table's text tells of.
Json with_short_form(const std::string& name, Json table) {
  if (name == "rotate") return {{"anyOf", {std::move(table), number_list()}}};
  if (name == "where" || name == "time_function" || name == "mesh")
    return {{"anyOf", {std::move(table), {{"type", "string"}}, {{"type", "number"}}}}};
  return table;
}

}  // namespace

std::string scene_schema() {
  Json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "A scene of Resilin"},
      {"type", "object"},
      {"additionalProperties", false},
      {"properties", {{"title", {{"type", "string"}, {"description", "Shown with the results."}}}}},
      {"required", {"body"}},
      {"$defs", Json::object()}};
  for (const TableDoc& table : scene_tables()) {
    if (table.keys.empty()) continue;
    const std::string name = plain_title(table.title);
    const bool is_at_the_top = table.title.starts_with('[') && name.find('.') == name.npos;
    if (!is_at_the_top) {
      schema["$defs"][table.title.starts_with('[') ? name : anchor_name(table.title)] =
          with_short_form(name, of_table(table));
    } else if (table.title.starts_with("[[")) {
      schema["properties"][name] = {{"type", "array"}, {"items", of_table(table)}};
    } else {
      schema["properties"][name] = of_table(table);
    }
  }
  return schema.dump(1) + "\n";
}

}  // namespace resilin
