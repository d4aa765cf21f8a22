#include "offered_words.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "resilin/io/catalog.hpp"
#include "resilin/material/curve.hpp"
#include "resilin/material/law.hpp"
#include "resilin/picture/camera.hpp"
#include "resilin/picture/color_map.hpp"
#include "resilin/scene/scene.hpp"

namespace resilin::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Goes through the schema of the scene; tables within tables as far as they are no lists of any length.
class SchemaWalk {
 public:
  explicit SchemaWalk(const Json& schema) : schema_(&schema) {}

  void visit(const Json& rule, const std::string& path, int depth) {
    constexpr int deepest = 4;  // tables name each other
    if (depth > deepest) return;
    if (rule.contains("$ref")) {
      const auto place = rule["$ref"].get<std::string>();
      visit(schema_->at(Json::json_pointer(place.substr(1))), path, depth + 1);
    } else if (rule.contains("anyOf")) {
      for (const Json& one : rule["anyOf"]) visit(one, path, depth);
    } else if (rule.contains("properties")) {
      for (const auto& [key, value] : rule["properties"].items())
        visit(value, path.empty() ? std::string(key) : std::string(path).append(".").append(key), depth);
    } else if (rule.value("type", "") == "array" && rule.contains("items") && is_table(rule["items"])) {
      visit(rule["items"], path + ".0", depth);
    } else {
      const std::string setting = path + "=";
      add(setting);
      if (rule.contains("enum"))
        for (const Json& word : rule["enum"])
          add(setting + (word.is_string() ? word.get<std::string>() : word.dump()));
    }
  }

  std::vector<std::string> words;

 private:
  static bool is_table(const Json& rule) { return rule.contains("properties") || rule.contains("$ref"); }

  void add(const std::string& word) {
    if (std::ranges::find(words, word) == words.end()) words.push_back(word);
  }

  const Json* schema_;
};

}  // namespace

std::vector<std::string> scene_settings() {
  const Json schema = Json::parse(scene_schema());
  SchemaWalk walk(schema);
  walk.visit(schema, "", 0);
  return std::move(walk.words);
}

std::vector<std::string> law_words() {
  std::vector<std::string> words;
  for (const LawInfo* law : laws()) words.emplace_back(law->name);
  return words;
}

std::vector<std::string> load_case_words() {
  std::vector<std::string> words;
  for (const LoadCase load_case :
       {LoadCase::uniaxial, LoadCase::equibiaxial, LoadCase::planar, LoadCase::shear, LoadCase::volumetric})
    words.emplace_back(name(load_case));
  return words;
}

std::vector<std::string> view_words() {
  std::vector<std::string> words = view_names();
  words.insert(words.begin(), "auto");
  return words;
}

std::vector<std::string> color_map_words() {
  std::vector<std::string> words = color_map_names();
  words.insert(words.begin(), "auto");
  return words;
}

std::vector<std::string> mesh_extensions() {
  std::vector<std::string> extensions;
  for (const MeshFormat& format : mesh_formats())
    extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
  return extensions;
}

std::vector<std::string> scene_and_mesh_extensions() {
  std::vector<std::string> extensions = {"toml"};
  std::ranges::copy(mesh_extensions(), std::back_inserter(extensions));
  return extensions;
}

}  // namespace resilin::cli
