#include "resilin/sensitivity/constant_slopes.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "resilin/material/law_sum.hpp"
#include "resilin/material/volume_energy.hpp"
#include "resilin/world/damping.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

/// f'(x) from f(x - 3h) .. f(x + 3h): exact for polynomials of degree 6.
template <class Function>
Eigen::VectorXd slope(double x, double h, const Function& f) {
  constexpr double weights[] = {45.0 / 60, -9.0 / 60, 1.0 / 60};
  Eigen::VectorXd sum = weights[0] * (f(x + h) - f(x - h));
  for (int k = 2; k <= 3; ++k) sum += weights[k - 1] * (f(x + k * h) - f(x - k * h));
  return sum / h;
}

constexpr double relative_step = 2e-3;

/// A step over which a smooth function of a number hardly bends. A zero takes that of a number of size
/// `usual`.
double step_of(double value, double usual) { return relative_step * (value != 0 ? std::abs(value) : usual); }

/// Young's modulus, and constants of the formula that have a unit.
bool has_unit(const LawInfo& law, const std::string& name) {
  const auto found = std::ranges::find(law.constants, name, &ConstantText::name);
  return found != law.constants.end() ? !found->unit.empty() : name.ends_with("youngs_modulus");
}

/// For a constant of the formula: a modulus of zero takes the step of the largest one.
double step_of(const LawInfo& law, std::span<const double> constants, std::size_t p) {
  double largest = 0;
  for (std::size_t k = 0; k < constants.size(); ++k)
    if (!law.constants[k].unit.empty()) largest = std::max(largest, std::abs(constants[k]));
  return step_of(constants[p], law.constants[p].unit.empty() ? 1 : largest);
}

/// Evaluates the law for numbers that were checked before: the neighbours of one at the end of its range need
/// not lie in it.
std::vector<double> converted_numbers(const LawInfo& law, const std::map<std::string, double>& given) {
  std::vector<double> constants;
  if (is_sum(law)) {
    for (std::size_t k = 0; k < law.parts.size(); ++k) {
      const std::string prefix = sum_constant(k, "");
      std::map<std::string, double> of_part;
      for (const auto& [name, value] : given)
        if (name.starts_with(prefix)) of_part[name.substr(prefix.size())] = value;
      const std::vector<double> own = converted_numbers(*law.parts[k], of_part);
      constants.insert(constants.end(), own.begin(), own.end());
    }
    return constants;
  }
  if (!given.contains("youngs_modulus")) {
    for (const ConstantText& constant : law.constants) {
      const auto found = given.find(std::string(constant.name));
      constants.push_back(found == given.end() ? constant.fallback : found->second);
    }
  } else {
    std::vector<double> free;
    for (const ConstantText& constant : law.constants) {
      if (!constant.is_free) continue;
      const auto found = given.find(std::string(constant.name));
      free.push_back(found == given.end() ? constant.fallback : found->second);
    }
    constants =
        law.convert(hooke_from_young_poisson(given.at("youngs_modulus"), given.at("poissons_ratio")), free);
  }
  return constants;
}

Eigen::VectorXd converted(const LawInfo& law, const std::map<std::string, double>& given) {
  const std::vector<double> constants = converted_numbers(law, given);
  return Eigen::Map<const Eigen::VectorXd>(constants.data(), static_cast<Eigen::Index>(constants.size()));
}

}  // namespace

Eigen::MatrixXd constant_slopes(const LawInfo& law, const std::map<std::string, double>& given,
                                const std::string& place) {
  resolve_constants(law, given, place);  // throws for what is no material
  Eigen::MatrixXd slopes(law.constants.size(), given.size());
  double largest = 1;
  for (const auto& [name, value] : given)
    if (has_unit(law, name)) largest = std::max(largest, std::abs(value));
  // The formula has 1/(1 - 2 nu).
  const auto step = [&](const std::string& name, double value) {
    return name == "poissons_ratio" || name.ends_with(".poissons_ratio")
               ? relative_step * std::min(0.5 - value, 1 + value)
               : step_of(value, has_unit(law, name) ? largest : 1);
  };
  Eigen::Index column = 0;
  for (const auto& [name, value] : given) {
    std::map<std::string, double> changed = given;
    slopes.col(column++) = slope(value, step(name, value), [&, n = name](double x) {
      changed[n] = x;
      return converted(law, changed);
    });
  }
  return slopes;
}

Eigen::Matrix2Xd rest_stiffness_slopes(const Material& material) {
  Eigen::Matrix2Xd slopes(2, material.constants.size());
  for (std::size_t p = 0; p < material.constants.size(); ++p) {
    Material changed = material;
    slopes.col(static_cast<Eigen::Index>(p)) =
        slope(material.constants[p], step_of(*material.law, material.constants, p), [&](double x) {
          changed.constants[p] = x;
          const Viscosity rest = rest_stiffness(changed);
          return Eigen::VectorXd(Eigen::Vector2d(rest.eta, rest.zeta));
        });
  }
  return slopes;
}

VolumeEnergySlopes volume_energy(const Material& material, double j) {
  std::vector<Column> constants;
  for (const double& constant : material.constants) constants.push_back({&constant, 0});
  const VolumeSlopes slopes =
      volume_slopes(*material.law, std::span(&j, 1), constants, preferred_instruction_set()).front();
  return {slopes.pressure, slopes.stiffness};
}

double pressure_slope(const Material& material, double j, std::size_t constant) {
  Material changed = material;
  return slope(material.constants[constant], step_of(*material.law, material.constants, constant),
               [&](double x) {
                 changed.constants[constant] = x;
                 return Eigen::VectorXd(Eigen::VectorXd::Constant(1, volume_energy(changed, j).first));
               })[0];
}

VectorX log_modulus_slopes(const Domain& domain) {
  const LawInfo& law = domain.law_info();
  std::vector<double> constants;
  for (const auto& [name, value] : domain.constants) constants.push_back(value);
  const double modulus = youngs_modulus(domain);
  VectorX slopes(static_cast<Eigen::Index>(constants.size()));
  for (std::size_t p = 0; p < constants.size(); ++p) {
    std::vector<double> changed = constants;
    slopes.segment<1>(static_cast<Eigen::Index>(p)) =
        slope(constants[p], step_of(law, constants, p), [&](double x) {
          changed[p] = x;
          return Eigen::VectorXd(Eigen::VectorXd::Constant(1, youngs_modulus(law, changed) / modulus));
        });
  }
  return slopes;
}

}  // namespace resilin
