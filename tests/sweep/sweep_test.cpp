#include "resilin/sweep/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string modulus = "body.sheet.material.youngs_modulus",
                  ratio = "body.sheet.material.poissons_ratio";

struct SweepTest : ::testing::Test {
  SheetFolder folder;
  std::string error(const std::string& text) const {
    return error_of([&] { folder.sweep(text); });
  }
};

TEST_F(SweepTest, TakesAllCombinationsTheLastParameterFastest) {
  const Sweep sweep =
      folder.sweep("[parameters]\n" + modulus + " = [1e5, 1e6]\n" + ratio + " = [0.1, 0.2, 0.3]\n");
  ASSERT_EQ(sweep.size(), 6u);
  EXPECT_THAT(sweep.shown_values(0), ElementsAre("1e+05", "0.1"));
  EXPECT_THAT(sweep.shown_values(1), ElementsAre("1e+05", "0.2"));
  EXPECT_THAT(sweep.shown_values(5), ElementsAre("1e+06", "0.3"));
  EXPECT_EQ(sweep.scene(5).description.bodies[0].material.constants.at("poissons_ratio"), 0.3);
}

TEST_F(SweepTest, TakesListsTogether) {
  const std::string text = "method = \"list\"\n[parameters]\n" + modulus + " = [1e5, 1e6]\n" + ratio;
  const Sweep sweep = folder.sweep(text + " = [0.1, 0.2]\n");
  ASSERT_EQ(sweep.size(), 2u);
  EXPECT_THAT(sweep.shown_values(1), ElementsAre("1e+06", "0.2"));
  EXPECT_THAT(error(text + " = [0.1, 0.2, 0.3]\n"),
              HasSubstr("expected 2 values, as many as for " + modulus + ", got 3"));
}

TEST_F(SweepTest, DrawsTheSameScenesEveryTime) {
  for (const std::string method : {"latin_hypercube", "sobol"}) {
    const std::string text = "method = \"" + method + "\"\nsamples = 16\nseed = SEED\n[parameters]\n" +
                             modulus + " = { log_uniform = [1e4, 1e6] }\n";
    const auto with_seed = [&](const std::string& seed) {
      std::string seeded = text;
      seeded.replace(seeded.find("SEED"), 4, seed);
      const Sweep sweep = folder.sweep(seeded);
      EXPECT_EQ(sweep.size(), 16u);
      std::vector<std::string> values;
      for (std::uint64_t i = 0; i < sweep.size(); ++i) values.push_back(sweep.shown_values(i).front());
      return values;
    };
    EXPECT_EQ(with_seed("1"), with_seed("1"));
    EXPECT_NE(with_seed("1"), with_seed("2"));
  }
}

TEST_F(SweepTest, SetsSeveralKeysAtOnce) {
  const Sweep sweep = folder.sweep(
      "[[parameter]]\nname = \"size\"\nkey = [\"body.0.scale\", \"fix.pulled.displacement.0\"]\nvalues = [2, "
      "3]\n");
  EXPECT_EQ(sweep.parameters().front().name, "size");
  EXPECT_EQ(sweep.scene(1).description.bodies[0].scale, 3);
  EXPECT_EQ(sweep.scene(1).description.fixes[1].displacement, Vector3(3, 0, 0));
}

TEST_F(SweepTest, HoldsAMillionScenesAsItHoldsOne) {
  const Sweep sweep = folder.sweep("[parameters]\n" + modulus + " = { logspace = [1e4, 1e6, 1000000] }\n" +
                                   ratio + " = { linspace = [0, 0.4, 100000] }\n");
  EXPECT_EQ(sweep.size(), 100000000000u);
  EXPECT_EQ(sweep.shown_values(99999999999u).back(), "0.4");
  EXPECT_NE(sweep.hash(99999999999u), sweep.hash(99999999998u));
}

TEST_F(SweepTest, NamesTheNearestOfAnUnknownKeyBeforeAnythingRuns) {
  EXPECT_THAT(error("[parameters]\nbody.sheet.material.youngs_modulos = [1e5]\n"),
              HasSubstr("did you mean \"youngs_modulus\"?"));
  EXPECT_THAT(error("[parameters]\nbody.shet.scale = [1]\n"), HasSubstr("did you mean \"sheet\"?"));
  EXPECT_THAT(error("[parameters]\nsimulatoin.gravity = [[0, 0]]\n"),
              HasSubstr("did you mean \"simulation\"?"));
  EXPECT_THAT(error("[parameters]\nbody.0.scale.x = [1]\nbody.0.skale = [2]\n"), HasSubstr("scale"));
  // A value that the scene refuses does not hide it.
  EXPECT_THAT(error("[parameters]\nbody.0.scale = [-1]\nbody.0.velocitie = [[0, 0]]\n"),
              HasSubstr("did you mean \"velocity\"?"));
}

TEST_F(SweepTest, KnowsKeysThatOnlySomeLawsHave) {
  const Sweep sweep = folder.sweep(
      "[parameters]\nbody.0.material.law = [\"neo_hookean\", \"mooney_rivlin\"]\nbody.0.material.c10 = "
      "[1e5]\n");
  EXPECT_EQ(sweep.size(), 2u);
}

TEST_F(SweepTest, RefusesWhatIsNoSweep) {
  EXPECT_THAT(error(""), HasSubstr("there are no parameters"));
  EXPECT_THAT(error("[parameters]\nbody.0.scale = []\n"), HasSubstr("at least one value"));
  EXPECT_THAT(error("methods = \"grid\"\n[parameters]\nbody.0.scale = [1]\n"),
              HasSubstr("did you mean \"method\"?"));
  EXPECT_THAT(error("method = \"sobel\"\n[parameters]\nbody.0.scale = [1]\n"),
              HasSubstr("did you mean \"sobol\"?"));
  EXPECT_THAT(error("method = \"sobol\"\n[parameters]\nbody.0.scale = [1]\n"), HasSubstr("samples"));
  EXPECT_THAT(error("samples = 3\n[parameters]\nbody.0.scale = [1]\n"), HasSubstr("a method that draws"));
  EXPECT_THAT(error("[parameters]\nbody.0.scale = { uniform = [1, 2] }\n"),
              HasSubstr("draws from intervals"));
  EXPECT_THAT(error("[parameters]\nbody.0.scale = [1]\nbody.sheet.scale = [2]\n"),
              HasSubstr("sets the same value"));
  EXPECT_THAT(error("quantities = [\"probe.corner.displacement.w\"]\n[parameters]\nbody.0.scale = [1]\n"),
              HasSubstr("did you mean \"probe.corner.displacement"));
  EXPECT_THAT(error("quantities = [\"status\"]\n[parameters]\nbody.0.scale = [1]\n"),
              HasSubstr("a quantity of the scene"));
  EXPECT_THAT(error("keep = \"al\"\n[parameters]\nbody.0.scale = [1]\n"), HasSubstr("did you mean \"all\"?"));
  EXPECT_THAT(error_of([&] { read_sweep(folder.write("alone.toml", "[parameters]\nx = [1]\n")); }),
              HasSubstr("the key \"base\" is missing"));
  EXPECT_THAT(error_of([&] { read_sweep(folder.write("alone.toml", "base = \"none.toml\"\n")); }),
              HasSubstr("no such file"));
}

TEST_F(SweepTest, HashesWhatResultsFollowFrom) {
  const std::string text = "[parameters]\nbody.0.scale = [1.0, 2.0]\n";
  const SceneHash before = folder.sweep(text).hash(0);
  EXPECT_EQ(folder.sweep("[parameters]\nbody.0.scale = [1.0]\n").hash(0),
            before);  // not the rest of the sweep
  folder.write("sheet.toml", "# a comment\n" + pulled_sheet);
  EXPECT_EQ(folder.sweep(text).hash(0), before);
  EXPECT_NE(folder.sweep("[parameters]\nbody.0.scale = [1]\n").hash(0),
            before);  // a whole number is another value
  EXPECT_NE(folder.sweep("quantities = [\"load\"]\n" + text).hash(0), before);
  folder.write("sheet.toml", pulled_sheet + "[newton]\ntolerance = 1e-9\n");
  EXPECT_NE(folder.sweep(text).hash(0), before);
}

TEST_F(SweepTest, HashesTheContentOfMeshes) {
  const auto write = [&](int cells) {
    write_mesh(folder / "a.msh", make_rectangle({1, 1}, {cells, 1}, {0, 0}));
  };
  const std::string text = "[parameters]\nbody.0.mesh = [\"a.msh\"]\n";
  write(1);
  const Sweep sweep = folder.sweep(text);
  const SceneHash before = sweep.hash(0);
  EXPECT_EQ(sweep.scene(0).description.bodies[0].mesh.vertices.size(), 4u);
  write(2);
  EXPECT_NE(sweep.hash(0), before);  // the file is looked at again
  EXPECT_EQ(sweep.scene(0).description.bodies[0].mesh.vertices.size(), 6u);
  write(1);
  EXPECT_EQ(sweep.hash(0), before);
}

TEST_F(SweepTest, HashesOfManyScenesDiffer) {
  const Sweep sweep = folder.sweep("[parameters]\nbody.0.scale = { linspace = [1, 2, 20000] }\n");
  std::set<SceneHash> hashes;
  std::set<std::uint64_t> halves;
  for (std::uint64_t i = 0; i < sweep.size(); ++i) {
    hashes.insert(sweep.hash(i));
    halves.insert(sweep.hash(i).high);
  }
  EXPECT_EQ(hashes.size(), sweep.size());
  EXPECT_EQ(halves.size(), sweep.size());
}

TEST_F(SweepTest, TellsAnotherSweepByTheFirstThingThatDiffers) {
  const Fingerprint before = folder.sweep("[parameters]\nbody.0.scale = [1, 2]\n").identity();
  const auto difference =
      first_difference(before, folder.sweep("[parameters]\nbody.0.scale = [1, 3]\n").identity());
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->name, "parameter body.0.scale");
  EXPECT_EQ(difference->before, "[1, 2]");
  folder.write("sheet.toml", pulled_sheet + "[newton]\ntolerance = 1e-9\n");
  EXPECT_EQ(first_difference(before, folder.sweep("[parameters]\nbody.0.scale = [1, 2]\n").identity())->name,
            "base.newton.tolerance");
}

}  // namespace
}  // namespace resilin::testing
