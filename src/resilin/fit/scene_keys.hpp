#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "resilin/fit/scene_experiment.hpp"
#include "resilin/sensitivity/parameter.hpp"

/// Meaning of the keys of a fit in a scene.
namespace resilin {

/// Meaning of a key in a scene: a parameter and the component of a vector.
struct FoundKey {
  Parameter parameter;
  std::optional<Eigen::Index> component;
};

/// Throws InputError, with the nearest key of the scene, for one that is none.
FoundKey find_key(const World& world, const SceneParameter& sought);

/// A constant that the scene has for each cell.
bool is_of_cells(const Parameter& parameter);

/// The name of the body whose material a key means.
std::string body_of_key(const std::string& key);

/// Throws InputError where a number for each cell is sought of a body with regions.
void require_one_material(const World& world, const SceneParameter& sought);

/// Limits and unit of a parameter, by its key.
struct KindOfNumber {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  bool is_above_lower = false;
  std::string unit{};
};
KindOfNumber kind_of(const World& world, const std::string& key);

/// The different values, in the order of the cells; one more than `most` where there are more.
std::vector<double> different_values(const VectorX& values, std::size_t most);

}  // namespace resilin
