#include "resilin/live/control_table.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <tuple>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

LiveControls sample_controls() {
  LiveControls controls;
  controls.law = "neo_hookean";
  controls.max_force = 10;
  controls.speed = 0.5;
  return controls;
}

std::string refusal(const LiveControl& control, const ControlValue& value) {
  LiveControls controls = sample_controls();
  try {
    set_value(control, value, controls);
  } catch (const InputError& error) {
    EXPECT_EQ(value_of(control, controls), value_of(control, sample_controls())) << control.key;
    return error.what();
  }
  return {};
}

/// Another value than that of the sample.
ControlValue other_value(const LiveControl& control) {
  return std::visit(
      Overloaded{
          [](const Switch&) -> ControlValue { return true; },
          [](const Choice& form) -> ControlValue { return std::string(form.options().front().name); },
          [](const Arrow&) -> ControlValue { return Vector3(1, 2, 3); },
          [](const auto& form) -> ControlValue { return form.shown.greatest; },
      },
      control.form);
}

TEST(EveryControl, ReadsWhatWasWrittenAndTouchesNoOther) {
  for (const LiveControl& control : live_control_table()) {
    LiveControls controls = sample_controls();
    set_value(control, other_value(control), controls);
    for (const LiveControl& each : live_control_table()) {
      const bool is_it = &each == &control;
      const ControlValue expected = is_it ? other_value(control) : value_of(each, sample_controls());
      EXPECT_EQ(value_of(each, controls), expected) << control.key << " was set, this is " << each.key;
    }
    EXPECT_NE(value_of(control, controls), value_of(control, sample_controls())) << control.key;
  }
}

TEST(EveryControl, IsFoundByAKeyOfItsOwnAndSaysWhatItDoes) {
  std::set<std::string_view> keys, hotkeys;
  for (const LiveControl& control : live_control_table()) {
    EXPECT_EQ(find_live_control(control.key), &control);
    EXPECT_TRUE(keys.insert(control.key).second) << control.key;
    for (const std::string_view text : {control.folder, control.label, control.help})
      EXPECT_FALSE(text.empty()) << control.key;
    const auto* form = std::get_if<Switch>(&control.form);
    const bool has_hotkey = form != nullptr && !form->hotkey.empty();
    EXPECT_TRUE(!has_hotkey || hotkeys.insert(form->hotkey).second) << control.key;
  }
  EXPECT_EQ(find_live_control("youngs_modulos"), nullptr);
}

/// Numbers just outside of what is allowed, and those at its ends.
template <class Form>
void expect_bounds(const LiveControl& control, const Form& form) {
  const auto [least, greatest] = form.allowed;
  EXPECT_LE(least, form.shown.least) << control.key;
  EXPECT_GE(greatest, form.shown.greatest) << control.key;
  for (const double inside : {least, greatest}) EXPECT_EQ(refusal(control, inside), "") << control.key;
  const double margin = 1e-6 * (greatest - least) + 1;
  for (const double outside : {least - margin, greatest + margin, std::nan(""), HUGE_VAL})
    EXPECT_THAT(refusal(control, outside), StartsWith(std::string(control.key) + ": expected a")) << outside;
}

TEST(EveryControl, RefusesWhatIsNotAllowedAndStaysAsItWas) {
  for (const LiveControl& control : live_control_table()) {
    std::visit(Overloaded{
                   [](const Switch&) {},
                   [&](const Choice& form) {
                     for (const Option& option : form.options())
                       EXPECT_EQ(refusal(control, std::string(option.name)), "");
                     EXPECT_THAT(refusal(control, std::string("rubber")), HasSubstr("rubber"));
                   },
                   [&](const Arrow& form) {
                     EXPECT_EQ(refusal(control, Vector3(0, form.longest_shown, 0)), "");
                     for (const double length : {2 * form.longest_allowed, std::nan("")})
                       EXPECT_THAT(refusal(control, Vector3(0, length, 0)), HasSubstr("finite numbers"));
                   },
                   [&](const auto& form) { expect_bounds(control, form); },
               },
               control.form);
  }
  EXPECT_EQ(refusal(*find_live_control("newton_limit"), 1.5),
            "newton_limit: expected a whole number from 0 to 1000, got 1.5");
  EXPECT_EQ(refusal(*find_live_control("youngs_modulus"), -1.0),
            "youngs_modulus: expected a number from 1 Pa to 1e+12 Pa, got -1");
}

TEST(Slider, InExtentsHasRoundStepsInEveryScene) {
  const Slider form = std::get<Slider>(find_live_control("ground_height")->form);
  for (const auto& [extent, step, reach] : {std::tuple(1.0, 0.01, 2.0), std::tuple(0.034, 1e-4, 0.068),
                                            std::tuple(250.0, 1.0, 500.0), std::tuple(1.2345, 0.01, 2.47)}) {
    const Slider slider = in_scene(form, extent);
    EXPECT_NEAR(slider.step, step, 1e-12 * step) << extent;
    EXPECT_NEAR(slider.shown.greatest, reach, 1e-12 * reach) << extent;
    EXPECT_NEAR(slider.shown.least, -reach, 1e-12 * reach) << extent;
  }
}

TEST(LogSlider, InExtentsEndsAtPowersOfTen) {
  const LogSlider form = std::get<LogSlider>(find_live_control("contact_distance")->form);
  for (const auto& [extent, least, greatest] :
       {std::tuple(1.0, 1e-4, 1e-1), std::tuple(0.034, 1e-5, 1e-2), std::tuple(250.0, 1e-2, 1e1)}) {
    const LogSlider slider = in_scene(form, extent);
    EXPECT_NEAR(slider.shown.least, least, 1e-12 * least) << extent;
    EXPECT_NEAR(slider.shown.greatest, greatest, 1e-12 * greatest) << extent;
  }
}

}  // namespace
}  // namespace resilin
