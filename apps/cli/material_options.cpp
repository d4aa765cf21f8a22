#include "material_options.hpp"

#include <charconv>
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

}  // namespace

Material chosen_material(const LawInfo& law, const MaterialOptions& options) {
  Material material{};
  material.law = &law;
  std::map<std::string, double> given;
  for (const std::string& text : options.constants) {
    const auto [name, value] = read_constant(text);
    given.insert_or_assign(name, value);
  }
  if (options.gives_hooke) {
    given.try_emplace("youngs_modulus", options.youngs_modulus);
    given.try_emplace("poissons_ratio", options.poissons_ratio);
  }
  material.constants =
      given.empty()
          ? law.constants_from(hooke_from_young_poisson(options.youngs_modulus, options.poissons_ratio))
          : resolve_constants(law, given, std::string(law.name));
  return material;
}

std::string constants_text(const MaterialOptions& options) {
  std::vector<std::string> words;
  if (options.gives_hooke || options.constants.empty()) {
    words = {"E = " + format_short(options.youngs_modulus) + " Pa",
             "nu = " + format_short(options.poissons_ratio)};
  }
  words.insert(words.end(), options.constants.begin(), options.constants.end());
  return join(words);
}

}  // namespace resilin::cli
