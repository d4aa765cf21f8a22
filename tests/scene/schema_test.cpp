#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "resilin/scene/scene.hpp"
#include "resilin/scene/tables.hpp"
#include "resilin/scene/value.hpp"
#include "shared_data.hpp"

namespace resilin::testing {
namespace {

using Json = nlohmann::json;

const Json& schema() {
  static const Json parsed = Json::parse(scene_schema());
  return parsed;
}

bool is_of_type(const SceneValue& value, const std::string& type) {
  if (type == "object") return value.is_table();
  if (type == "array") return value.is_array();
  if (type == "string") return std::holds_alternative<std::string>(value.data);
  if (type == "boolean") return std::holds_alternative<bool>(value.data);
  if (type == "integer") return std::holds_alternative<std::int64_t>(value.data);
  return std::holds_alternative<std::int64_t>(value.data) || std::holds_alternative<double>(value.data);
}

double number_of(const SceneValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
  const auto* number = std::get_if<double>(&value.data);
  return number == nullptr ? std::nan("") : *number;
}

/// The words of JSON schema that ours has; "" when the value is valid, else where it is not.
std::string fault(const SceneValue& value, const Json& rule, const std::string& place) {
  if (rule.contains("$ref")) {
    const auto name = rule["$ref"].get<std::string>();
    return fault(value, schema().at(Json::json_pointer(name.substr(1))), place);
  }
  if (rule.contains("anyOf")) {
    for (const Json& one : rule["anyOf"])
      if (fault(value, one, place).empty()) return "";
    return place + ": none of " + rule["anyOf"].dump();
  }
  if (rule.contains("type") && !is_of_type(value, rule["type"])) return place + ": no " + rule["type"].dump();
  if (rule.contains("enum")) {
    for (const Json& one : rule["enum"]) {
      const auto* text = std::get_if<std::string>(&value.data);
      if (one.is_string() ? text != nullptr && *text == one : number_of(value) == one.get<double>())
        return "";
    }
    return place + ": none of " + rule["enum"].dump();
  }
  if (rule.contains("minimum") && !(number_of(value) >= rule["minimum"])) return place + ": too small";
  if (rule.contains("exclusiveMinimum") && !(number_of(value) > rule["exclusiveMinimum"]))
    return place + ": too small";
  if (value.is_array() && rule.contains("items"))
    for (std::size_t i = 0; i < value.array().size(); ++i) {
      const std::string problem =
          fault(value.array()[i], rule["items"], place + "[" + std::to_string(i) + "]");
      if (!problem.empty()) return problem;
    }
  if (!value.is_table() || !rule.contains("properties")) return "";
  for (const auto& [key, child] : value.table()) {
    if (!rule["properties"].contains(key)) return place + "." + key + ": unknown";
    const std::string problem = fault(child, rule["properties"][key], place + "." + key);
    if (!problem.empty()) return problem;
  }
  if (rule.contains("required"))
    for (const Json& key : rule["required"])
      if (value.find(key.get<std::string>()) == nullptr) return place + ": " + key.dump() + " is missing";
  return "";
}

std::string fault_of(const std::string& toml) { return fault(parse_toml(toml, "scene"), schema(), "scene"); }

TEST(SceneSchema, TakesEveryExample) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "examples")) {
    if (entry.path().extension() != ".toml" || entry.path().stem().string().starts_with("fit_")) continue;
    std::ifstream file(entry.path());
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(fault_of(text), "") << entry.path();
    ++count;
  }
  EXPECT_GT(count, 20);
}

TEST(SceneSchema, RefusesWhatTheReaderRefuses) {
  const std::string good =
      "[simulation]\nkind = \"static\"\n[[body]]\nmesh = { box = { size = [1, 1, 1], cells = [2, 2, 2] } }\n";
  EXPECT_EQ(fault_of(good), "");
  EXPECT_THAT(fault_of("[simulation]\nkynd = 1\n[[body]]\nmesh = \"a.msh\"\n"), ::testing::HasSubstr("kynd"));
  EXPECT_THAT(fault_of(good + "scale = -1\n"), ::testing::HasSubstr("scale"));
  EXPECT_THAT(fault_of(good + "element = \"P7\"\n"), ::testing::HasSubstr("element"));
  EXPECT_THAT(fault_of(good + "material = { law = \"rubber\" }\n"), ::testing::HasSubstr("law"));
  EXPECT_THAT(fault_of("[simulation]\n"), ::testing::HasSubstr("body"));
  EXPECT_EQ(fault_of(good + "material = { youngs_modulus = { file = \"young.csv\" } }\n"), "");
}

TEST(SceneSchema, HasEveryKeyWithItsMeaning) {
  const std::string text = scene_schema();
  for (const TableDoc& table : scene_tables())
    for (const KeyDoc& key : table.keys) {
      const std::string meaning = Json(key.text).dump();  // between quotes
      const std::string last = key.name.substr(key.name.find_last_of('.') + 1);
      EXPECT_THAT(text, ::testing::HasSubstr("\"" + last + "\": {")) << table.title;
      EXPECT_THAT(text, ::testing::HasSubstr(meaning.substr(1, meaning.size() - 2)))
          << table.title << key.name;
    }
}

}  // namespace
}  // namespace resilin::testing
