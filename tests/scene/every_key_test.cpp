#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "resilin/core/text.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/world/world.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

std::filesystem::path every_key() {
  return source_folder() / "tests" / "scene" / "scenes" / "every_key_3d.toml";
}

TEST(EveryKey, MakesAWorld) {
  const Scene scene = read_scene(every_key());
  const World world(scene.description);
  const Description& description = scene.description;
  EXPECT_EQ(world.bodies.size(), description.bodies.size());
  EXPECT_EQ(world.supports.size(), description.fixes.size());
  EXPECT_EQ(world.colliders.size() + world.mesh_colliders.size(), description.colliders.size());
  const std::size_t num_terms = description.loads.size() + 1;  // and gravity
  EXPECT_EQ(names_of_terms(world, EnergyCategory::external).size(), num_terms);
  EXPECT_EQ(description.newton.projection, ProjectionChoice::clamp);
  EXPECT_EQ(description.newton.inversion_bound, InversionBound::everywhere);
}

bool is_constant_of_a_law(const std::string& key) {
  return std::ranges::any_of(laws(), [&key](const LawInfo* law) {
    return std::ranges::find(law->constants, key, &ConstantText::name) != law->constants.end();
  });
}

TEST(EveryKey, OfThePageIsInTheScene) {
  std::ifstream file(every_key());
  const std::string scene(std::istreambuf_iterator<char>(file), {});
  // Keys in backquotes at the start of a table row of the page.
  std::istringstream page(scene_reference());
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| `") || line.find("Not in this version") != line.npos) continue;
    std::string key = line.substr(3, line.find('`', 3) - 3);
    key = key.substr(key.rfind('.') + 1);
    if (is_constant_of_a_law(key)) continue;                           // see the test below
    if (key == "modes" || key == "count" || key == "about") continue;  // only for modal analysis
    if (key == "thickness") continue;  // only in 2D; see plane_stress_test.cpp
    // Only in a static scene; see tests/cli/tie_test.cpp.
    if (key == "surfaces" || key == "gap" || key == "max_distance" || key == "terms") continue;
    // In place of end_time; see step_test.cpp.
    if (key == "duration" || key == "activate" || key == "deactivate") continue;
    // Keys of joints, springs and cables: see tests/cli/joint_test.cpp.
    if (key == "bodies" || key == "to" || key == "motor" || key == "points" || key == "rest_length" ||
        key == "tension_only" || key == "tension" || key == "shortening" || key == "second_axis" ||
        key == "rest" || key == "limits" || key == "torque" || key == "forces")
      continue;
    if (key == "branches") continue;  // in place of g and tau; see scene_test.cpp
    if (key == "library") continue;   // in place of law and constants; see material_library_test.cpp
    // Only for a surface; see surface_mesh_test.cpp.
    if (key == "mesher" || key == "min_size") continue;
    if (key == "disc" || key == "ring") continue;  // only in 2D; see round_mesh_test.cpp
    EXPECT_NE(scene.find(key), scene.npos) << key;
  }
}

TEST(EveryLaw, HasTheConstantsThatAreGivenByName) {
  for (const LawInfo* law : laws()) {
    const double poissons_ratio = std::isnan(law->only_poissons_ratio) ? 0.3 : law->only_poissons_ratio;
    const std::vector<double> constants = law->constants_from(hooke_from_young_poisson(1e6, poissons_ratio));
    std::string material = "{ law = \"" + std::string(law->name) + "\"";
    for (std::size_t i = 0; i < constants.size(); ++i)
      material += ", " + std::string(law->constants[i].name) + " = " + format_number(constants[i]);
    if (law->max_fibres > 0) material += ", fibres = [[1, 0, 0]]";
    const Scene scene = read_good_scene_with({"body.0.material=" + material + " }"});
    EXPECT_EQ(World(scene.description).bodies[0].domains.front().energy->material(0).constants, constants)
        << material;
  }
}

/// Decimal commas and dots between thousands, as in German.
struct CommaNumbers : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(EveryKey, MeansTheSameInALocaleWithDecimalCommas) {
  const VectorX expected = World(read_scene(every_key()).description).start_velocities;
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaNumbers));
  const Scene scene = read_scene(every_key(), {.overrides = {"simulation.time_step=0.0125"}});
  const VectorX velocities = World(scene.description).start_velocities;
  const std::string message =
      input_error([] { read_scene(every_key(), {.overrides = {"simulation.time_step=-1234.5"}}); });
  const std::string page = scene_reference();
  std::locale::global(before);
  EXPECT_EQ(velocities, expected);
  EXPECT_EQ(scene.description.time_step, 0.0125);
  EXPECT_NE(message.find("got -1234.5"), message.npos) << message;
  EXPECT_EQ(page, scene_reference());
}

}  // namespace
}  // namespace resilin::testing
