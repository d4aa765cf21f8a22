#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "resilin/live/live_controls.hpp"

/// Controls that can be changed while a scene runs, one entry for each: the panel of the page, the messages
/// that set a control, the checks of values and the tests walk this table.
namespace resilin {

/// Closed interval of allowed or shown values.
struct Interval {
  double least = 0, greatest = 0;
};

/// A number on a slider with even steps.
struct Slider {
  using Value = double;
  double LiveControls::* value;
  Interval allowed;  ///< range of values that may be set; wider than the range of the slider
  Interval shown;
  double step = 0;
  bool is_in_extents = false;  ///< `shown` and `step` are shares of the scene's extent, rounded
};

/// A positive number on a logarithmic slider.
struct LogSlider {
  using Value = double;
  double LiveControls::* value;
  Interval allowed;
  Interval shown;
  bool is_in_extents = false;  ///< `shown` are shares of the scene's extent
};

/// A whole number on a slider.
struct WholeSlider {
  using Value = double;
  int LiveControls::* value;
  Interval allowed, shown;
  std::string_view zero = "";  ///< meaning of 0, in words; 0 is a number like others when empty
};

/// A control that is on or off.
struct Switch {
  using Value = bool;
  bool LiveControls::* value;
  std::string_view hotkey = "";  ///< letter that turns it; none when empty
};

/// One value of a choice.
struct Option {
  std::string_view name;
  std::string_view label;  ///< as it is printed
};

/// One of several words.
struct Choice {
  using Value = std::string;
  std::string LiveControls::* value;
  std::vector<Option> (*options)();
  void (*check)(const std::string& value);  ///< throws InputError
};

/// A vector, shown as its length and its direction.
struct Arrow {
  using Value = Vector3;
  Vector3 LiveControls::* value;
  double longest_allowed, longest_shown, step;
};

/// A control of the live page: its key, its label and its form.
struct LiveControl {
  std::string_view key;     ///< key of messages
  std::string_view folder;  ///< folder of the panel
  std::string_view label;
  std::string_view unit;  ///< empty for a pure number
  std::string_view help;  ///< one line
  std::variant<Slider, LogSlider, WholeSlider, Switch, Choice, Arrow> form;
  bool is_of_contact = false;  ///< has an effect, and is shown, where bodies meet
  bool is_of_body = false;     ///< each body has its own
};

/// In the order of the panel.
std::span<const LiveControl> live_control_table();

/// The entry of this key, or nullptr.
const LiveControl* find_live_control(std::string_view key);

/// Value of a control; which kind follows from its form.
using ControlValue = std::variant<double, bool, std::string, Vector3>;

/// The present value of a control.
ControlValue value_of(const LiveControl& control, const LiveControls& controls);

/// @throws InputError  for a value that cannot be; the controls are then as before
void set_value(const LiveControl& control, const ControlValue& value, LiveControls& controls);

/// A slider with what it shows in the unit of its value, in a scene of this extent [m].
Slider in_scene(const Slider& slider, double extent);
LogSlider in_scene(const LogSlider& slider, double extent);

}  // namespace resilin
