#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// Homogeneous deformation mode of a specimen.
enum class TestMode {
  uniaxial,      ///< a bar pulled or pushed, its sides free: F = diag(l, x, x)
  equibiaxial,   ///< a sheet pulled alike along two edges: F = diag(l, l, x)
  planar,        ///< a wide sheet pulled, its width held: F = diag(l, x, 1); "pure shear"
  simple_shear,  ///< F = I + g e1 (x) e2
  volumetric,    ///< F = l I
  confined,      ///< its sides held: F = diag(l, 1, 1); "oedometer"
};
constexpr std::array<std::string_view, 6> spellings(TestMode) {
  return {"uniaxial", "equibiaxial", "planar", "simple_shear", "volumetric", "confined"};
}

/// The load at rest: a stretch of 1, an amount of shear of 0.
constexpr double rest_load(TestMode mode) { return mode == TestMode::simple_shear ? 0 : 1; }
/// Whether an incompressible solid can be strained so at all.
constexpr bool keeps_volume(TestMode mode) {
  return mode != TestMode::volumetric && mode != TestMode::confined;
}

/// Measurements on one specimen. Points at zero strain are left out: they carry no information.
struct MaterialTest {
  std::string place;  ///< for messages: "data.toml:3: test[0]"
  std::string name;
  TestMode mode = TestMode::uniaxial;
  std::vector<double> load;    ///< stretch l; amount of shear g
  std::vector<double> stress;  ///< nominal, force over rest area: P11; P12 in shear [Pa]
  std::vector<double> sigma;   ///< standard deviation of each [Pa]; empty when it is not known
  double weight = 1;           ///< weight of its squared residuals
  std::string unit = "Pa";     ///< unit of the file, in which the report shows it
  double unit_in_pascal = 1;
  bool has_unit = false;  ///< whether the unit was said

  std::size_t num_points() const { return load.size(); }
};

}  // namespace resilin
