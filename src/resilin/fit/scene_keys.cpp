#include "resilin/fit/scene_keys.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

FoundKey find_key(const World& world, const SceneParameter& sought) {
  const std::string& key = sought.key;
  const std::string ends = "xyz";
  const bool has_component = key.size() > 2 && key[key.size() - 2] == '.' &&
                             ends.find(key.back()) < static_cast<std::size_t>(world.dimension);
  try {
    FoundKey found{find_parameter(world, has_component ? key.substr(0, key.size() - 2) : key), {}};
    if (has_component) found.component = static_cast<Eigen::Index>(ends.find(key.back()));
    return found;
  } catch (const InputError&) {
    const std::vector<std::string> names = parameter_names(world);
    if (std::ranges::find(names, key) != names.end()) throw;  // there it is, and why it is none
    const std::string near = nearest_word(key, names);
    throw InputError(sought.place + ".key", "a parameter of " + world.place, '"' + one_line(key) + '"',
                     near.empty() ? "there are " + join(names) : "did you mean \"" + near + "\"?");
  }
}

bool is_of_cells(const Parameter& parameter) {
  return parameter.shape.size() == 1 && parameter.name.find(".material.") != std::string::npos;
}

std::string body_of_key(const std::string& key) {
  const std::size_t begin = std::string("body.").size();
  return key.substr(begin, std::min(key.find(".region."), key.find(".material.")) - begin);
}

void require_one_material(const World& world, const SceneParameter& sought) {
  const std::string name = body_of_key(sought.key);
  for (const BodyDescription& body : world.made_from->bodies)
    if (body.name == name && !body.regions.empty())
      throw InputError(sought.place + ".key", "one number of a body with regions",
                       '"' + one_line(sought.key) + "\" for each cell",
                       "give the cells regions of their own and seek a number of each: "
                       "body.NAME.region.REGION.material.CONSTANT");
}

KindOfNumber kind_of(const World& world, const std::string& key) {
  const std::string constant = key.substr(key.rfind('.') + 1);
  if (key.find(".material.") != std::string::npos) {
    if (constant == "youngs_modulus") return {.lower = 0, .is_above_lower = true, .unit = "Pa"};
    if (constant == "poissons_ratio") return {.lower = -0.999, .upper = 0.4999};
    if (constant == "density") return {.lower = 0, .is_above_lower = true, .unit = "kg/m^3"};
    for (const Body& body : world.bodies)
      for (const Domain& domain : body.domains) {
        const std::string region = domain.region < 0 ? "" : ".region." + domain.name;
        if (!key.starts_with("body." + body.name + region + ".material.")) continue;
        for (const ConstantText& text : domain.law_info().constants)
          if (key.ends_with(std::string(".material.").append(text.name)))
            return {.lower = std::max(text.above, text.at_least),
                    .upper = text.at_most,
                    .is_above_lower = text.above >= text.at_least,
                    .unit = std::string(text.unit)};
      }
  }
  if (key.starts_with("body.") && key.ends_with(".density"))
    return {.lower = 0, .is_above_lower = true, .unit = "kg/m^3"};
  if (key.find(".damping.") != std::string::npos)
    return {.lower = 0, .unit = constant == "mass" ? "1/s" : constant == "stiffness" ? "s" : "Pa s"};
  if (key.ends_with(".stiffness")) return {.lower = 0, .unit = "N/m"};
  return {};
}

std::vector<double> different_values(const VectorX& values, std::size_t most) {
  std::vector<double> all;
  for (const double value : values) {
    if (std::ranges::find(all, value) != all.end()) continue;
    all.push_back(value);
    if (all.size() > most) break;
  }
  return all;
}

}  // namespace resilin
