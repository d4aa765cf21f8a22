#include "resilin/world/plausibility.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "resilin/mesh/edit.hpp"

namespace resilin {
namespace {

constexpr double crushing_strain = 0.5;  ///< rho g L / E beyond which a body folds under its weight
constexpr double many_periods =
    10;  ///< number of periods of the slowest wave through the body, in one time step
constexpr double odd_size = 1e3;  ///< [m]: longer or (inverse) shorter bodies are rarely meant

/// Two digits, in any locale.
std::string rounded(double value) {
  std::array<char, 32> buffer{};
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 2);
  return {buffer.data(), end.ptr};
}

std::optional<double> find(const MaterialDescription& material, const std::string& constant) {
  const auto found = material.constants.find(constant);
  return found == material.constants.end() ? std::nullopt : std::optional(found->second);
}

/// About Young's modulus, where it can be told from the constants given.
std::optional<double> stiffness(const MaterialDescription& material) {
  if (const auto youngs_modulus = find(material, "youngs_modulus")) return youngs_modulus;
  if (const auto shear_modulus = find(material, "shear_modulus")) return 3 * *shear_modulus;
  return std::nullopt;
}

}  // namespace

std::vector<std::string> implausible_numbers(const Description& description) {
  std::vector<std::string> oddities;
  for (const BodyDescription& body : description.bodies) {
    const BoundingBox box = bounding_box(body.mesh);
    const double length = body.scale * (box.max - box.min).maxCoeff();
    if (length > odd_size || length < 1 / odd_size) {
      oddities.push_back(body.place + ": the body is " + rounded(length) +
                         " m long; is the mesh in other units? (scale)");
    }
    if (!body.regions.empty() || body.rigid) continue;  // no one number tells of several materials
    const auto modulus = stiffness(body.material);
    if (!modulus || *modulus <= 0 || body.material.density <= 0) continue;
    const double weight_strain = body.material.density * description.gravity.norm() * length / *modulus;
    if (weight_strain > crushing_strain) {
      oddities.push_back(body.material.place + ": its own weight strains the body by about " +
                         rounded(weight_strain) + "; is youngs_modulus in Pa and density in kg/m^3?");
    }
    const double wave_time = length / std::sqrt(*modulus / body.material.density);
    if (description.is_dynamic && description.time_step > many_periods * wave_time) {
      oddities.push_back(description.place + ": simulation.time_step: a wave crosses \"" + body.name +
                         "\" in " + rounded(wave_time) +
                         " s, far below the time step: its vibrations are numerically damped");
    }
  }
  return oddities;
}

}  // namespace resilin
