#include "validation_laws.hpp"

#include <cmath>
#include <stdexcept>

namespace resilin::testing {

ReferenceLaw reference_law(const std::string& key, double mu, double lambda) {
  const double kappa = lambda + 2 * mu / 3;
  const std::map<std::string, double> lame = {{"shear_modulus", mu}, {"lame_lambda", lambda}};
  const std::map<std::string, double> bulk = {{"shear_modulus", mu}, {"bulk_modulus", kappa}};
  if (key == "nh_log" || key == "log") return {"neo_hookean", lame};
  if (key == "nh_j1_log") return {"neo_hookean_quadratic", lame};
  if (key == "snh") return {"stable_neo_hookean", lame, mu * mu / (2 * lambda)};
  if (key == "snh_log") {
    const double alpha_minus_1 = mu / lambda - mu / (4 * lambda);
    return {"stable_neo_hookean_log", lame,
            0.5 * lambda * alpha_minus_1 * alpha_minus_1 - 0.5 * mu * std::log(4.0)};
  }
  if (key == "nh_iso_j1") return {"neo_hookean_isochoric", bulk};
  if (key == "nh_iso_simo") return {"neo_hookean_simo", bulk};
  if (key == "stvk") return {"saint_venant_kirchhoff", lame};
  if (key == "linear") return {"linear_elastic", lame};
  throw std::invalid_argument("no law of this version stands for " + key);
}

ReferenceLaw reference_law_from_young(const std::string& key, double youngs_modulus, double nu) {
  return reference_law(key, youngs_modulus / (2 * (1 + nu)), youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu)));
}

}  // namespace resilin::testing
