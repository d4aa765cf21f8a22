#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/scene/scene.hpp"
#include "shared_data.hpp"

namespace resilin::testing {

/// A small static scene that is right: a box held at one side.
inline const std::string good_scene = R"(title = "A small beam"

[simulation]
kind = "static"
gravity = [0, 0, -9.81]

[[body]]
name = "beam"
mesh = { box = { size = [2, 1, 1], cells = [2, 1, 1] } }

[body.material]
law = "neo_hookean"
youngs_modulus = 1e6
poissons_ratio = 0.3
density = 1000

[[fix]]
name = "wall"
where = { group = "x_min" }

[[load]]
name = "pull"
kind = "traction"
where = { group = "x_max" }
value = [0, 0, -100]

[[probe]]
name = "tip"
at = [2, 0.5, 0.5]
)";

inline Scene read_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return read_scene_from_text(text, "beam.toml", source_folder(), {.overrides = overrides});
}

inline Scene read_good_scene_with(const std::vector<std::string>& overrides) {
  return read_text(good_scene, overrides);
}

/// The message of the InputError that `action` throws; empty when it throws none.
template <class Action>
std::string input_error(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// The message when the scene with these overrides is read.
inline std::string error_with(const std::vector<std::string>& overrides) {
  return input_error([&] { read_good_scene_with(overrides); });
}

/// The message when `from` is replaced by `to` in the scene's text.
inline std::string error_after_replacing(const std::string& from, const std::string& to) {
  std::string text = good_scene;
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the scene has no " + from);
  return input_error([&] { read_text(text.replace(at, from.size(), to)); });
}

}  // namespace resilin::testing
