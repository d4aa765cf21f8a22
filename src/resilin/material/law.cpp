#include "resilin/material/law.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/vocabulary.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/rest_tangents.hpp"

namespace resilin {
namespace {

std::string unit_text(const ConstantText& constant) {
  std::string text;
  if (!constant.unit.empty()) text.append(" ").append(constant.unit);
  return text;
}

bool is_inside(const ConstantText& constant, double value) {
  return std::isfinite(value) && value > constant.above && value >= constant.at_least &&
         value <= constant.at_most && !(constant.is_nonzero && value == 0);
}

/// Reads the constants that a user gave for `count` states, one state at a time.
class ConstantReader {
 public:
  using NameOf = std::function<std::string(std::size_t)>;

  ConstantReader(const LawInfo& law, const std::map<std::string, Column>& given, const std::string& place,
                 const NameOf& name_of)
      : law_(law), given_(given), place_(place), name_of_(name_of) {}

  std::vector<double> read(std::size_t count) const {
    std::vector<double> all = is_sum(law_) ? read_parts(count) : read_numbers(count);
    check_rest(all);
    return all;
  }

 private:
  std::vector<double> read_numbers(std::size_t count) const {
    refuse_unknown();
    const bool is_hooke = given_.empty() || has("youngs_modulus") || has("poissons_ratio");
    const std::vector<Source> sources = is_hooke ? hooke_sources() : own_sources();
    const std::size_t num_constants = law_.constants.size();
    std::vector<double> all(count * num_constants);
    for (std::size_t i = 0; i < count; ++i) {
      const std::vector<double> own = is_hooke ? from_hooke(sources, i) : literal(sources, i);
      std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(i * num_constants));
    }
    return all;
  }

  /// The constants of a sum: each part reads its own.
  std::vector<double> read_parts(std::size_t count) const {
    const std::size_t width = law_.constants.size();
    std::vector<double> all(count * width);
    const std::vector<LawPart> parts = parts_of(law_);
    for (const auto& [name, column] : given_) {
      std::size_t k = 0;
      while (k < parts.size() && !name.starts_with(sum_constant(k, ""))) ++k;
      if (k == parts.size())
        throw InputError(place_ + "." + name,
                         "constants of the parts, such as " + std::string(law_.constants.front().name),
                         "an unknown constant");
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const std::string prefix = sum_constant(k, "");
      std::map<std::string, Column> given;
      for (const auto& [name, column] : given_)
        if (name.starts_with(prefix)) given[name.substr(prefix.size())] = column;
      const std::string place = place_ + "." + prefix.substr(0, prefix.size() - 1);
      const std::vector<double> own =
          ConstantReader(*parts[k].law, given, place, name_of_).read_numbers(count);
      const std::size_t own_width = parts[k].law->constants.size();
      for (std::size_t i = 0; i < own.size(); ++i)
        all[i / own_width * width + parts[k].first_constant + i % own_width] = own[i];
    }
    return all;
  }

  /// Where a number comes from.
  struct Source {
    const ConstantText* constant;  ///< null for Young's modulus and Poisson's ratio
    Column column;
    double at(std::size_t i) const { return column.data[i * column.stride]; }
  };

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
    for (const auto& [name, column] : given_) {
      if (std::ranges::find(known, name) != known.end()) continue;
      const std::string near = did_you_mean(name, known);
      throw InputError(place_ + "." + name, expected(), "an unknown constant",
                       near.empty() ? foreign_word_cure(name, known) : near);
    }
  }

  Column require(std::string_view name) const {
    const auto found = given_.find(std::string(name));
    if (found != given_.end()) return found->second;
    throw InputError(place_ + "." + std::string(name), expected(), "nothing", "add " + std::string(name));
  }

  Source source_of(const ConstantText& constant) const {
    if (!has(constant.name) && !std::isnan(constant.fallback)) return {&constant, {&constant.fallback, 0}};
    return {&constant, require(constant.name)};
  }

  std::vector<Source> hooke_sources() const {
    for (const ConstantText& constant : law_.constants)
      if (!constant.is_free && has(constant.name))
        throw InputError(place_, expected(), "a mixture of both",
                         "leave " + std::string(constant.name) + " or youngs_modulus and poissons_ratio out");
    std::vector<Source> sources = {{nullptr, require("youngs_modulus")},
                                   {nullptr, require("poissons_ratio")}};
    for (const ConstantText& constant : law_.constants)
      if (constant.is_free) sources.push_back(source_of(constant));
    return sources;
  }

  std::vector<Source> own_sources() const {
    std::vector<Source> sources;
    for (const ConstantText& constant : law_.constants) sources.push_back(source_of(constant));
    return sources;
  }

  double checked(const Source& source, std::size_t i) const {
    const double value = source.at(i);
    if (!is_inside(*source.constant, value))
      throw InputError((place_ + name_of_(i)) + "." + std::string(source.constant->name),
                       std::string("a ").append(range_text(*source.constant)), format_number(value));
    return value;
  }

  std::vector<double> from_hooke(const std::vector<Source>& sources, std::size_t i) const {
    const Hooke hooke = checked_hooke(sources[0].at(i), sources[1].at(i), i);
    std::array<double, max_constants> free;
    for (std::size_t k = 2; k < sources.size(); ++k) free[k - 2] = checked(sources[k], i);
    return law_.convert(hooke, std::span(free).first(sources.size() - 2));
  }

  std::vector<double> literal(const std::vector<Source>& sources, std::size_t i) const {
    std::vector<double> constants;
    constants.reserve(sources.size());
    for (const Source& source : sources) constants.push_back(checked(source, i));
    return constants;
  }

  Hooke checked_hooke(double youngs_modulus, double poissons_ratio, std::size_t i) const {
    if (!(std::isfinite(youngs_modulus) && youngs_modulus > 0))
      throw InputError((place_ + name_of_(i)) + ".youngs_modulus", "a number above 0 Pa",
                       format_number(youngs_modulus));
    if (!(poissons_ratio > -1 && poissons_ratio < 0.5))
      throw InputError((place_ + name_of_(i)) + ".poissons_ratio", "a number in (-1, 0.5)",
                       format_number(poissons_ratio),
                       poissons_ratio >= 0.5 ? "for a nearly incompressible solid use 0.495" : "");
    if (!std::isnan(law_.only_poissons_ratio) && poissons_ratio != law_.only_poissons_ratio)
      throw InputError((place_ + name_of_(i)) + ".poissons_ratio",
                       format_number(law_.only_poissons_ratio) + ", the only one that " +
                           std::string(law_.name) + " can have",
                       format_number(poissons_ratio), "choose another law, such as corotated");
    return hooke_from_young_poisson(youngs_modulus, poissons_ratio);
  }

  /// Throws unless the law resists shear and change of volume at rest. Fibres are slack there.
  void check_rest(const std::vector<double>& constants) const {
    for_each_rest_tangent(law_, constants,
                          [this](std::size_t i, const double* A) { check_rest_tangent(A, i); });
  }

  bool has_axes() const {
    return std::ranges::any_of(parts_of(law_),
                               [](const LawPart& part) { return part.law->kind == LawKind::axes; });
  }

  void check_rest_tangent(const double* A, std::size_t i) const {
    if (has_axes()) return check_stiffness(A, i);
    const double mu = A[9 * 1 + 1], bulk_modulus = (A[0] + 2 * A[4]) / 3, least = 1e-14 * std::abs(A[0]);
    if (mu > least && bulk_modulus > least) return;
    throw InputError((place_ + name_of_(i)),
                     "constants of a solid that is stable in the reference configuration",
                     "a small-strain shear modulus of " + format_number(mu) + " Pa and bulk modulus of " +
                         format_number(bulk_modulus) + " Pa",
                     "both must be positive");
  }

  /// The same for a law of no special symmetry.
  void check_stiffness(const double* A, std::size_t i) const {
    constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    Eigen::Matrix<double, 6, 6> C;
    for (int m = 0; m < 6; ++m)
      for (int n = 0; n < 6; ++n)
        C(m, n) = A[9 * (3 * pairs[m][0] + pairs[m][1]) + 3 * pairs[n][0] + pairs[n][1]];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(C, Eigen::EigenvaluesOnly);
    const double least = eigen.eigenvalues()[0], largest = eigen.eigenvalues()[5];
    if (C.allFinite() && least > 1e-14 * largest) return;
    throw InputError((place_ + name_of_(i)),
                     "constants of a solid that is stable in the reference configuration",
                     "a least small-strain stiffness of " + format_number(least) + " Pa",
                     "all must be positive: for each pair of axes n_ij^2 < E_i/E_j");
  }

  const LawInfo& law_;
  const std::map<std::string, Column>& given_;
  const std::string& place_;
  const NameOf& name_of_;
};

}  // namespace

std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, double>& given,
                                      const std::string& place) {
  std::map<std::string, Column> columns;
  for (const auto& [name, value] : given) columns[name] = {&value, 0};
  return resolve_constants(law, columns, 1, place, [](std::size_t) { return std::string(); });
}

std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, Column>& given,
                                      std::size_t count, const std::string& place,
                                      const std::function<std::string(std::size_t)>& name_of) {
  return ConstantReader(law, given, place, name_of).read(count);
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
