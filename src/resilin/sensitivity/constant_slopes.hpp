#pragma once

#include <map>
#include <string>

#include "resilin/material/derive.hpp"
#include "resilin/world/world.hpp"

/// Derivatives of the small formulas between the constants that a user gives and those that kernels have. A
/// law states them for numbers alone (`from`); they are smooth functions of at most a handful of numbers, and
/// a difference over seven values has all digits but two or three.
namespace resilin {

/// d(constants of the law's formula)/d(what was given): one row for each constant, one column for each name
/// of `given`, in the order of the map. `given` as for `resolve_constants`.
Eigen::MatrixXd constant_slopes(const LawInfo& law, const std::map<std::string, double>& given,
                                const std::string& place);

/// d(eta, zeta)/d(constants) of `rest_stiffness`.
Eigen::Matrix2Xd rest_stiffness_slopes(const Material& material);

/// First and second derivative by j = J - 1 of the volume energy of a law where it stands apart [Pa].
struct VolumeEnergySlopes {
  double first, second;
};
VolumeEnergySlopes volume_energy(const Material& material, double j);

/// d/dc of its first derivative, c being the constant of this place.
double pressure_slope(const Material& material, double j, std::size_t constant);

/// d(log E)/d(means of the constants) of a domain's `youngs_modulus`.
VectorX log_modulus_slopes(const Domain& domain);

}  // namespace resilin
