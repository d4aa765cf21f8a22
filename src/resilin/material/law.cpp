#include "resilin/material/law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/catalog.hpp"

namespace resilin {
namespace {

template <class Law, std::size_t... i>
Law law_from(const double* constants, std::index_sequence<i...>) {
  return Law{constants[i]...};
}

template <class Law>
LawValues evaluate(const double* constants, const std::array<double, 3>& variables) {
  using Number = Dual2<double>;
  const auto law = law_from<Law>(constants, std::make_index_sequence<Law::constants.size()>{});
  const auto psi_of = [&]<class T>(const T& a, const T& b, const T& c) {
    if constexpr (Law::kind == LawKind::small_strain)
      return law.energy_density(SmallStrain<T>{a, c});
    else
      return law.energy_density(Invariants<T>::from_reduced(a, b, c));
  };
  const Number psi = psi_of(Number::variable(variables[0], 0), Number::variable(variables[1], 1),
                            Number::variable(variables[2], 2));
  LawValues values{psi_of(variables[0], variables[1], variables[2]), {}, {}};
  std::copy(std::begin(psi.slope), std::end(psi.slope), values.slope.begin());
  std::copy(std::begin(psi.curvature), std::end(psi.curvature), values.curvature.begin());
  if (Law::needs_positive_J && !(variables[2] > -1)) {
    values.energy = std::numeric_limits<double>::infinity();
    values.slope.fill(std::numeric_limits<double>::quiet_NaN());
    values.curvature.fill(std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

template <template <class> class Law, std::size_t... i>
std::vector<double> constants_from(const Hooke& hooke, std::index_sequence<i...>) {
  const auto members = [](const Law<double>& law) {
    std::array<double, sizeof...(i)> values;
    static_assert(sizeof(law) == sizeof(values), "a law's members are its constants, in their order");
    std::copy_n(reinterpret_cast<const double*>(&law), sizeof...(i), values.begin());
    return values;
  }(Law<double>::from(hooke));
  return {members.begin(), members.end()};
}

template <template <class> class Law>
LawInfo info(int index) {
  using Plain = Law<double>;
  return {index,
          Plain::kind,
          Plain::name,
          Plain::formula,
          Plain::source,
          Plain::inversion,
          Plain::needs_positive_J,
          Plain::uses_second_invariant,
          Plain::constants,
          [](const Hooke& hooke) {
            return constants_from<Law>(hooke, std::make_index_sequence<Plain::constants.size()>{});
          },
          evaluate<Plain>};
}

template <template <class> class... Law>
std::vector<LawInfo> all_infos(LawList<Law...>) {
  int index = 0;
  return {info<Law>(index++)...};
}

const std::vector<LawInfo>& infos() {
  static const std::vector<LawInfo> table = all_infos(Laws{});
  return table;
}

std::vector<std::string> constant_names(const LawInfo& law) {
  std::vector<std::string> names;
  for (const ConstantText& constant : law.constants) names.emplace_back(constant.name);
  return names;
}

void check_constant(const ConstantText& constant, double value, const std::string& place) {
  if (std::isfinite(value) && value > constant.above) return;
  const std::string expected =
      std::isfinite(constant.above)
          ? "a number above " + format_number(constant.above) + " " + std::string(constant.unit)
          : "a finite number in " + std::string(constant.unit);
  throw InputError(place + "." + std::string(constant.name), expected, format_number(value));
}

std::vector<double> from_young_poisson(const LawInfo& law, double youngs_modulus, double poissons_ratio,
                                       const std::string& place) {
  if (!(std::isfinite(youngs_modulus) && youngs_modulus > 0))
    throw InputError(place + ".youngs_modulus", "a number above 0 Pa", format_number(youngs_modulus));
  if (!(poissons_ratio > -1 && poissons_ratio < 0.5))
    throw InputError(place + ".poissons_ratio", "a number in (-1, 0.5)", format_number(poissons_ratio),
                     poissons_ratio >= 0.5 ? "for a nearly incompressible solid use 0.495" : "");
  return law.constants_from(hooke_from_young_poisson(youngs_modulus, poissons_ratio));
}

}  // namespace

std::vector<const LawInfo*> laws() {
  std::vector<const LawInfo*> all;
  for (const LawInfo& law : infos()) all.push_back(&law);
  return all;
}

const LawInfo* find_law(std::string_view name) {
  for (const LawInfo& law : infos())
    if (law.name == name) return &law;
  return nullptr;
}

const LawInfo& require_law(std::string_view name, const std::string& place) {
  if (const LawInfo* law = find_law(name)) return *law;
  std::vector<std::string> names;
  for (const LawInfo& law : infos()) names.emplace_back(law.name);
  const std::string nearest = nearest_word(name, names);
  throw InputError(place, "one of " + join(names), "\"" + std::string(name) + "\"",
                   nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
}

std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, double>& given,
                                      const std::string& place) {
  const std::vector<std::string> own = constant_names(law);
  const std::string expected = "youngs_modulus and poissons_ratio, or " + join(own, " and ");
  std::vector<std::string> known = {"youngs_modulus", "poissons_ratio"};
  known.insert(known.end(), own.begin(), own.end());
  bool gives_hooke = false, gives_own = false;
  for (const auto& [name, value] : given) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string nearest = nearest_word(name, known);
      throw InputError(place + "." + name, expected, "an unknown constant",
                       nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
    }
    (name == "youngs_modulus" || name == "poissons_ratio" ? gives_hooke : gives_own) = true;
  }
  if (gives_hooke && gives_own) throw InputError(place, expected, "a mixture of both", "leave one pair out");
  const std::vector<std::string> needed =
      gives_own ? own : std::vector<std::string>{"youngs_modulus", "poissons_ratio"};
  for (const std::string& name : needed)
    if (given.count(name) == 0) throw InputError(place + "." + name, expected, "nothing", "add " + name);
  if (!gives_own)
    return from_young_poisson(law, given.at("youngs_modulus"), given.at("poissons_ratio"), place);

  std::vector<double> constants;
  for (std::size_t i = 0; i < own.size(); ++i) {
    constants.push_back(given.at(own[i]));
    check_constant(law.constants[i], constants.back(), place);
  }
  return constants;
}

}  // namespace resilin
