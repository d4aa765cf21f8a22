#pragma once

#include <string>

#include "resilin/sweep/sweep.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {

/// A sheet of two triangles that is pulled: a scene of a few unknowns.
inline const std::string pulled_sheet = R"(
[simulation]
dimension = 2
[[body]]
name = "sheet"
element = "P1"
mesh = { box = { size = [1, 1], cells = [1, 1] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "held"
where = { group = "x_min" }
[[fix]]
name = "pulled"
where = { group = "x_max" }
displacement = [0.1, 0]
[[probe]]
name = "corner"
at = [1, 1]
)";

/// A folder with sheet.toml.
struct SheetFolder : TemporaryFolder {
  SheetFolder() { write("sheet.toml", pulled_sheet); }
  std::filesystem::path write_sweep(const std::string& text) const {
    return write("sweep.toml", "base = \"sheet.toml\"\n" + text);
  }
  Sweep sweep(const std::string& text) const { return read_sweep(write_sweep(text)); }
};

template <class Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace resilin::testing
