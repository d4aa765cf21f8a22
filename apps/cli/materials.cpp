#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.hpp"
#include "resilin/material/derive.hpp"
#include "resilin/material/law.hpp"
#include "resilin/material/reference.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MaterialsOptions {
  std::string law;
  double youngs_modulus = 1e6;
  double poissons_ratio = 0.3;
  bool json = false;
  bool reference = false;
};

Material example(const LawInfo& law, const MaterialsOptions& options) {
  return {&law,
          resolve_constants(
              law, {{"youngs_modulus", options.youngs_modulus}, {"poissons_ratio", options.poissons_ratio}},
              std::string(law.name)),
          {}};
}

/// A point of a curve: the stretch and the nominal stress that holds it [Pa].
struct CurvePoint {
  double stretch;
  double uniaxial;  ///< sides free of stress
  double shear;     ///< simple shear by stretch - 1: P_xy
};

/// Lateral stretch at which the sides of a pulled bar are free of stress, by bisection; nan when there is
/// none.
double free_lateral_stretch(const Material& material, double stretch) {
  const auto side_stress = [&](double lateral) {
    return first_piola_kirchhoff_stress<3>(material, Vector3(stretch, lateral, lateral).asDiagonal())(1, 1);
  };
  if (side_stress(1) == 0) return 1;
  double low = 1e-3, high = 10;
  if (!(side_stress(low) < 0 && side_stress(high) > 0)) return std::nan("");
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (side_stress(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::vector<CurvePoint> curve(const Material& material) {
  std::vector<CurvePoint> points;
  for (const double stretch : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0}) {
    const double lateral = free_lateral_stretch(material, stretch);
    const Matrix<3> pulled = Vector3(stretch, lateral, lateral).asDiagonal();
    Matrix<3> sheared = Matrix<3>::Identity();
    sheared(0, 1) = stretch - 1;
    points.push_back({stretch, first_piola_kirchhoff_stress<3>(material, pulled)(0, 0),
                      first_piola_kirchhoff_stress<3>(material, sheared)(0, 1)});
  }
  return points;
}

Json law_json(const LawInfo& law, const MaterialsOptions& options) {
  Json json = {{"name", law.name},
               {"formula", law.formula},
               {"source", law.source},
               {"inversion", law.inversion},
               {"needs_positive_volume_ratio", law.needs_positive_J}};
  const Material material = example(law, options);
  for (std::size_t i = 0; i < law.constants.size(); ++i) {
    const ConstantText& constant = law.constants[i];
    Json entry = {{"name", constant.name}, {"unit", constant.unit}, {"meaning", constant.meaning}};
    if (std::isfinite(constant.above)) entry["above"] = constant.above;
    entry["example"] = material.constants[i];
    json["constants"].push_back(entry);
  }
  json["example"] = {{"youngs_modulus", options.youngs_modulus}, {"poissons_ratio", options.poissons_ratio}};
  for (const CurvePoint& point : curve(material)) {
    json["curve"].push_back(
        {{"stretch", point.stretch}, {"uniaxial_stress", point.uniaxial}, {"shear_stress", point.shear}});
  }
  return json;
}

void print_law(const LawInfo& law, const MaterialsOptions& options) {
  const Material material = example(law, options);
  print_line(std::string(law.name));
  print_line("  Psi = " + std::string(law.formula));
  print_line("  source: " + std::string(law.source));
  print_line("  J <= 0: " + std::string(law.inversion));
  print_line("\nConstants, and their values for E = " + format_short(options.youngs_modulus) +
             " Pa, nu = " + format_short(options.poissons_ratio));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < law.constants.size(); ++i) {
    const ConstantText& constant = law.constants[i];
    const std::string bound = std::isfinite(constant.above) ? "> " + format_short(constant.above) : "any";
    rows.push_back({"  " + std::string(constant.name), std::string(constant.meaning),
                    std::string(constant.unit), bound, format_short(material.constants[i])});
  }
  print_text(format_table(rows));
  print_line("\nNominal stress [Pa]: a bar pulled with free sides, and simple shear by (stretch - 1)");
  rows = {{"  stretch", "pulled", "sheared"}};
  for (const CurvePoint& point : curve(material)) {
    rows.push_back(
        {"  " + format_short(point.stretch), format_short(point.uniaxial), format_short(point.shear)});
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
      "\nEvery law takes youngs_modulus and poissons_ratio (of small strains) instead; resilin materials LAW "
      "tells more.");
}

int materials(const MaterialsOptions& options) {
  if (options.reference) {
    print_text(law_reference());
    return done;
  }
  if (!options.law.empty()) {
    const LawInfo& law = require_law(options.law, "materials");
    if (options.json) {
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

}  // namespace

void add_materials(CLI::App& app, Action& action) {
  auto options = std::make_shared<MaterialsOptions>();
  CLI::App* command =
      app.add_subcommand("materials", "List the laws; for one: constants, formula, source, curves");
  command->add_option("law", options->law, "Name of a law");
  command->add_option("--youngs-modulus", options->youngs_modulus, "Of the example [Pa]")
      ->capture_default_str();
  command->add_option("--poissons-ratio", options->poissons_ratio, "Of the example")->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--reference", options->reference, "Print the page docs/laws.md");
  command->footer(
      "Example:\n  resilin materials stable_neo_hookean --youngs-modulus 1e5 --poissons-ratio 0.45");
  command->callback([options, &action] { action = [options] { return materials(*options); }; });
}

}  // namespace resilin::cli
