#include "material_curve.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/material/curve.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string description(LoadCase load_case) {
  switch (load_case) {
    case LoadCase::uniaxial:
      return "a bar stretched along x, its sides traction-free";
    case LoadCase::equibiaxial:
      return "a sheet stretched equally along x and y, its faces traction-free";
    case LoadCase::planar:
      return "a sheet stretched along x, constrained along z, traction-free along y";
    case LoadCase::shear:
      return "simple shear along x, all other components of F fixed";
    case LoadCase::volumetric:
      return "every edge stretched equally";
  }
  return {};
}

/// Evenly spaced from the first to the last.
std::vector<double> chosen_stretches(LoadCase load_case, const CurveOptions& options) {
  const bool is_shear = load_case == LoadCase::shear;
  const LoadRange usual = usual_range(load_case);
  const double from = options.from.value_or(usual.from), to = options.to.value_or(usual.to);
  const std::string expected = is_shear ? "a finite amount of shear" : "a stretch above 0";
  for (const auto& [option, value] : {std::pair("--from", from), std::pair("--to", to)}) {
    if (!std::isfinite(value) || (!is_shear && value <= 0)) {
      throw InputError(option, expected, format_number(value));
    }
  }
  if (!(from < to))
    throw InputError("--from", "a number below --to, " + format_number(to), format_number(from));
  std::vector<double> stretches;
  const double last = options.points - 1;
  for (int i = 0; i < options.points; ++i) stretches.push_back((from * (last - i) + to * i) / last);
  stretches.front() = from;
  stretches.back() = to;
  return stretches;
}

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::vector<std::string> row(const StretchCurve& curve, std::size_t i) {
  const Stability stability = curve.stability[i];
  if (stability == Stability::no_state) return {"  " + number(curve.stretch[i]), "no state"};
  std::vector<std::string> cells = {"  " + number(curve.stretch[i]), number(curve.nominal_stress[i]),
                                    number(curve.cauchy_stress[i]), number(curve.volume_ratio[i]),
                                    number(curve.energy_density[i])};
  if (stability != Stability::stable) cells.push_back("unstable: " + std::string(name(stability)));
  return cells;
}

void print_table(const Material& material, const StretchCurve& curve) {
  print_line(std::string(material.law->name) + ", " + std::string(name(curve.load_case)) + ": " +
             description(curve.load_case));
  std::string constants;
  for (std::size_t i = 0; i < material.constants.size(); ++i) {
    const ConstantText& constant = material.law->constants[i];
    constants += (i == 0 ? "  " : ", ") + std::string(constant.name) + " = " +
                 format_short(material.constants[i]) + (constant.unit.empty() ? "" : " ") +
                 std::string(constant.unit);
  }
  print_line(constants + "\n");
  std::vector<std::vector<std::string>> rows = {{curve.load_case == LoadCase::shear ? "  shear" : "  stretch",
                                                 "nominal stress [Pa]", "Cauchy stress [Pa]", "volume ratio",
                                                 "energy density [J/m^3]"}};
  for (std::size_t i = 0; i < curve.stretch.size(); ++i) rows.push_back(row(curve, i));
  print_text(format_table(rows));
}

/// nan becomes null.
Json curve_json(const Material& material, const StretchCurve& curve) {
  Json json = {{"law", material.law->name}, {"load_case", name(curve.load_case)}};
  for (std::size_t i = 0; i < material.constants.size(); ++i) {
    json["constants"][std::string(material.law->constants[i].name)] = material.constants[i];
  }
  json["units"] = {{"nominal_stress", "Pa"}, {"cauchy_stress", "Pa"}, {"energy_density", "J/m^3"}};
  json["points"] = Json::array();
  for (std::size_t i = 0; i < curve.stretch.size(); ++i) {
    const Vector3& stretches = curve.stretches[i];
    json["points"].push_back({{"stretch", curve.stretch[i]},
                              {"nominal_stress", curve.nominal_stress[i]},
                              {"cauchy_stress", curve.cauchy_stress[i]},
                              {"volume_ratio", curve.volume_ratio[i]},
                              {"energy_density", curve.energy_density[i]},
                              {"stretches", {stretches[0], stretches[1], stretches[2]}},
                              {"stability", name(curve.stability[i])}});
  }
  json["limits"] = Json::array();
  for (const StabilityLimit& limit : curve.limits) {
    json["limits"].push_back({{"loss", name(limit.loss)},
                              {"side", limit.above ? "above" : "below"},
                              {"stretch", limit.stretch},
                              {"volume_ratio", limit.volume_ratio}});
  }
  return json;
}

}  // namespace

void print_curve(const Material& material, const CurveOptions& options, bool json) {
  const LoadCase load_case = require_load_case(options.load_case, "--curve");
  const StretchCurve curve = stretch_curve(material, load_case, chosen_stretches(load_case, options));
  if (!options.csv.empty()) {
    write_atomically(options.csv, [&curve](std::ostream& out) { out << curve_csv(curve); });
  }
  if (json) {
    print_line(curve_json(material, curve).dump(1));
  } else {
    print_table(material, curve);
  }
  if (const std::string text = stability_text(material, curve); !text.empty()) print_warnings({text});
}

}  // namespace resilin::cli
