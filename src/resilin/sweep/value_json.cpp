#include "resilin/sweep/value_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"
#include "resilin/sweep/scene_hash.hpp"

namespace resilin {

nlohmann::ordered_json value_json(const SceneValue& value) {
  using Json = nlohmann::ordered_json;
  return std::visit(
      Overloaded{
          [](bool flag) { return Json(flag); }, [](std::int64_t number) { return Json(number); },
          [](double number) { return std::isfinite(number) ? Json(number) : Json(format_number(number)); },
          [](const std::string& text) { return Json(text); },
          [](const SceneValue::Array& array) {
            Json list = Json::array();
            for (const SceneValue& entry : array) list.push_back(value_json(entry));
            return list;
          },
          [](const SceneValue::Table& table) {
            Json object = Json::object();
            for (const SceneMember& member : table) object[member.key] = value_json(member.value);
            return object;
          },
          [&](const auto&) {
            FileHashes no_files{""};
            return Json(shown_value(value, no_files));
          }},
      value.data);
}

}  // namespace resilin
