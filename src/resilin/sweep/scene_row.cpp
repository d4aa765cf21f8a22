#include "resilin/sweep/scene_row.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/sweep/value_json.hpp"

namespace resilin {
namespace {

constexpr std::string_view head = "{\"hash\":\"", middle = "\",\"status\":\"";

nlohmann::ordered_json number_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::string row_line(const SceneRow& row, const Sweep& sweep) {
  nlohmann::ordered_json json;
  json["hash"] = row.hash.text();
  json["status"] = spelling(row.status);
  json["scene"] = row.scene;
  json["reason"] = one_line(row.reason);
  json["parameters"] = nlohmann::ordered_json::object();
  const std::vector<SceneValue> values = sweep.values(row.scene);
  for (std::size_t p = 0; p < values.size(); ++p)
    json["parameters"][sweep.parameters()[p].name] = value_json(values[p]);
  json["quantities"] = nlohmann::ordered_json::object();
  for (std::size_t q = 0; q < row.quantities.size(); ++q) {
    nlohmann::ordered_json& entry = json["quantities"][sweep.quantities()[q].name];
    if (sweep.quantities()[q].over != OverSteps::all) {
      entry = number_json(row.quantities[q].front());
      continue;
    }
    entry = nlohmann::ordered_json::array();
    for (const double value : row.quantities[q]) entry.push_back(number_json(value));
  }
  json["steps"] = row.steps;
  json["newton_iterations"] = row.newton_iterations;
  json["unknowns"] = row.unknowns;
  json["seconds"] = row.seconds;
  json["kept"] = row.is_kept;
  json["version"] = version();
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

bool read_row_head(std::string_view line, SceneHash& hash, SceneStatus& status) {
  if (!line.starts_with(head) || !line.ends_with('}')) return false;
  line.remove_prefix(head.size());
  const std::optional<SceneHash> found = SceneHash::from_text(line.substr(0, 32));
  if (!found || !line.substr(32).starts_with(middle)) return false;
  line.remove_prefix(32 + middle.size());
  const std::optional<SceneStatus> word = find_spelled<SceneStatus>(line.substr(0, line.find('"')));
  if (!word) return false;
  hash = *found;
  status = *word;
  return true;
}

SceneRow failed_row(const Sweep& sweep, std::uint64_t scene, SceneStatus status, const std::string& reason) {
  SceneRow row;
  row.hash = sweep.hash(scene);
  row.scene = scene;
  row.status = status;
  row.reason = reason;
  return row;
}

}  // namespace resilin
