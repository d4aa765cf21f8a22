#include "resilin/scene/value.hpp"

#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin {

const SceneValue* SceneValue::find(std::string_view key) const {
  if (!is_table()) return nullptr;
  for (const SceneMember& member : table()) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

SceneValue* SceneValue::find(std::string_view key) {
  return const_cast<SceneValue*>(std::as_const(*this).find(key));
}

std::string source_and_line(const SceneValue& value) {
  const std::string source = value.source ? *value.source : "scene";
  return value.line > 0 ? source + ":" + std::to_string(value.line) : source;
}

namespace {

struct Describe {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return format_number(value); }
  std::string operator()(const std::string& value) const { return '"' + printable(value) + '"'; }
  std::string operator()(const SceneValue::Array& value) const {
    return value.empty() ? "an empty list" : "a list of " + std::to_string(value.size());
  }
  std::string operator()(const SceneValue::Table& value) const {
    return value.empty() ? "an empty table" : "a table";
  }
  std::string operator()(const SceneValue::Numbers& value) const {
    return "an array of " + std::to_string(value->num_rows()) + " x " + std::to_string(value->num_columns);
  }
  std::string operator()(const SceneValue::MeshHandle&) const { return "a mesh"; }
};

}  // namespace

std::string describe(const SceneValue& value) { return std::visit(Describe{}, value.data); }

}  // namespace resilin
