#include "material_options.hpp"

#include <charconv>
#include <cmath>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

/// Reads "NAME=VALUE".
std::pair<std::string, double> read_constant(const std::string& text) {
  const std::size_t equals = text.find('=');
  double value = 0;
  if (equals != std::string::npos && equals > 0) {
    const char *begin = text.data() + equals + 1, *end = text.data() + text.size();
    const auto [last, error] = std::from_chars(begin, end, value);
    if (error == std::errc() && last == end) return {text.substr(0, equals), value};
  }
  throw InputError("--set", "NAME=VALUE with a number", "\"" + text + "\"",
                   "for example --set shear_modulus=2e5");
}

/// Poisson's ratio of the example: the law's own where it can have no other.
double example_poissons_ratio(const LawInfo& law, double poissons_ratio) {
  return std::isnan(law.only_poissons_ratio) ? poissons_ratio : law.only_poissons_ratio;
}

void set_fibres(Material& material, const std::vector<double>& numbers) {
  const auto most = static_cast<std::size_t>(material.law->max_fibres), count = numbers.size() / 3;
  if (numbers.size() % 3 != 0) {
    throw InputError("--fibre", "three numbers for each family", std::to_string(numbers.size()));
  }
  if (count > most) {
    throw InputError("--fibre",
                     most == 0 ? "none: this law has no fibres" : std::to_string(most) + " at most",
                     std::to_string(count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 direction(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
    if (!(direction.norm() > 0 && std::isfinite(direction.norm()))) {
      throw InputError("--fibre", "a direction of finite length above 0", "one that has none");
    }
    material.fibres.push_back(direction.normalized());
  }
  if (most > 0 && count == 0) material.fibres = {Vector3::UnitX()};
}

/// Whether these constants stand beside Young's modulus and Poisson's ratio, not instead of them.
bool join_hooke(const LawInfo& law, const std::map<std::string, double>& given) {
  for (const ConstantText& constant : law.constants) {
    if (given.count(std::string(constant.name)) != 0 && !constant.is_free) return false;
  }
  return true;
}

}  // namespace

Material chosen_material(const LawInfo& law, const MaterialOptions& options) {
  Material material{};
  material.law = &law;
  set_fibres(material, options.fibres);
  std::map<std::string, double> given;
  for (const std::string& text : options.constants) {
    const auto [name, value] = read_constant(text);
    given.insert_or_assign(name, value);
  }
  const double ratio =
      options.gives_hooke ? options.poissons_ratio : example_poissons_ratio(law, options.poissons_ratio);
  if (options.gives_hooke || (!given.empty() && join_hooke(law, given))) {
    given.try_emplace("youngs_modulus", options.youngs_modulus);
    given.try_emplace("poissons_ratio", ratio);
  }
  material.constants = given.empty()
                           ? law.constants_from(hooke_from_young_poisson(options.youngs_modulus, ratio))
                           : resolve_constants(law, given, std::string(law.name));
  return material;
}

std::string constants_text(const LawInfo& law, const MaterialOptions& options) {
  std::vector<std::string> words;
  if (options.gives_hooke || options.constants.empty()) {
    const double ratio =
        options.gives_hooke ? options.poissons_ratio : example_poissons_ratio(law, options.poissons_ratio);
    words = {"E = " + format_short(options.youngs_modulus) + " Pa", "nu = " + format_short(ratio)};
  }
  words.insert(words.end(), options.constants.begin(), options.constants.end());
  return join(words);
}

}  // namespace resilin::cli
