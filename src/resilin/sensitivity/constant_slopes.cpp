#include "resilin/sensitivity/constant_slopes.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/simd.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
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

/// How far a number may go, for which the formula is smooth: 1/(1 - 2 nu) limits Poisson's ratio.
double step_of(const std::string& name, double value, double largest) {
  if (name == "poissons_ratio") return relative_step * std::min(0.5 - value, 1 + value);
  return relative_step * (value != 0 ? std::abs(value) : largest);
}

/// Evaluates the law for numbers that were checked before: the neighbours of one at the end of its range need
/// not lie in it.
Eigen::VectorXd converted(const LawInfo& law, const std::map<std::string, double>& given) {
  std::vector<double> constants;
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
  return Eigen::Map<const Eigen::VectorXd>(constants.data(), static_cast<Eigen::Index>(constants.size()));
}

}  // namespace

Eigen::MatrixXd constant_slopes(const LawInfo& law, const std::map<std::string, double>& given,
                                const std::string& place) {
  resolve_constants(law, given, place);  // throws for what is no material
  Eigen::MatrixXd slopes(law.constants.size(), given.size());
  double largest = 1;
  for (const auto& [name, value] : given) largest = std::max(largest, std::abs(value));
  Eigen::Index column = 0;
  for (const auto& [name, value] : given) {
    std::map<std::string, double> changed = given;
    slopes.col(column++) = slope(value, step_of(name, value, largest), [&, n = name](double x) {
      changed[n] = x;
      return converted(law, changed);
    });
  }
  return slopes;
}

Eigen::Matrix2Xd rest_stiffness_slopes(const Material& material) {
  Eigen::Matrix2Xd slopes(2, material.constants.size());
  double largest = 0;
  for (const double constant : material.constants) largest = std::max(largest, std::abs(constant));
  for (std::size_t p = 0; p < material.constants.size(); ++p) {
    Material changed = material;
    slopes.col(static_cast<Eigen::Index>(p)) =
        slope(material.constants[p], step_of("", material.constants[p], largest), [&](double x) {
          changed.constants[p] = x;
          const Viscosity rest = rest_stiffness(changed);
          return Eigen::VectorXd(Eigen::Vector2d(rest.eta, rest.zeta));
        });
  }
  return slopes;
}

VolumeEnergySlopes volume_energy(const Material& material, double j) {
  const std::vector<double> variables(block_size, j);
  std::vector<double> constants, results(3 * block_size);
  for (const double constant : material.constants) constants.insert(constants.end(), block_size, constant);
  law_kernels(material.law->index, preferred_instruction_set())
      .volume({1, variables.data(), constants.data(), 0, results.data()});
  return {results[block_size], results[2 * block_size]};
}

double pressure_slope(const Material& material, double j, std::size_t constant) {
  Material changed = material;
  double largest = 0;
  for (const double number : material.constants) largest = std::max(largest, std::abs(number));
  return slope(material.constants[constant], step_of("", material.constants[constant], largest),
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
  double largest = 0;
  for (const double constant : constants) largest = std::max(largest, std::abs(constant));
  VectorX slopes(static_cast<Eigen::Index>(constants.size()));
  for (std::size_t p = 0; p < constants.size(); ++p) {
    std::vector<double> changed = constants;
    slopes.segment<1>(static_cast<Eigen::Index>(p)) =
        slope(constants[p], step_of("", constants[p], largest), [&](double x) {
          changed[p] = x;
          return Eigen::VectorXd(Eigen::VectorXd::Constant(1, youngs_modulus(law, changed) / modulus));
        });
  }
  return slopes;
}

}  // namespace resilin
