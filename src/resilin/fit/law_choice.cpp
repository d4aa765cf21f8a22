#include "resilin/fit/law_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/state_batch.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin {
namespace {

/// Names beside those of the catalogue: Ogden's law with so many terms.
struct Terms {
  std::string_view name;
  int count;
};
constexpr std::string_view law_of_terms = "ogden";
constexpr std::array term_names = {Terms{"ogden1", 1}, Terms{"ogden2", 2}, Terms{"ogden3", 3}};
constexpr int constants_per_term = 2, most_terms = 3;

int number_of_terms(std::string_view name) {
  if (name == law_of_terms) return most_terms;
  const auto found = std::ranges::find(term_names, name, &Terms::name);
  return found == term_names.end() ? 0 : found->count;
}

/// States without change of volume, away from rest and of no symmetry, by rows.
std::vector<double> probe_states() {
  std::vector<double> H;
  for (const auto& [a, b] : {std::pair(1.1, 1.02), std::pair(0.93, 1.04), std::pair(1.05, 1.08)}) {
    const double c = 1 / (a * b);
    for (const double entry : {a - 1, 0.0, 0.0, 0.0, b - 1, 0.0, 0.0, 0.0, c - 1}) H.push_back(entry);
  }
  return H;
}

/// Whether Psi's second derivative by these two constants vanishes: Psi is then linear in them.
bool is_bilinear_free(const StateBatch<double>& batch, int p, int q) {
  std::array<double, 3> second{};
  second_constant_derivatives(batch, static_cast<std::size_t>(p), static_cast<std::size_t>(q), second.data());
  return std::ranges::all_of(second, [](double value) { return value == 0; });
}

/// The constant of which all Kirchhoff stresses dW/dh_i are the same at J = 1, as of a pressure.
int find_volume_constant(const LawInfo& law, const std::vector<double>& constants) {
  const std::vector<double> H = probe_states();
  const StateBatch<double> batch = batch_at(law, constants, H);
  std::vector<double> dP(H.size());
  for (std::size_t p = 0; p < law.constants.size(); ++p) {
    if (law.constants[p].unit.empty()) continue;
    constant_derivatives(batch, p, static_cast<double*>(nullptr), dP.data());
    double difference = 0;
    for (std::size_t i = 0; i < batch.count; ++i) {
      Vector3 kirchhoff;
      for (std::size_t k = 0; k < 3; ++k)
        kirchhoff[static_cast<Eigen::Index>(k)] = dP[9 * i + 4 * k] * (1 + H[9 * i + 4 * k]);
      difference = std::max(difference, kirchhoff.maxCoeff() - kirchhoff.minCoeff());
    }
    if (difference < 1e-13) return static_cast<int>(p);
  }
  return -1;
}

void sort_into_kinds(LawChoice& choice, const std::vector<double>& sample) {
  const std::vector<int> fitted = choice.fitted();
  choice.linear.clear();
  choice.nonlinear.clear();
  const std::vector<double> H = probe_states();
  const StateBatch<double> batch = batch_at(*choice.law, sample, H);
  for (const int p : fitted) {
    const bool is_linear =
        !choice.is_compressible && is_bilinear_free(batch, p, p) &&
        std::ranges::all_of(choice.linear, [&](int q) { return is_bilinear_free(batch, p, q); });
    (is_linear ? choice.linear : choice.nonlinear).push_back(p);
  }
}

[[noreturn]] void refuse_law(const LawInfo& law, const std::string& place, const std::string& why,
                             const std::string& cure) {
  throw InputError(place, "a law that these tests can determine", std::string(law.name) + ", " + why, cure);
}

const LawInfo& require_fit_law(const std::string& name, const std::string& place) {
  if (number_of_terms(name) > 0) return require_law(law_of_terms, place);
  if (const LawInfo* law = find_law(name)) return *law;
  refuse_word(place, name, fit_law_names());
}

void check_range(const ConstantText& constant, double value, const std::string& place, const char* key) {
  const bool is_inside = value > constant.above && value >= constant.at_least && value <= constant.at_most &&
                         !(constant.is_nonzero && value == 0);
  if (!is_inside)
    throw InputError(place + "." + key, std::string("a ").append(range_text(constant)), format_number(value));
}

/// Bounds may touch the end of a law's range, never leave it.
void check_bounds(const ConstantText& constant, const ConstantSetting& setting) {
  const double least = std::max(constant.above, constant.at_least);
  for (const double bound : {setting.lower, setting.upper})
    if (std::isfinite(bound) && (bound < least || bound > constant.at_most))
      throw InputError(setting.place + ".bounds", std::string("a ").append(range_text(constant)),
                       format_number(bound), "choose bounds within the range of the law");
}

void apply_setting(LawChoice& choice, int place, const ConstantSetting& setting) {
  const ConstantText& constant = choice.law->constants[static_cast<std::size_t>(place)];
  check_bounds(constant, setting);
  if (setting.start) check_range(constant, *setting.start, setting.place, "start");
  if (!setting.value) return;
  check_range(constant, *setting.value, setting.place, "value");
  choice.constants[static_cast<std::size_t>(place)] = *setting.value;
  std::erase(choice.linear, place);
  std::erase(choice.nonlinear, place);
}

}  // namespace

std::vector<int> LawChoice::fitted() const {
  std::vector<int> places = linear;
  places.insert(places.end(), nonlinear.begin(), nonlinear.end());
  std::ranges::sort(places);
  return places;
}

std::vector<std::string> fit_law_names() {
  std::vector<std::string> names;
  for (const LawInfo* law : laws()) {
    names.emplace_back(law->name);
    if (law->name == law_of_terms)
      for (const Terms& terms : term_names) names.emplace_back(terms.name);
  }
  return names;
}

std::vector<std::string> usual_fit_laws() {
  return {"neo_hookean", "mooney_rivlin", "yeoh", "ogden3", "arruda_boyce", "gent"};
}

LawChoice choose_law(const std::string& name, bool is_compressible, const std::string& place) {
  const LawInfo& law = require_fit_law(name, place);
  if (is_sum(law))
    refuse_law(law, place, "a sum of laws, whose constants one test cannot tell apart",
               "fit one of its parts, or the constants of a whole scene");
  if (law.max_fibres > 0)
    refuse_law(law, place, "whose fibres have directions that a homogeneous test does not name",
               "fit its ground substance by neo_hookean");
  if (law.is_quadratic && !is_compressible)
    refuse_law(law, place, "which is valid at small strain only and has no incompressible limit",
               "set volume = \"compressible\", or fit neo_hookean");
  LawChoice choice{name == law_of_terms ? std::string("ogden3") : name, &law, is_compressible, {}, {}, {}};
  // Any constants show of what kind each is; the poorer the symmetry, the better.
  const std::vector<double> sample = law.constants_from({.mu = 0.9, .lambda = 1.7});
  choice.constants.assign(law.constants.size(), 0.0);
  choice.volume_constant = find_volume_constant(law, sample);
  if (!is_compressible && choice.volume_constant < 0)
    refuse_law(law, place, "which has no purely volumetric constant and so no incompressible limit",
               "set volume = \"compressible\"");
  const int num_terms = number_of_terms(name);
  for (int p = 0; p < static_cast<int>(law.constants.size()); ++p) {
    const bool is_absent =
        num_terms > 0 && p >= num_terms * constants_per_term && p < most_terms * constants_per_term;
    const auto place_of_p = static_cast<std::size_t>(p);
    if (is_absent) {
      choice.constants[place_of_p] = law.constants[place_of_p].fallback;
      choice.absent.push_back(p);
    } else if (is_compressible || p != choice.volume_constant) {
      choice.nonlinear.push_back(p);
    }
  }
  sort_into_kinds(choice, sample);
  return choice;
}

bool is_about(const ConstantSetting& setting, const LawChoice& choice, int place) {
  const std::string constant(choice.law->constants[static_cast<std::size_t>(place)].name);
  return setting.name == constant || setting.name == choice.name + "." + constant;
}

void apply_settings(std::vector<LawChoice>& choices, const std::vector<ConstantSetting>& settings) {
  for (const ConstantSetting& setting : settings) {
    bool is_used = false;
    std::vector<std::string> known;
    for (LawChoice& choice : choices)
      for (const int p : choice.fitted()) {
        known.emplace_back(choice.law->constants[static_cast<std::size_t>(p)].name);
        known.push_back(choice.name + "." + known.back());
        if (!is_about(setting, choice, p)) continue;
        apply_setting(choice, p, setting);
        is_used = true;
      }
    if (is_used) continue;
    std::ranges::sort(known);
    known.erase(std::unique(known.begin(), known.end()), known.end());
    refuse_word(setting.place, setting.name, known);
  }
}

void sort_terms(const LawChoice& choice, std::vector<double>& constants) {
  const int num_terms = number_of_terms(choice.name);
  if (num_terms < 2) return;
  std::vector<std::array<double, constants_per_term>> terms;
  for (int i = 0; i < num_terms; ++i)
    terms.push_back(
        {constants[static_cast<std::size_t>(2 * i)], constants[static_cast<std::size_t>(2 * i + 1)]});
  const auto num_fitted = static_cast<int>(choice.linear.size() + choice.nonlinear.size());
  const bool all_fitted = num_fitted >= num_terms * constants_per_term;  // one that is given keeps its place
  if (!all_fitted) return;
  std::ranges::stable_sort(
      terms, [](const auto& a, const auto& b) { return std::abs(a[0] * a[1]) > std::abs(b[0] * b[1]); });
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) constants[2 * i + k] = terms[i][k];
}

}  // namespace resilin
