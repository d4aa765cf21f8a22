#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/law_fit.hpp"
#include "resilin/fit/law_problem.hpp"
#include "resilin/material/rest_tangents.hpp"

namespace resilin {
namespace {

constexpr int num_curve_points = 161;
constexpr double beyond_data = 1.12;  ///< so much further curves are drawn, in ln l

struct SmallStrainModuli {
  double shear, bulk;
};

SmallStrainModuli moduli_of(const LawInfo& law, const std::vector<double>& constants) {
  SmallStrainModuli moduli{};
  for_each_rest_tangent(
      law, constants, [&](std::size_t, const double* A) { moduli = {A[9 * 1 + 1], (A[0] + 2 * A[4]) / 3}; });
  return moduli;
}

/// Gives the constant of the volume the value that makes the small-strain solid have this Poisson's ratio.
void set_volume_constant(const LawInfo& law, int place, double poissons_ratio,
                         std::vector<double>& constants) {
  const double shear = moduli_of(law, constants).shear;
  const double wanted = 2 * shear * (1 + poissons_ratio) / (3 * (1 - 2 * poissons_ratio));
  double& constant = constants[static_cast<std::size_t>(place)];
  constant = 0;
  const double without = moduli_of(law, constants).bulk;
  constant = shear;
  const double with = moduli_of(law, constants).bulk;
  constant = shear * (wanted - without) / (with - without);
}

void tell_moduli(const LawChoice& choice, const std::vector<double>& constants, LawFit& fit) {
  const SmallStrainModuli moduli = moduli_of(*choice.law, constants);
  fit.shear_modulus = moduli.shear;
  if (choice.is_compressible) {
    fit.bulk_modulus = moduli.bulk;
    fit.youngs_modulus = 9 * moduli.bulk * moduli.shear / (3 * moduli.bulk + moduli.shear);
    fit.poissons_ratio = (3 * moduli.bulk - 2 * moduli.shear) / (2 * (3 * moduli.bulk + moduli.shear));
    if (fit.poissons_ratio < 0)
      fit.warnings.push_back(
          "a Poisson's ratio of " + format_short(fit.poissons_ratio) +
          " at small strain: the tests do not determine the volume change; add one that does, or set "
          "volume = \"incompressible\"");
  } else {
    fit.bulk_modulus = std::numeric_limits<double>::infinity();
    fit.youngs_modulus = 3 * moduli.shear;
    fit.poissons_ratio = 0.5;
  }
  if (!(moduli.shear > 0))
    fit.warnings.push_back("the shear modulus at small strain is " + format_short(moduli.shear) +
                           " Pa: not a solid; set stability = \"required\"");
}

/// Constants that a scene takes.
void make_material(const LawChoice& choice, std::vector<double> constants, const FitDescription& description,
                   LawFit& fit) {
  const LawInfo& law = *choice.law;
  if (!choice.is_compressible && choice.volume_constant >= 0) {
    set_volume_constant(law, choice.volume_constant, description.poissons_ratio, constants);
    fit.volume_is_assumed = true;
    ConstantEstimate& estimate = fit.constants[static_cast<std::size_t>(choice.volume_constant)];
    estimate.value = constants[static_cast<std::size_t>(choice.volume_constant)];
  }
  fit.material = {&law, constants, {}};
  std::map<std::string, double> given;
  for (std::size_t p = 0; p < constants.size(); ++p) given[std::string(law.constants[p].name)] = constants[p];
  try {
    resolve_constants(law, given, fit.name);
  } catch (const InputError& error) {
    fit.is_usable = false;
    fit.warnings.push_back(std::string("no scene takes these constants: ") + error.what());
  }
}

/// The loads that have been measured in this mode, with rest.
struct MeasuredRange {
  double least, most;
  bool is_tested = false;
};
MeasuredRange measured_range(const FitDescription& description, TestMode mode) {
  MeasuredRange range{rest_load(mode), rest_load(mode)};
  for (const MaterialTest& test : description.tests) {
    if (test.mode != mode) continue;
    range.is_tested = true;
    range.least = std::min(range.least, std::ranges::min(test.load));
    range.most = std::max(range.most, std::ranges::max(test.load));
  }
  return range;
}

/// The load of this mode that strains as far as any test does.
double load_of_strain(TestMode mode, double strain) {
  double low = rest_load(mode), high = 1000;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (isochoric_strain({mode, middle}) < strain ? low : high) = middle;
  }
  return low;
}

double largest_strain(const FitDescription& description) {
  double strain = 0.01;
  for (const MaterialTest& test : description.tests)
    for (const double load : test.load) strain = std::max(strain, isochoric_strain({test.mode, load}));
  return strain;
}

/// Tested modes: their data; the others: as far as the others are strained, in tension.
MeasuredRange shown_range(const FitDescription& description, TestMode mode) {
  MeasuredRange range = measured_range(description, mode);
  if (!range.is_tested) range.most = load_of_strain(mode, largest_strain(description));
  return range;
}

std::string load_text(TestMode mode, double load) {
  return (mode == TestMode::simple_shear ? "an amount of shear of " : "stretch ") + format_short(load);
}

void tell_stability(const LawChoice& choice, const std::vector<double>& constants,
                    const FitDescription& description, LawFit& fit) {
  if (description.stability == StabilityRule::off) return;
  for (const TestMode mode : shown_modes(description, choice.is_compressible)) {
    const MeasuredRange range = shown_range(description, mode);
    const double furthest = mode == TestMode::simple_shear ? std::max(-range.least, range.most)
                                                           : std::max(range.most, 1 / range.least);
    const StabilityRange stable =
        find_stability_range(*choice.law, choice.is_compressible, constants, mode, furthest);
    fit.stability.push_back(stable);
    if (!(fit.shear_modulus > 0)) continue;  // said already: it is unstable everywhere
    const std::string what =
        range.is_tested ? " within the data" : ", as far as the tests go; no test shows this mode";
    if (stable.above && *stable.above < range.most * (1 - 1e-9))
      fit.warnings.push_back(spelling(mode) + ": unstable beyond " + load_text(mode, *stable.above) + what);
    if (stable.below && *stable.below > range.least * (1 + 1e-9))
      fit.warnings.push_back(spelling(mode) + ": unstable below " + load_text(mode, *stable.below) + what);
  }
}

void draw_curves(const LawChoice& choice, const std::vector<double>& constants,
                 const FitDescription& description, LawFit& fit) {
  for (const TestMode mode : shown_modes(description, choice.is_compressible)) {
    const MeasuredRange range = shown_range(description, mode);
    const bool is_shear = mode == TestMode::simple_shear;
    const double low = is_shear ? range.least : std::pow(range.least, beyond_data);
    const double high = is_shear ? range.most * beyond_data : std::pow(range.most, beyond_data);
    std::vector<LoadedState> states;
    for (int i = 0; i < num_curve_points; ++i)
      states.push_back({mode, low + (high - low) * i / (num_curve_points - 1)});
    const VectorX stress = HomogeneousModel(*choice.law, choice.is_compressible, states).stresses(constants);
    const std::vector<DenseMatrix> hessians =
        stability_hessians(*choice.law, choice.is_compressible, constants, states);
    FittedCurve curve{mode, {}, {stress.begin(), stress.end()}, {}};
    for (std::size_t i = 0; i < states.size(); ++i) {
      curve.load.push_back(states[i].load);
      curve.is_stable.push_back(smallest_stiffness(hessians[i]) > 0);
    }
    fit.curves.push_back(std::move(curve));
  }
}

double sum_at(const LawChoice& choice, const std::vector<double>& constants, const FitData& data) {
  const VectorX stress =
      HomogeneousModel(*choice.law, choice.is_compressible, data.states).stresses(constants);
  return data.weights.cwiseProduct(stress - data.measured).squaredNorm();
}

/// Terms whose signs can be turned without a trace, such as Ogden's in planar tension.
void tell_sign_twins(const LawChoice& choice, const std::vector<double>& constants, const FitData& data,
                     LawFit& fit) {
  const double sum = sum_at(choice, constants, data);
  for (const int p : choice.linear)
    for (const int q : choice.nonlinear) {
      if (!choice.law->constants[static_cast<std::size_t>(q)].is_nonzero) continue;
      std::vector<double> turned = constants;
      turned[static_cast<std::size_t>(p)] *= -1;
      turned[static_cast<std::size_t>(q)] *= -1;
      if (!(std::abs(sum_at(choice, turned, data) - sum) <= 1e-9 * sum)) continue;
      const std::string a(choice.law->constants[static_cast<std::size_t>(p)].name);
      const std::string b(choice.law->constants[static_cast<std::size_t>(q)].name);
      std::string text("(");
      text.append(a).append(", ").append(b).append(") and (-").append(a).append(", -").append(b);
      text += ") give the same stresses in these tests; a uniaxial or equibiaxial test tells them apart";
      fit.warnings.push_back(text);
    }
}

/// "c10 = 1.2e+05 Pa, c01 = 300 Pa".
std::string named_values(const LawChoice& choice, const std::vector<double>& constants) {
  std::vector<std::string> names;
  for (const int p : choice.fitted()) {
    const ConstantText& constant = choice.law->constants[static_cast<std::size_t>(p)];
    std::string name(constant.name);
    name += " = " + format_short(constants[static_cast<std::size_t>(p)]);
    if (!constant.unit.empty()) name.append(" ").append(constant.unit);
    names.push_back(name);
  }
  return join(names);
}

}  // namespace

std::vector<TestMode> shown_modes(const FitDescription& description, bool is_compressible) {
  std::vector<TestMode> modes;
  for (std::size_t i = 0; i < spellings(TestMode{}).size(); ++i) {
    const auto mode = static_cast<TestMode>(i);
    const bool is_usual =
        mode == TestMode::uniaxial || mode == TestMode::equibiaxial || mode == TestMode::planar;
    const bool is_tested = measured_range(description, mode).is_tested;
    if (is_tested || (is_usual && (!is_compressible || largest_strain(description) > 0.02)))
      modes.push_back(mode);
  }
  return modes;
}

void tell_rivals(const LawChoice& choice, const SearchResult& found, LawFit& fit) {
  if (found.rivals.empty()) return;
  std::string others = named_values(choice, found.rivals.front());
  if (found.rivals.size() > 1) others += ", and " + std::to_string(found.rivals.size() - 1) + " more";
  fit.warnings.push_back("the tests do not determine which: other constants meet them as well (" + others +
                         "); a test in another mode would tell");
}

void tell_limits(const LawChoice& choice, const SearchResult& found, const FitData& data,
                 const FitDescription& description, LawFit& fit) {
  if (!found.free_constants) return;
  fit.is_bounded = true;
  const double unit =
      description.residual == ResidualKind::absolute ? data.stress_scale * data.stress_scale : 1;
  fit.free_sum_of_squares = found.free_sum * unit;
  const bool held = found.reached.rows() > 0;
  fit.warnings.push_back(
      "the free optimum (" + named_values(choice, *found.free_constants) + ") " +
      (found.is_held_by_range && !found.is_held_by_stability
           ? "leaves the range of the constants"
           : "is unstable within the data (shear modulus at small strain " +
                 format_short(moduli_of(*choice.law, *found.free_constants).shear) + " Pa)") +
      "; these are the best constants within the limits, with " +
      format_short(fit.sum_of_squares / *fit.free_sum_of_squares) + " times its sum of squares" +
      (held ? "; intervals are along the limit that holds them" : ""));
}

void tell_ambiguities(const LawChoice& choice, const std::vector<double>& constants, const FitData& data,
                      const FitDescription& description, LawFit& fit) {
  const HomogeneousModel model(*choice.law, choice.is_compressible, data.states);
  const LawProblem problem(choice, model, data.measured, data.weights, data.stress_scale,
                           description.constants);
  VectorX c, v;
  problem.unknowns(constants, c, v);
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const ParameterTransform& transform = problem.transforms()[static_cast<std::size_t>(i)];
    const auto place = static_cast<std::size_t>(choice.nonlinear[static_cast<std::size_t>(i)]);
    if (transform.to(v[i]) > transform.lower() && transform.to(v[i]) < transform.upper()) continue;
    fit.warnings.push_back(std::string(choice.law->constants[place].name) + " = " +
                           format_short(constants[place]) +
                           " is at the end of its bounds: the tests do not determine it");
    fit.constants[place].is_determined = false;
  }
  if (!choice.is_compressible) tell_sign_twins(choice, constants, data, fit);
  for (const ConstantEstimate& constant : fit.constants)
    if (constant.is_fitted() && constant.is_determined && std::isfinite(constant.half_width_95) &&
        constant.half_width_95 > std::abs(constant.value))
      fit.remarks.push_back(constant.name + " is not different from 0: its interval holds 0");
}

void tell_material(const LawChoice& choice, const std::vector<double>& constants,
                   const FitDescription& description, LawFit& fit) {
  tell_moduli(choice, constants, fit);
  make_material(choice, constants, description, fit);
  tell_stability(choice, constants, description, fit);
  draw_curves(choice, constants, description, fit);
}

}  // namespace resilin
