#include "resilin/material/law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/catalog.hpp"
#include "resilin/material/derive.hpp"

namespace resilin {
namespace {

template <class Law>
constexpr std::size_t num_free =
    static_cast<std::size_t>(std::ranges::count_if(Law::constants, &ConstantText::is_free));

template <class Law, std::size_t... i>
Law law_from(const Hooke& hooke, [[maybe_unused]] std::span<const double> free, std::index_sequence<i...>) {
  return Law::from(hooke, free[i]...);
}

template <template <class> class Law>
std::vector<double> convert(const Hooke& hooke, std::span<const double> free) {
  constexpr std::size_t count = Law<double>::constants.size();
  const Law<double> law =
      law_from<Law<double>>(hooke, free, std::make_index_sequence<num_free<Law<double>>>{});
  static_assert(sizeof(law) == count * sizeof(double), "a law's members are its constants, in their order");
  const auto* members = reinterpret_cast<const double*>(&law);
  return {members, members + count};
}

template <class Law>
constexpr int max_fibres() {
  if constexpr (requires { Law::max_fibres; })
    return Law::max_fibres;
  else
    return 0;
}

template <class Law>
constexpr double only_poissons_ratio() {
  if constexpr (requires { Law::only_poissons_ratio; })
    return Law::only_poissons_ratio;
  else
    return std::numeric_limits<double>::quiet_NaN();
}

template <template <class> class Law>
LawInfo info(int index) {
  using Plain = Law<double>;
  return {.index = index,
          .kind = Plain::kind,
          .name = Plain::name,
          .formula = Plain::formula,
          .source = Plain::source,
          .inversion = Plain::inversion,
          .needs_positive_J = Plain::needs_positive_J,
          .uses_second_invariant = Plain::uses_second_invariant,
          .max_fibres = max_fibres<Plain>(),
          .only_poissons_ratio = only_poissons_ratio<Plain>(),
          .constants = Plain::constants,
          .convert = convert<Law>};
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

std::string unit_text(const ConstantText& constant) {
  std::string text;
  if (!constant.unit.empty()) text.append(" ").append(constant.unit);
  return text;
}

void check_constant(const ConstantText& constant, double value, const std::string& place) {
  const bool is_inside = value > constant.above && value >= constant.at_least && value <= constant.at_most;
  if (std::isfinite(value) && is_inside && !(constant.is_nonzero && value == 0)) return;
  throw InputError(place + "." + std::string(constant.name), std::string("a ").append(range_text(constant)),
                   format_number(value));
}

Hooke checked_hooke(const LawInfo& law, double youngs_modulus, double poissons_ratio,
                    const std::string& place) {
  if (!(std::isfinite(youngs_modulus) && youngs_modulus > 0))
    throw InputError(place + ".youngs_modulus", "a number above 0 Pa", format_number(youngs_modulus));
  if (!(poissons_ratio > -1 && poissons_ratio < 0.5))
    throw InputError(place + ".poissons_ratio", "a number in (-1, 0.5)", format_number(poissons_ratio),
                     poissons_ratio >= 0.5 ? "for a nearly incompressible solid use 0.495" : "");
  if (!std::isnan(law.only_poissons_ratio) && poissons_ratio != law.only_poissons_ratio)
    throw InputError(
        place + ".poissons_ratio",
        format_number(law.only_poissons_ratio) + ", the only one that " + std::string(law.name) + " can have",
        format_number(poissons_ratio), "choose another law, such as corotated");
  return hooke_from_young_poisson(youngs_modulus, poissons_ratio);
}

/// Throws unless the law resists shear and change of volume at rest. Fibres are slack there.
void check_rest(const LawInfo& law, const std::vector<double>& constants, const std::string& place) {
  const Material material{&law, constants, {}};
  const TangentMatrix<3> A = stress_tangent<3>(material, Matrix<3>(Matrix<3>::Identity()));
  const double mu = A(1, 1), bulk_modulus = (A(0, 0) + 2 * A(0, 4)) / 3;
  const double size = A.cwiseAbs().maxCoeff();
  if (mu > 1e-14 * size && bulk_modulus > 1e-14 * size) return;
  throw InputError(place, "constants of a solid that is stable at rest",
                   "a small-strain shear modulus of " + format_number(mu) + " Pa and bulk modulus of " +
                       format_number(bulk_modulus) + " Pa",
                   "both must be positive");
}

class ConstantReader {
 public:
  ConstantReader(const LawInfo& law, const std::map<std::string, double>& given, std::string place)
      : law_(law), given_(given), place_(std::move(place)) {}

  std::vector<double> read() const {
    refuse_unknown();
    const bool gives_hooke = has("youngs_modulus") || has("poissons_ratio");
    std::vector<double> constants = gives_hooke || given_.empty() ? from_hooke() : literal();
    check_rest(law_, constants, place_);
    return constants;
  }

 private:
  bool has(std::string_view name) const { return given_.count(std::string(name)) != 0; }

  std::string expected() const {
    std::vector<std::string> beside = {"youngs_modulus", "poissons_ratio"}, own;
    for (const ConstantText& constant : law_.constants) {
      own.emplace_back(constant.name);
      if (constant.is_free) beside.emplace_back(constant.name);
    }
    return join(beside, " and ") + ", or " + join(own, " and ");
  }

  void refuse_unknown() const {
    std::vector<std::string> known = {"youngs_modulus", "poissons_ratio"};
    for (const ConstantText& constant : law_.constants) known.emplace_back(constant.name);
    for (const auto& [name, value] : given_) {
      if (std::ranges::find(known, name) != known.end()) continue;
      const std::string nearest = nearest_word(name, known);
      throw InputError(place_ + "." + name, expected(), "an unknown constant",
                       nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
    }
  }

  double require(std::string_view name) const {
    if (!has(name))
      throw InputError(place_ + "." + std::string(name), expected(), "nothing", "add " + std::string(name));
    return given_.at(std::string(name));
  }

  double value_of(const ConstantText& constant) const {
    const double value =
        has(constant.name) || std::isnan(constant.fallback) ? require(constant.name) : constant.fallback;
    check_constant(constant, value, place_);
    return value;
  }

  std::vector<double> from_hooke() const {
    std::vector<double> free;
    for (const ConstantText& constant : law_.constants)
      if (!constant.is_free && has(constant.name))
        throw InputError(place_, expected(), "a mixture of both",
                         "leave " + std::string(constant.name) + " or youngs_modulus and poissons_ratio out");
    const double youngs_modulus = require("youngs_modulus"), poissons_ratio = require("poissons_ratio");
    const Hooke hooke = checked_hooke(law_, youngs_modulus, poissons_ratio, place_);
    for (const ConstantText& constant : law_.constants)
      if (constant.is_free) free.push_back(value_of(constant));
    return law_.convert(hooke, free);
  }

  std::vector<double> literal() const {
    std::vector<double> constants;
    for (const ConstantText& constant : law_.constants) constants.push_back(value_of(constant));
    return constants;
  }

  const LawInfo& law_;
  const std::map<std::string, double>& given_;
  std::string place_;
};

}  // namespace

std::vector<double> LawInfo::constants_from(const Hooke& hooke) const {
  std::vector<double> free;
  for (const ConstantText& constant : constants)
    if (constant.is_free)
      free.push_back(!std::isnan(constant.fallback) ? constant.fallback
                     : constant.unit.empty()        ? 1
                                                    : hooke.mu);
  return convert(hooke, free);
}

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
  return ConstantReader(law, given, place).read();
}

std::string range_text(const ConstantText& constant) {
  std::string text = constant.is_nonzero ? "number other than 0" : "number";
  const auto bound = [&](const char* word, double value) {
    text.append(word).append(format_number(value)).append(unit_text(constant));
  };
  if (std::isfinite(constant.above)) bound(" above ", constant.above);
  if (std::isfinite(constant.at_least) && std::isfinite(constant.at_most)) {
    bound(" from ", constant.at_least);
    bound(" to ", constant.at_most);
  } else if (std::isfinite(constant.at_least)) {
    bound(" not below ", constant.at_least);
  }
  const bool is_bounded = std::isfinite(constant.above) || std::isfinite(constant.at_least);
  if (!is_bounded && !constant.unit.empty()) text += " in" + unit_text(constant);
  return text;
}

}  // namespace resilin
