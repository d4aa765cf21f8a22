#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.hpp"
#include "material_curve.hpp"
#include "material_options.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/material/curve.hpp"
#include "resilin/material/law.hpp"
#include "resilin/material/reference.hpp"
#include "resilin/scene/material_library.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MaterialsOptions {
  std::string law;
  MaterialOptions material;
  CurveOptions curve;
  bool json = false;
  bool reference = false;
  bool library = false;
};

/// A small picture of a law: nominal stress of a bar pulled with free sides, and of simple shear by
/// stretch - 1 [Pa]; nan where there is no state.
struct Sample {
  std::vector<double> stretch = {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0};
  std::vector<double> uniaxial, shear;

  explicit Sample(const Material& material) {
    uniaxial = stretch_curve(material, LoadCase::uniaxial, stretch).nominal_stress;
    std::vector<double> amounts;
    for (const double value : stretch) amounts.push_back(value - 1);
    shear = stretch_curve(material, LoadCase::shear, amounts).nominal_stress;
  }
};

std::string stress_text(double stress) { return std::isnan(stress) ? "no state" : format_short(stress); }

Json law_json(const LawInfo& law, const MaterialsOptions& options) {
  Json json = {{"name", law.name},
               {"formula", law.formula},
               {"source", law.source},
               {"inversion", law.inversion},
               {"needs_positive_volume_ratio", law.needs_positive_J}};
  const Material material = chosen_material(law, options.material);
  for (std::size_t i = 0; i < law.constants.size(); ++i) {
    const ConstantText& constant = law.constants[i];
    Json entry = {{"name", constant.name}, {"unit", constant.unit}, {"meaning", constant.meaning}};
    if (std::isfinite(constant.above)) entry["above"] = constant.above;
    entry["range"] = range_text(constant);
    entry["example"] = material.constants[i];
    json["constants"].push_back(entry);
  }
  if (options.material.constants.empty()) {
    json["example"] = {{"youngs_modulus", options.material.youngs_modulus},
                       {"poissons_ratio", options.material.poissons_ratio}};
  } else {
    json["example"] = options.material.constants;
  }
  const Sample sample(material);
  for (std::size_t i = 0; i < sample.stretch.size(); ++i) {
    json["curve"].push_back({{"stretch", sample.stretch[i]},
                             {"uniaxial_stress", sample.uniaxial[i]},
                             {"shear_stress", sample.shear[i]}});
  }
  return json;
}

void print_law(const LawInfo& law, const MaterialsOptions& options) {
  const Material material = chosen_material(law, options.material);
  print_line(std::string(law.name));
  print_line("  Psi = " + std::string(law.formula));
  print_line("  source: " + std::string(law.source));
  print_line("  J <= 0: " + std::string(law.inversion));
  print_line("\nConstants, and their values for " + constants_text(law, options.material));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < law.constants.size(); ++i) {
    const ConstantText& constant = law.constants[i];
    rows.push_back({"  " + std::string(constant.name), std::string(constant.meaning), range_text(constant),
                    format_short(material.constants[i])});
  }
  print_text(format_table(rows));
  print_line("\nNominal stress [Pa]: uniaxial tension, and simple shear by (stretch - 1)");
  rows = {{"  stretch", "uniaxial", "shear"}};
  const Sample sample(material);
  for (std::size_t i = 0; i < sample.stretch.size(); ++i) {
    rows.push_back({"  " + format_short(sample.stretch[i]), stress_text(sample.uniaxial[i]),
                    stress_text(sample.shear[i])});
  }
  print_text(format_table(rows));
}

void print_catalogue() {
  std::vector<std::vector<std::string>> rows = {{"law", "constants", "Psi"}};
  for (const LawInfo* law : laws()) {
    std::string constants;
    for (const ConstantText& constant : law->constants)
      constants += (constants.empty() ? "" : ", ") + std::string(constant.name);
    rows.push_back({std::string(law->name), constants, std::string(law->formula)});
  }
  print_text(format_table(rows));
  print_line(
      "\nEvery law also takes youngs_modulus and poissons_ratio (at small strain); see resilin materials "
      "LAW.");
}

/// Options that mean nothing without another.
void check_options(const MaterialsOptions& options) {
  const CurveOptions& curve = options.curve;
  if (options.law.empty() && !(curve.load_case.empty() && options.material.constants.empty())) {
    throw InputError("materials", "the name of a law with --curve or --set", "none",
                     "resilin materials lists them");
  }
  if (curve.load_case.empty() && (curve.from || curve.to || !curve.csv.empty())) {
    throw InputError("materials", "--curve with --from, --to or --csv", "none",
                     "for example --curve uniaxial");
  }
}

Json library_json(const LibraryMaterial& material) {
  Json json = {{"name", material.name},       {"about", material.about},
               {"law", material.law},         {"constants", material.constants},
               {"density", material.density}, {"youngs_modulus", material.youngs_modulus},
               {"range", material.range},     {"source", material.source}};
  if (!material.g.empty()) json["viscoelastic"] = {{"g", material.g}, {"tau", material.tau}};
  return json;
}

void print_library_material(const LibraryMaterial& material) {
  print_line(material.name + ": " + material.about);
  std::string constants;
  for (const auto& [name, value] : material.constants)
    constants += (constants.empty() ? "" : ", ") + name + " = " + format_short(value);
  print_line("  " + material.law + ": " + constants);
  print_line("  E at small strain " + format_short(material.youngs_modulus) + " Pa, density " +
             format_short(material.density) + " kg/m^3");
  for (std::size_t i = 0; i < material.g.size(); ++i)
    print_line("  relaxes by " + format_short(material.g[i]) + " in " + format_short(material.tau[i]) + " s");
  print_line("  valid for " + material.range);
  print_line("  source: " + material.source + "\n");
}

void print_library(bool as_json) {
  Json all = Json::array();
  for (const LibraryMaterial& material : material_library())
    as_json ? all.push_back(library_json(material)) : print_library_material(material);
  if (as_json) return print_line(all.dump(1));
  print_line("In a scene: material = { library = \"" + material_library().front().name + "\" }");
}

int materials(const MaterialsOptions& options) {
  check_options(options);
  if (options.library) {
    if (!options.law.empty())
      throw InputError("materials", "--library without a law", '"' + options.law + '"',
                       "resilin materials " + options.law + " describes the law");
    print_library(options.json);
    return done;
  }
  if (options.reference) {
    print_text(law_reference());
    return done;
  }
  if (!options.law.empty()) {
    const LawInfo& law = require_law(options.law, "materials");
    if (!options.curve.load_case.empty()) {
      print_curve(chosen_material(law, options.material), options.curve, options.json);
    } else if (options.json) {
      print_line(law_json(law, options).dump(1));
    } else {
      print_law(law, options);
    }
  } else if (options.json) {
    Json all = Json::array();
    for (const LawInfo* law : laws()) all.push_back(law_json(*law, options));
    print_line(all.dump(1));
  } else {
    print_catalogue();
  }
  return done;
}

std::array<Option, 2> add_material_options(const Command& command, MaterialOptions& options) {
  command.option("--set", options.constants, "A constant of the law; repeatable")
      .type_name("NAME=VALUE")
      .repeatable();
  command.option("--fibre", options.fibres, "Direction of a fibre family; up to two; default along x")
      .type_name("X Y Z")
      .values(3, 6)
      .joins_repeats();
  return {command.option("--youngs-modulus", options.youngs_modulus, "Young's modulus at small strain [Pa]")
              .shows_default(),
          command.option("--poissons-ratio", options.poissons_ratio, "Poisson's ratio at small strain")
              .shows_default()};
}

void add_curve_options(const Command& command, CurveOptions& options) {
  command.option("--curve", options.load_case, "Stress-stretch curve, traction-free directions solved")
      .type_name(join(load_case_words(), "|"))
      .group("Curve")
      .offers(load_case_words);
  command.option("--from", options.from, "First stretch; default 0.5 (amount of shear: 0)").group("Curve");
  command.option("--to", options.to, "Last stretch; default 2 (amount of shear: 1.5)").group("Curve");
  command.option("--points", options.points, "Number of points")
      .shows_default()
      .between(2, 1000000)
      .group("Curve");
  command.option("--csv", options.csv, "Write the curve to this file as well")
      .is_file({"csv"})
      .group("Curve");
}

}  // namespace

void add_materials(CommandLine& line, Action& action) {
  auto options = std::make_shared<MaterialsOptions>();
  const Command command = line.command(
      "materials",
      "List the constitutive models (laws), or describe one: constants, formula, source, curves");
  command.option("law", options->law, "Name of a constitutive model (law)").offers(law_words);
  const std::array<Option, 2> hooke = add_material_options(command, options->material);
  add_curve_options(command, options->curve);
  command.flag("--library", options->library, "List the materials that have names, with their sources");
  command.flag("--json", options->json, "Print JSON");
  command.flag("--reference", options->reference, "Print the page docs/laws.md");
  command.footer(
      "Examples:\n  resilin materials stable_neo_hookean --youngs-modulus 1e5 --poissons-ratio 0.45\n"
      "  resilin materials neo_hookean --curve uniaxial --from 0.5 --to 3 --csv curve.csv");
  command.on_chosen([options, hooke, &action] {
    for (const Option& option : hooke) options->material.gives_hooke |= option.is_given();
    action = [options] { return materials(*options); };
  });
}

}  // namespace resilin::cli
