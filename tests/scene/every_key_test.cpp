#include <gtest/gtest.h>

#include <locale>
#include <sstream>

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
  EXPECT_EQ(world.bodies.size(), 9u);
  EXPECT_EQ(world.supports.size(), 2u);
  EXPECT_EQ(names_of_terms(world, EnergyCategory::external).size(), 6u);  // five loads and gravity
  EXPECT_EQ(scene.description.newton.projection, ProjectionChoice::clamp);
  EXPECT_EQ(scene.description.newton.inversion_bound, InversionBound::everywhere);
  EXPECT_EQ(scene.description.output.fields.size(), 6u);
}

TEST(EveryKey, OfThePageIsInTheScene) {
  std::ifstream file(every_key());
  const std::string scene(std::istreambuf_iterator<char>(file), {});
  // Keys in backquotes at the start of a table row of the page, but for those that exclude one another.
  std::istringstream page(scene_reference());
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| `") || line.find("Not in this version") != line.npos) continue;
    std::string key = line.substr(3, line.find('`', 3) - 3);
    key = key.substr(key.rfind('.') + 1);
    if (key == "lame_lambda") continue;  // neo_hookean_simo has the bulk modulus in its place
    if (key == "modes" || key == "count" || key == "about") continue;  // of scenes without motion
    EXPECT_NE(scene.find(key), scene.npos) << key;
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
