#pragma once

#include <map>
#include <string>
#include <vector>

#include "resilin/material/derive.hpp"
#include "shared_data.hpp"

namespace resilin::testing {

/// Name of a law in material_points_*.json and closed_forms.json, and the names there of our constants.
struct FileLaw {
  std::string name;
  std::vector<std::string> parameters;
};

inline const std::map<std::string, FileLaw>& file_laws() {
  static const std::map<std::string, FileLaw> laws = {
      {"nh_log", {"neo_hookean", {"mu", "lam"}}},
      {"nh_j1_log", {"neo_hookean_quadratic", {"mu", "lam"}}},
      {"snh", {"stable_neo_hookean", {"mu", "lam"}}},
      {"snh_log", {"stable_neo_hookean_log", {"mu", "lam"}}},
      {"nh_iso_j1", {"neo_hookean_isochoric", {"mu", "kappa"}}},
      {"nh_iso_simo", {"neo_hookean_simo", {"mu", "kappa"}}},
      {"stvk", {"saint_venant_kirchhoff", {"mu", "lam"}}},
      {"linear", {"linear_elastic", {"mu", "lam"}}},
      {"corot_linear", {"corotated_linear", {"mu", "lam"}}},
      {"corot_fixed", {"corotated", {"mu", "lam"}}},
      {"mooney_rivlin", {"mooney_rivlin", {"c10", "c01", "kappa"}}},
      {"yeoh", {"yeoh", {"c10", "c20", "c30", "kappa"}}},
      {"ogden", {"ogden", {"mu/0", "alpha/0", "mu/1", "alpha/1", "mu/2", "alpha/2", "kappa"}}},
      {"arruda_boyce", {"arruda_boyce", {"mu", "N", "kappa"}}},
      {"hgo", {"holzapfel_gasser_ogden", {"mu", "kappa", "k1", "k2", "kd"}}}};
  return laws;
}

/// A law with the constants of the file.
inline Material file_material(const nlohmann::json& file, const std::string& key) {
  const nlohmann::json& parameters = file["laws"][key]["parameters"];
  Material material{find_law(file_laws().at(key).name), {}, {}};
  for (const std::string& parameter : file_laws().at(key).parameters)
    material.constants.push_back(parameters.at(nlohmann::json::json_pointer("/" + parameter)));
  for (const char* fibre : {"a1", "a2"})
    if (parameters.contains(fibre)) {
      const std::vector<double> a = parameters[fibre];
      material.fibres.emplace_back(a[0], a[1], a[2]);
    }
  return material;
}

}  // namespace resilin::testing
