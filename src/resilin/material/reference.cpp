#include "resilin/material/reference.hpp"

#include <cmath>
#include <initializer_list>
#include <string_view>

#include "resilin/core/text.hpp"
#include "resilin/material/law.hpp"

namespace resilin {
namespace {

/// "4/3" for 1.3333...; decimals for what is no small fraction.
std::string fraction(double value) {
  for (int denominator = 1; denominator <= 24; ++denominator) {
    const double numerator = std::round(value * denominator);
    if (std::abs(numerator - value * denominator) > 1e-12 * denominator) continue;
    std::string text = format_number(numerator);
    if (denominator > 1) text.append("/").append(std::to_string(denominator));
    return text;
  }
  return format_number(value);
}

void add_term(std::string& sum, double factor, const std::string& symbol) {
  if (factor == 0) return;
  if (!sum.empty()) sum += factor < 0 ? " - " : " + ";
  if (sum.empty() && factor < 0) sum += "-";
  if (std::abs(factor) != 1) sum.append(fraction(std::abs(factor))).append(" ");
  sum += symbol;
}

/// "E" or "nu" for a constant that is Young's modulus or Poisson's ratio; empty for others.
std::string engineering_name(const LawInfo& law, std::size_t constant) {
  const Hooke hooke{.mu = 2, .lambda = 3};
  if (!std::isnan(law.only_poissons_ratio)) return {};
  const double value = law.constants_from(hooke)[constant];
  if (value == hooke.youngs_modulus()) return "E";
  return value == hooke.poissons_ratio() ? "nu" : "";
}

/// How a constant follows from Hooke's mu and lambda. Conversions are linear, so two samples tell all of it.
std::string conversion(const LawInfo& law, std::size_t constant) {
  std::string sum;
  add_term(sum, law.constants_from({.mu = 0, .lambda = 1})[constant], "lambda_H");
  add_term(sum, law.constants_from({.mu = 1, .lambda = 0})[constant], "mu_H");
  return sum.empty() ? "0" : sum;
}

/// Value of a constant when E and nu are given; exponents and the like do not depend on them.
std::string from_hooke(const LawInfo& law, std::size_t i) {
  const ConstantText& constant = law.constants[i];
  if (constant.is_free)
    return std::isnan(constant.fallback) ? "given beside"
                                         : "given beside, or " + format_number(constant.fallback);
  if (const std::string name = engineering_name(law, i); !name.empty()) return name;
  const double at_rest = law.constants_from({.mu = 1, .lambda = 0})[i];
  if (constant.unit.empty()) return format_number(at_rest);
  return conversion(law, i);
}

/// Value of a constant that is left out when the constants of the formula are given.
std::string left_out(const ConstantText& constant) {
  return std::isnan(constant.fallback) ? "" : format_number(constant.fallback);
}

std::string families(int most) {
  return most == 1 ? "one family" : "1 to " + std::to_string(most) + " families";
}

void append(std::string& text, std::initializer_list<std::string_view> parts) {
  for (const std::string_view part : parts) text += part;
}

std::string section(const LawInfo& law) {
  std::string text;
  append(text, {"## `", law.name, "`\n\n    Psi = ", law.formula, "\n\n"});
  append(text, {"| constant | in the formula | unit | a | from (E, nu) | left out |\n"
                "| --- | --- | --- | --- | --- | --- |\n"});
  for (std::size_t i = 0; i < law.constants.size(); ++i) {
    const ConstantText& constant = law.constants[i];
    append(text, {"| `", constant.name, "` | ", constant.meaning, " | ", constant.unit, " | ",
                  range_text(constant), " | ", from_hooke(law, i), " | ", left_out(constant), " |\n"});
  }
  if (!std::isnan(law.only_poissons_ratio))
    append(text, {"\nIts Poisson's ratio is ", format_number(law.only_poissons_ratio), ".\n"});
  if (law.kind == LawKind::axes)
    append(text, {law.max_fibres == 1
                      ? "\nNeeds its axis as `fibres`"
                      : "\nNeeds its first two axes as `fibres`; the second is made perpendicular to the "
                        "first, and may be left out in the plane",
                  ", in the reference configuration.\n"});
  else if (law.max_fibres > 0)
    append(text, {"\nNeeds ", families(law.max_fibres),
                  " of `fibres`, unit vectors of the reference configuration. (E, nu) are those of the "
                  "matrix, without "
                  "fibres.\n"});
  append(text, {"\nSource: ", law.source, ".  \nJ <= 0: ", law.inversion});
  if (!law.end_of_domain.empty()) append(text, {", and where ", law.end_of_domain});
  append(text, {".\n\n"});
  return text;
}

}  // namespace

std::string law_reference() {
  std::string page =
      "# Laws\n\n"
      "Made by `resilin materials --reference` from the catalogue (`src/resilin/material/catalog.hpp`).\n\n"
      "A material is given in one of two ways:\n\n"
      "- `youngs_modulus` [Pa] and `poissons_ratio` (above -1, below 0.5) always describe the small-strain "
      "response: every law converts them to its own constants, so a slightly strained bar has these E and "
      "nu.\n"
      "- The constants of the formula, by name, used unchanged. The last column says which may be left "
      "out.\n\n"
      "Constants that E and nu do not determine are given beside them. Constants that are unstable in the "
      "reference configuration are refused.\n\n"
      "In 2D the state is plane strain: F = diag(F_2, 1) in the same formula. Psi is the strain energy per "
      "reference volume "
      "[J/m^3], zero in the reference configuration; F = dx/dX, J = det F, C = F^T F, I_C = tr C, II_C = "
      "|cof F|^2, s_i are the "
      "signed "
      "singular values of F and R is its rotation. mu_H = E / (2 (1 + nu)) and "
      "lambda_H = E nu / "
      "((1 + nu) (1 - 2 nu)) are Hooke's constants.\n\n";
  for (const LawInfo* law : laws()) page += section(*law);
  page += "How to add a law: [extending.md](extending.md).\n";
  return page;
}

}  // namespace resilin
