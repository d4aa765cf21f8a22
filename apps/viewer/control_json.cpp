#include "control_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "resilin/core/overloaded.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

Json value_json(const LiveControl& control, const LiveControls& controls) {
  return std::visit(Overloaded{
                        [](const Vector3& v) -> Json { return {v.x(), v.y(), v.z()}; },
                        [](const auto& plain) -> Json { return plain; },
                    },
                    value_of(control, controls));
}

/// Description of a form for the page, beside the value.
Json form_json(const LiveControl& control, const LiveControls& initial, double extent) {
  return std::visit(
      Overloaded{
          [&](const Slider& form) -> Json {
            const Slider slider = in_scene(form, extent);
            return {{"kind", "slider"},
                    {"least", slider.shown.least},
                    {"greatest", slider.shown.greatest},
                    {"step", slider.step}};
          },
          [&](const LogSlider& form) -> Json {
            const LogSlider slider = in_scene(form, extent);
            return {
                {"kind", "log_slider"}, {"least", slider.shown.least}, {"greatest", slider.shown.greatest}};
          },
          [](const WholeSlider& form) -> Json {
            Json json = {{"kind", "slider"},
                         {"least", form.shown.least},
                         {"greatest", form.shown.greatest},
                         {"step", 1}};
            if (!form.zero.empty()) json["zero"] = form.zero;
            return json;
          },
          [](const Switch& form) -> Json { return {{"kind", "switch"}, {"hotkey", form.hotkey}}; },
          [](const Choice& form) -> Json {
            Json options = Json::array();
            for (const Option& option : form.options())
              options.push_back({{"name", option.name}, {"label", option.label}});
            return {{"kind", "choice"}, {"options", std::move(options)}};
          },
          [&](const Arrow& form) -> Json {
            return {{"kind", "arrow"},
                    {"greatest", form.longest_shown},
                    {"step", form.step},
                    {"initial", value_json(control, initial)}};
          },
      },
      control.form);
}

}  // namespace

Json control_entries(const LiveControls& initial, double extent, bool has_contact) {
  Json entries = Json::array();
  for (const LiveControl& control : live_control_table()) {
    if (control.is_of_contact && !has_contact) continue;
    Json entry = form_json(control, initial, extent);
    entry["key"] = control.key;
    entry["folder"] = control.folder;
    entry["label"] = control.label;
    entry["unit"] = control.unit;
    entry["help"] = control.help;
    if (control.is_of_body) entry["of_body"] = true;
    entries.push_back(std::move(entry));
  }
  return entries;
}

Json drive_entries(std::span<const Drive> drives) {
  Json entries = Json::array();
  for (const Drive& drive : drives) {
    const std::string quantity(drive.quantity());
    constexpr double steps = 200;
    const double step = std::pow(10, std::floor(std::log10((drive.greatest - drive.least) / steps)));
    entries.push_back({{"kind", "slider"},
                       {"key", drive.key},
                       {"folder", "Motors and cables"},
                       {"label", drive.name + ", " + quantity},
                       {"unit", drive.unit()},
                       {"help", (drive.is_of_cable() ? "Cable \"" : "Motor of the joint \"") + drive.name +
                                    "\": " + quantity + " in place of the scene's time function"},
                       {"least", drive.least},
                       {"greatest", drive.greatest},
                       {"step", step}});
  }
  return entries;
}

Json drive_values(std::span<const Drive> drives) {
  Json values = Json::object();
  for (const Drive& drive : drives) values[drive.key] = drive.is_driven ? drive.goal : drive.value;
  return values;
}

Json body_values(const LiveControls& controls) {
  Json values;
  for (const LiveControl& control : live_control_table())
    if (control.is_of_body) values[std::string(control.key)] = value_json(control, controls);
  return values;
}

Json control_values(const LiveControls& controls, bool has_contact) {
  Json values;
  for (const LiveControl& control : live_control_table())
    if (has_contact || !control.is_of_contact)
      values[std::string(control.key)] = value_json(control, controls);
  return values;
}

}  // namespace resilin::viewer
