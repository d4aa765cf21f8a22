#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "program.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/simulation/simulation.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct RestShapeOnCommand : ::testing::Test {
  TemporaryFolder folder;
  ProgramResult run(const std::vector<std::string>& arguments) {
    return run_program(folder.path(), arguments);
  }

  /// A scene with the lines that the command has printed for it, "[[TABLE]] "NAME": KEY = VALUE".
  Scene changed(const std::string& file, const std::string& printed) const {
    std::vector<std::string> overrides;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) {
      const std::size_t table = line.find("[["), name = line.find("\"");
      if (table == std::string::npos) continue;
      const std::size_t end = line.find("\": ", name);
      const std::string body = line.substr(table + 2, line.find("]]") - table - 2);
      std::string value = line.substr(end + 3);
      value.replace(value.find(" = "), 3, "=");
      overrides.push_back(body + "." + line.substr(name, end + 1 - name) + "." + value);
    }
    EXPECT_FALSE(overrides.empty()) << printed;
    return read_scene(folder.path() / file, {.overrides = overrides});
  }

  /// How far vertices are from those of the mesh as drawn, at the end of a run [m].
  static double distance(const Scene& scene, const std::vector<Vector3>& drawn) {
    Description description = scene.description;
    description.newton.tolerance = 1e-11;
    Simulation simulation(std::move(description));
    while (!simulation.is_finished()) EXPECT_NE(simulation.step().status, StepReport::Status::not_converged);
    double largest = 0;
    for (std::size_t v = 0; v < drawn.size(); ++v) {
      const Vector3 at = simulation.world().place_of(static_cast<Index>(v), simulation.state().positions);
      largest = std::max(largest, (at - drawn[v]).norm());
    }
    return largest;
  }
};

TEST_F(RestShapeOnCommand, WritesAMeshWithWhichTheSceneEndsAsItWasDrawn) {
  std::string text = box_scene;
  text.replace(text.find("{ group = \"x_min\" }"), 19, "{ plane = { axis = \"x\", at = 0 } }");
  text.replace(text.find("cells = [4, 2, 2] } }"), 21,
               "cells = [4, 2, 2] } }\nscale = 0.5\nrotate = { axis = [0, 0, 1], degrees = 0 }");
  std::filesystem::create_directory(folder.path() / "scenes");
  folder.write("scenes/box.toml", text);
  const std::vector<Vector3> drawn =
      read_scene(folder.path() / "scenes/box.toml").description.bodies[0].mesh.vertices;
  const ProgramResult found = run({"rest-shape", "scenes/box.toml"});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(found.err, "");
  EXPECT_THAT(found.out, HasSubstr("out/box_rest/box.msh: the stress-free shape of \"box\""));
  EXPECT_THAT(found.out, HasSubstr("m from the drawn shape"));
  EXPECT_THAT(found.out, HasSubstr("[[body]] \"box\": mesh = \"../out/box_rest/box.msh\""));
  EXPECT_THAT(found.out, HasSubstr("[[fix]] \"wall\": where = { group = \"wall\" }"));
  const Scene again = changed("scenes/box.toml", found.out);
  std::vector<Vector3> target = drawn;
  for (Vector3& place : target) place *= 0.5;
  double moved = 0;
  for (std::size_t v = 0; v < drawn.size(); ++v)
    moved = std::max(moved, (0.5 * again.description.bodies[0].mesh.vertices[v] - target[v]).norm());
  EXPECT_GT(moved, 1e-3);
  EXPECT_LT(distance(again, target), 1e-8);
}

TEST_F(RestShapeOnCommand, ThatLiesInAFloorBeginsAsItWasDrawn) {
  // Held at its top, pressed on the floor: at rest it would reach through it.
  folder.write("block.toml", R"([simulation]
kind = "static"
dimension = 2
[[body]]
name = "block"
element = "P1"
mesh = { box = { size = [0.3, 0.1], cells = [6, 2] } }
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "top"
where = { group = "y_max" }
[[collider]]
name = "floor"
kind = "half_space"
point = [0, -0.0005]
normal = [0, 1]
activation_distance = 0.001
)");
  const std::vector<Vector3> drawn =
      read_scene(folder.path() / "block.toml").description.bodies[0].mesh.vertices;
  const ProgramResult found = run({"rest-shape", "block.toml", "--out", "mould"});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.err, HasSubstr("inside of the collider \"floor\""));
  EXPECT_EQ(std::ranges::count(found.err, '\n'), 1) << found.err;
  EXPECT_THAT(found.out, HasSubstr("initial_positions = \"mould/block_drawn.csv\""));
  EXPECT_LT(distance(changed("block.toml", found.out), drawn), 1e-8 * 0.3);
}

TEST_F(RestShapeOnCommand, SaysNothingWhenQuiet) {
  folder.write("box.toml", box_scene);
  const ProgramResult found = run({"rest-shape", "box.toml", "--quiet"});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(found.out, "");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/box_rest/box.msh"));
}

TEST_F(RestShapeOnCommand, IsRefusedInOneLine) {
  folder.write("box.toml", box_scene);
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--set", "simulation.kind=dynamic"},
                                             {"--set", "body.box.material.youngs_modulus=100"},
                                             {"--out", "box.toml/in_a_file"}}) {
    std::vector<std::string> arguments = {"rest-shape", "box.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult refused = run(arguments);
    EXPECT_EQ(refused.exit_code, 1) << refused.out;
    EXPECT_EQ(refused.out, "");
    EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
  }
}

}  // namespace
}  // namespace resilin::testing
