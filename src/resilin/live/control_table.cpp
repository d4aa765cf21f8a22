#include "resilin/live/control_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

std::vector<Option> laws_to_choose() {
  std::vector<Option> options;
  for (const LawInfo* law : live_laws()) options.push_back({law->name, law->title});
  return options;
}

void check_law(const std::string& name) { require_law(name, "law"); }

constexpr std::array table = {
    LiveControl{"law", "Material", "Constitutive model", "", "Strain energy density of the body",
                Choice{&LiveControls::law, laws_to_choose, check_law},
                /*is_of_contact=*/false, /*is_of_body=*/true},
    LiveControl{"youngs_modulus", "Material", "Young's modulus", "Pa", "Stiffness at small strain",
                LogSlider{&LiveControls::youngs_modulus, {1, 1e12}, {1e2, 1e8}}, /*is_of_contact=*/false,
                /*is_of_body=*/true},
    LiveControl{"poissons_ratio", "Material", "Poisson's ratio", "",
                "Lateral contraction over axial stretch; near 0.5 the body is incompressible",
                Slider{&LiveControls::poissons_ratio, {-0.9, 0.4999}, {0, 0.495}, 0.005},
                /*is_of_contact=*/false, /*is_of_body=*/true},
    LiveControl{"damping", "Material", "Damping", "1/s", "Mass-proportional damping of all bodies",
                Slider{&LiveControls::damping, {0, 1e4}, {0, 10}, 0.01}},
    LiveControl{"gravity", "World", "Gravity", "m/s^2", "Gravitational acceleration",
                Arrow{&LiveControls::gravity, 1e5, 30, 0.01}},
    LiveControl{"ground", "World", "Ground", "", "Rigid ground plane",
                Switch{&LiveControls::has_ground, "g"}},
    LiveControl{"ground_height", "World", "Ground height", "m", "Height of the ground, against gravity",
                Slider{&LiveControls::ground_height, {-1e12, 1e12}, {-2, 2}, 0.01, /*is_in_extents=*/true}},
    LiveControl{"ground_friction", "World", "Ground friction", "",
                "Coulomb friction coefficient of the ground",
                Slider{&LiveControls::ground_friction, {0, 10}, {0, 1.5}, 0.01}},
    LiveControl{"contact_friction", "Contact", "Friction", "", "Coulomb friction coefficient between bodies",
                Slider{&LiveControls::contact_friction, {0, 10}, {0, 1.5}, 0.01}, /*is_of_contact=*/true},
    LiveControl{"contact_stiffness", "Contact", "Stiffness", "Pa",
                "Barrier stiffness: a softer barrier solves faster and gives smaller gaps",
                LogSlider{&LiveControls::contact_stiffness, {1e-3, 1e15}, {1e2, 1e8}},
                /*is_of_contact=*/true},
    LiveControl{
        "contact_distance", "Contact", "Distance", "m", "Activation distance of contact (dhat)",
        LogSlider{&LiveControls::contact_distance, {1e-12, 1e12}, {1e-4, 1e-1}, /*is_in_extents=*/true},
        /*is_of_contact=*/true},
    LiveControl{"speed", "Time", "Speed", "", "Simulated time over real time",
                LogSlider{&LiveControls::speed, {0.01, 10}, {0.01, 1}}},
    LiveControl{"time_step", "Time", "Time step", "s", "Shorter steps have less numerical damping",
                LogSlider{&LiveControls::time_step, {1e-5, 1}, {1e-4, 0.1}}},
    LiveControl{"newton_limit", "Time", "Newton limit", "",
                "Limit of Newton iterations per step; no limit: as many as the time allows",
                WholeSlider{&LiveControls::newton_limit, {0, 1000}, {0, 50}, "no limit"}},
    LiveControl{"tolerance", "Time", "Tolerance", "",
                "Convergence tolerance: force residual relative to the load",
                LogSlider{&LiveControls::tolerance, {1e-12, 0.5}, {1e-8, 1e-1}}},
    LiveControl{"max_force", "Tools", "Maximum hand force", "N", "Largest force of the hand",
                LogSlider{&LiveControls::max_force, {1e-12, 1e15}, {1e-2, 1e5}}},
};

[[noreturn]] void refuse(const LiveControl& control, const std::string& expected, double got) {
  throw InputError(std::string(control.key), expected, format_number(got));
}

/// "0.5 1/s".
std::string with_unit(double number, const LiveControl& control) {
  std::string text = format_number(number);
  if (!control.unit.empty()) text.append(" ").append(control.unit);
  return text;
}

void check_number(const LiveControl& control, const Interval& allowed, double value) {
  if (value >= allowed.least && value <= allowed.greatest) return;
  refuse(control,
         "a number from " + with_unit(allowed.least, control) + " to " + with_unit(allowed.greatest, control),
         value);
}

void check(const LiveControl& control, const ControlValue& value) {
  std::visit(Overloaded{
                 [&](const Slider& form) { check_number(control, form.allowed, std::get<double>(value)); },
                 [&](const LogSlider& form) { check_number(control, form.allowed, std::get<double>(value)); },
                 [&](const WholeSlider& form) {
                   const double number = std::get<double>(value);
                   const auto& [least, greatest] = form.allowed;
                   if (number >= least && number <= greatest && number == std::floor(number)) return;
                   refuse(control,
                          "a whole number from " + format_number(least) + " to " + format_number(greatest),
                          number);
                 },
                 [](const Switch&) {},
                 [&](const Choice& form) { form.check(std::get<std::string>(value)); },
                 [&](const Arrow& form) {
                   const auto& vector = std::get<Vector3>(value);
                   if (vector.allFinite() && vector.norm() <= form.longest_allowed) return;
                   refuse(control, "finite numbers of at most " + with_unit(form.longest_allowed, control),
                          vector.norm());
                 },
             },
             control.form);
}

}  // namespace

std::span<const LiveControl> live_control_table() { return table; }

const LiveControl* find_live_control(std::string_view key) {
  const auto found = std::ranges::find(table, key, &LiveControl::key);
  return found == table.end() ? nullptr : &*found;
}

ControlValue value_of(const LiveControl& control, const LiveControls& controls) {
  return std::visit(
      [&controls]<class Form>(const Form& form) -> ControlValue {
        return static_cast<typename Form::Value>(controls.*form.value);
      },
      control.form);
}

void set_value(const LiveControl& control, const ControlValue& value, LiveControls& controls) {
  check(control, value);
  std::visit(
      [&]<class Form>(const Form& form) {
        auto& place = controls.*form.value;
        place = static_cast<std::remove_cvref_t<decltype(place)>>(std::get<typename Form::Value>(value));
      },
      control.form);
}

void check_controls(const LiveControls& controls) {
  for (const LiveControl& control : table) check(control, value_of(control, controls));
}

LogSlider in_scene(const LogSlider& slider, double extent) {
  if (!slider.is_in_extents) return slider;
  LogSlider scaled = slider;
  for (double* end : {&scaled.shown.least, &scaled.shown.greatest})
    *end = std::pow(10, std::round(std::log10(*end * extent)));
  return scaled;
}

Slider in_scene(const Slider& slider, double extent) {
  if (!slider.is_in_extents) return slider;
  Slider scaled = slider;
  scaled.step = std::pow(10, std::floor(std::log10(slider.step * extent)));
  constexpr double rounding = 1e-9;
  scaled.shown.least = scaled.step * std::floor(slider.shown.least * extent / scaled.step + rounding);
  scaled.shown.greatest = scaled.step * std::ceil(slider.shown.greatest * extent / scaled.step - rounding);
  return scaled;
}

}  // namespace resilin
