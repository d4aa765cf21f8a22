#include "resilin/fit/fit_data.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/units.hpp"

namespace resilin {
namespace {

constexpr double usual_modulus = 5e5;    ///< usual modulus of rubber [Pa]
constexpr double softest_usual = 1e3;    ///< less without a unit is taken for a mistake [Pa]
constexpr double stiffest_usual = 1e10;  ///< [Pa]
constexpr double doubtful_ratio = 4;     ///< doubtful ratio of moduli of two tests of one material

double weight_of(const FitDescription& description, const MaterialTest& test, std::size_t i, double scale) {
  const double root = std::sqrt(test.weight);
  switch (description.residual) {
    case ResidualKind::relative:
      if (test.stress[i] == 0)
        throw InputError(test.place, "stresses other than 0 for relative residuals",
                         "0 at a load of " + format_number(test.load[i]),
                         "leave the point out, or set residual = \"absolute\"");
      return root * scale / std::abs(test.stress[i]);
    case ResidualKind::sigma:
      if (test.sigma.empty())
        throw InputError(test.place, "a sigma for residual = \"sigma\"", "none",
                         "add sigma = ... to the test");
      return root * scale / test.sigma[i];
    case ResidualKind::absolute:
      break;
  }
  return root;
}

/// The shear modulus of a Neo-Hookean solid through the points of a test: the middle one of all.
double modulus_of(const MaterialTest& test) {
  std::vector<LoadedState> states;
  for (const double load : test.load) states.push_back({test.mode, load});
  const LawInfo& law = require_law("neo_hookean_isochoric", "law");
  const VectorX unit = HomogeneousModel(law, false, states).stresses(std::vector<double>{1, 0});
  std::vector<double> moduli;
  for (std::size_t i = 0; i < test.num_points(); ++i)
    moduli.push_back(test.stress[i] / unit[static_cast<Eigen::Index>(i)]);
  std::ranges::nth_element(moduli, moduli.begin() + static_cast<std::ptrdiff_t>(moduli.size() / 2));
  return moduli[moduli.size() / 2];
}

void check_unit(const MaterialTest& test, double modulus, std::vector<std::string>& warnings) {
  if (!(modulus > 0) || (modulus >= softest_usual && modulus <= stiffest_usual)) return;
  const std::string guess = mistaken_unit(usual_modulus / modulus, test.unit);
  const std::string shown = format_short(modulus) + " Pa";
  if (!test.has_unit && modulus < softest_usual)
    throw InputError(
        test.place + ".unit",
        "the unit of the stresses: a shear modulus of about " + shown + " is softer than any rubber",
        "none, so that they are read as Pa",
        (guess.empty() ? std::string() : "is it " + guess + "? ") +
            "say unit = \"kgf/cm2\", \"MPa\" ..., or \"Pa\" if it is so");
  warnings.push_back(test.place + ": a shear modulus of about " + shown + " is unusual" +
                     (guess.empty() ? "" : "; is it " + guess + "?"));
}

/// The material is the same in all tests, so are its moduli.
void compare_units(const std::vector<const MaterialTest*>& tests, const std::vector<double>& moduli,
                   std::vector<std::string>& warnings) {
  const auto [least, most] = std::ranges::minmax_element(moduli);
  if (moduli.size() < 2 || !(*least > 0) || *most < doubtful_ratio * *least) return;
  const MaterialTest& soft = *tests[static_cast<std::size_t>(least - moduli.begin())];
  const MaterialTest& stiff = *tests[static_cast<std::size_t>(most - moduli.begin())];
  const std::string guess = mistaken_unit(*most / *least, soft.unit);
  warnings.push_back(soft.place + ": " + soft.name + " shows a modulus " + format_short(*most / *least) +
                     " times less than " + stiff.name + "; is it one material" +
                     (guess.empty() ? "?" : ", or " + guess + "?"));
}

/// Where the points of one test end long before those of another.
void tell_extrapolation(const FitDescription& description, std::vector<std::string>& warnings) {
  const MaterialTest* furthest = nullptr;
  double most = 0;
  std::vector<double> reach;
  for (const MaterialTest& test : description.tests) {
    double strain = 0;
    for (const double load : test.load)
      if (keeps_volume(test.mode)) strain = std::max(strain, isochoric_strain({test.mode, load}));
    reach.push_back(strain);
    if (strain > most) {
      most = strain;
      furthest = &test;
    }
  }
  for (std::size_t i = 0; i < reach.size(); ++i) {
    const MaterialTest& test = description.tests[i];
    if (!keeps_volume(test.mode) || reach[i] > 0.8 * most) continue;
    const bool is_covered = std::ranges::any_of(description.tests, [&](const MaterialTest& other) {
      const auto k = static_cast<std::size_t>(&other - description.tests.data());
      return other.mode == test.mode && reach[k] > 0.8 * most;
    });
    if (is_covered) continue;
    const double end = test.mode == TestMode::simple_shear || std::ranges::max(test.load) > 1
                           ? std::ranges::max(test.load)
                           : std::ranges::min(test.load);
    warnings.push_back(test.name + " ends at " + format_short(end) + " (I1 - 3 = " + format_short(reach[i]) +
                       "), " + furthest->name + " goes on to I1 - 3 = " + format_short(most) +
                       ": the curve of " + test.name + " is extrapolated beyond its data");
  }
}

}  // namespace

double isochoric_strain(const LoadedState& state) {
  const double l = state.load, e = l - 1;
  switch (state.mode) {
    case TestMode::uniaxial:
      return e * e * (1 + 2 / l);  // l^2 + 2/l - 3
    case TestMode::equibiaxial:
      return 2 * l * l + 1 / (l * l * l * l) - 3;
    case TestMode::planar:
      return (l - 1 / l) * (l - 1 / l);
    case TestMode::simple_shear:
      return l * l;
    default:
      return 0;
  }
}

bool is_compressible_fit(const FitDescription& description) {
  if (description.volume != VolumeRule::automatic) return description.volume == VolumeRule::compressible;
  return std::ranges::any_of(description.tests,
                             [](const MaterialTest& test) { return !keeps_volume(test.mode); });
}

FitData collect_data(const FitDescription& description, bool is_compressible) {
  FitData data;
  std::vector<double> measured, weights, moduli;
  for (const MaterialTest& test : description.tests) {
    if (!is_compressible && !keeps_volume(test.mode))
      throw InputError(test.place + ".mode",
                       "a test that keeps the volume, since volume is \"incompressible\"",
                       spelling(test.mode), "set volume = \"compressible\" in [fit]");
    if (keeps_volume(test.mode)) moduli.push_back(modulus_of(test));
  }
  double largest = 0;
  for (const MaterialTest& test : description.tests)
    for (const double stress : test.stress) largest = std::max(largest, std::abs(stress));
  if (!(largest > 0))
    throw InputError(description.place + ": test", "stresses other than 0", "none",
                     "are the columns the right ones?");
  data.stress_scale = largest;
  for (const MaterialTest& test : description.tests)
    for (std::size_t i = 0; i < test.num_points(); ++i) {
      data.states.push_back({test.mode, test.load[i]});
      measured.push_back(test.stress[i]);
      weights.push_back(weight_of(description, test, i, largest));
    }
  data.measured = Eigen::Map<const VectorX>(measured.data(), static_cast<Eigen::Index>(measured.size()));
  data.weights = Eigen::Map<const VectorX>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  for (const double modulus : moduli) data.shear_modulus = std::max(data.shear_modulus, modulus);
  if (!(data.shear_modulus > 0)) data.shear_modulus = 0.1 * largest;
  return data;
}

std::vector<std::string> data_warnings(const FitDescription& description) {
  std::vector<std::string> warnings;
  std::vector<const MaterialTest*> tests;
  std::vector<double> moduli;
  for (const MaterialTest& test : description.tests) {
    if (!keeps_volume(test.mode)) continue;
    tests.push_back(&test);
    moduli.push_back(modulus_of(test));
    check_unit(test, moduli.back(), warnings);
  }
  compare_units(tests, moduli, warnings);
  tell_extrapolation(description, warnings);
  return warnings;
}

}  // namespace resilin
