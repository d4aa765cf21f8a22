#include "viewer/scene_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "jelly_scene.hpp"
#include "resilin/core/error.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/simulation/simulation.hpp"
#include "temporary_folder.hpp"

namespace resilin::viewer {
namespace {

using nlohmann::json;
using resilin::testing::jelly;
using resilin::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr const char* tetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Holds the face of the vertex that lies farthest along a direction at rest.
void hold_towards(ServedLiveScene& scene, const Vector3& direction) {
  const ShownSurface surface(scene.world());
  const auto place = [&surface](std::uint32_t vertex) -> Vector3 {
    return Eigen::Map<const Eigen::Vector3f>(surface.rest_positions().data() + 3 * std::size_t{vertex})
        .cast<double>();
  };
  std::uint32_t farthest = 0;
  for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(surface.num_vertices()); ++v)
    if (place(v).dot(direction) > place(farthest).dot(direction)) farthest = v;
  scene.apply(HoldFace{farthest, place(farthest), {}});
}

/// Boundary conditions of the saved scene: it is run to its end.
std::vector<std::vector<Index>> supports_of(const std::filesystem::path& path) {
  Simulation simulation(read_scene(path).description);
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
  }
  std::vector<std::vector<Index>> supports;
  for (const Support& support : simulation.world().supports) supports.push_back(support.nodes);
  return supports;
}

TEST(SceneSource, SavesHeldFacesAndChangesOfAScene) {
  const TemporaryFolder folder;
  const auto path = folder.write("jelly.toml", jelly);
  const std::unique_ptr<ServedLiveScene> scene = served_scene(scene_file(path, {"simulation.end_time=0.05"}));
  EXPECT_EQ(scene->header()["saves"], true);
  hold_towards(*scene, Vector3(0, 0.1, 1));
  EXPECT_EQ(scene->state()["held"].size(), 1u);
  EXPECT_EQ(scene->state()["held"][0]["vertices"].size(), 9u);
  scene->apply(SetControl{find_live_control("youngs_modulus"), 7e4});
  scene->apply(SetControl{find_live_control("gravity"), Vector3(0, 0, -1)});
  scene->apply(SetControl{find_live_control("ground"), true});
  scene->apply(SetControl{find_live_control("ground_height"), -0.5});
  scene->apply(SetControl{find_live_control("damping"), 0.5});
  EXPECT_THAT(scene->save(),
              HasSubstr("with 1 fixed face. Next: resilin run " + (folder / "jelly-2.toml").string()));
  EXPECT_EQ(folder.read("jelly.toml"), jelly);
  const Description saved = read_scene(folder / "jelly-2.toml").description;
  EXPECT_EQ(saved.bodies[0].material.constants.at("youngs_modulus"), 7e4);
  EXPECT_EQ(saved.bodies[0].damping.mass, 0.5);
  EXPECT_EQ(saved.gravity, Vector3(0, 0, -1));
  EXPECT_EQ(saved.end_time, 0.05);
  ASSERT_EQ(saved.colliders.size(), 1u);
  EXPECT_EQ(saved.colliders[0].shape.point, Vector3(0, 0, -0.5));
  const auto supports = supports_of(folder / "jelly-2.toml");
  ASSERT_EQ(supports.size(), 2u);
  EXPECT_EQ(supports[1].size(), 9u);
  EXPECT_THAT(scene->save(), HasSubstr("jelly-3.toml"));
}

constexpr const char* two_blocks = R"([simulation]
kind = "static"
gravity = [0, 0, -9.81]
[[body]]
name = "soft"
mesh = { box = { size = [1, 1, 1], cells = [2, 2, 2] } }
element = "P1"
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.4, density = 100 }
[[body]]
name = "stiff"
mesh = { box = { size = [1, 1, 1], cells = [2, 2, 2], origin = [2, 0, 0] } }
element = "P1"
material = { law = "stable_neo_hookean", youngs_modulus = 3e5, poissons_ratio = 0.3, density = 100 }
[[fix]]
body = "soft"
where = { plane = { axis = "z", at = 0 } }
[[fix]]
body = "stiff"
where = { plane = { axis = "z", at = 0 } }
)";

TEST(SceneSource, AControlOfABodyChangesThatBodyAloneAndOnlyThatIsSaved) {
  const TemporaryFolder folder;
  const std::unique_ptr<ServedLiveScene> scene =
      served_scene(scene_file(folder.write("two.toml", two_blocks), {}));
  EXPECT_EQ(scene->state()["bodies"][1]["youngs_modulus"], 3e5);
  scene->apply(SetControl{find_live_control("youngs_modulus"), 5e5, 1});
  EXPECT_EQ(scene->state()["bodies"][0]["youngs_modulus"], 1e5);
  EXPECT_EQ(scene->state()["bodies"][1]["youngs_modulus"], 5e5);
  EXPECT_EQ(scene->state()["bodies"][1]["law"], "stable_neo_hookean");
  EXPECT_THROW(scene->apply(SetControl{find_live_control("youngs_modulus"), 5e5, 2}), InputError);
  scene->save();
  const Description saved = read_scene(folder / "two-2.toml").description;
  EXPECT_EQ(saved.bodies[0].material.constants.at("youngs_modulus"), 1e5);
  EXPECT_EQ(saved.bodies[0].material.law, "neo_hookean");
  EXPECT_EQ(saved.bodies[1].material.constants.at("youngs_modulus"), 5e5);
  EXPECT_FALSE(saved.contact.stiffness) << "nobody has chosen it";
  // One for all bodies changes nothing else of them.
  scene->apply(SetControl{find_live_control("poissons_ratio"), 0.2});
  EXPECT_EQ(scene->state()["bodies"][0]["poissons_ratio"], 0.2);
  EXPECT_EQ(scene->state()["bodies"][1]["youngs_modulus"], 5e5);
  EXPECT_EQ(scene->state()["bodies"][1]["law"], "stable_neo_hookean");
}

TEST(SceneSource, AForceOnAFaceIsThatForceInTheLiveSceneAndInTheSavedOne) {
  const TemporaryFolder folder;
  const std::unique_ptr<ServedLiveScene> scene =
      served_scene(scene_file(folder.write("two.toml", two_blocks), {}));
  const ShownSurface surface(scene->world());
  std::uint32_t top = 0;  // the corner of the first body that is not at an edge
  for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(surface.num_vertices()); ++v) {
    const float* place = surface.rest_positions().data() + 3 * std::size_t{v};
    if (place[0] == 0.5F && place[1] == 0.5F && place[2] == 1.0F) top = v;
  }
  const HoldFace face{top, Vector3(0.45, 0.45, 1), {}};
  EXPECT_THROW(scene->apply(LoadFace{face, {FaceLoadChoice::Kind::force, 0}}), InputError);
  scene->apply(LoadFace{face, {FaceLoadChoice::Kind::force, 60}});
  ASSERT_EQ(scene->state()["loads"].size(), 1U);
  scene->apply(Settle{});
  for (int step = 0; step < 200 && !scene->is_at_rest(); ++step) scene->step(1);
  EXPECT_TRUE(scene->is_at_rest());
  scene->save();
  Simulation simulation(read_scene(folder / "two-2.toml").description);
  const World& world = simulation.world();
  VectorX gradient = VectorX::Zero(world.rest_positions.size());
  world.terms[world.term_of_load(0)]->add_gradient(world.rest_positions, world.at_load(1), gradient);
  Vector3 sum = Vector3::Zero();
  for (Index node = 0; node < world.num_nodes(); ++node) sum -= node_position(3, node, gradient);
  EXPECT_NEAR((sum - Vector3(0, 0, -60)).norm(), 0, 1e-9 * 60);
  scene->apply(LoadFace{face, {FaceLoadChoice::Kind::force, 60}});
  EXPECT_EQ(scene->state()["loads"].size(), 0U) << "a second time takes it away";
}

TEST(SceneSource, ASecondClickFreesAFaceAndAllAreFreedAtOnce) {
  const TemporaryFolder folder;
  const auto path = folder.write("jelly.toml", jelly);
  const std::unique_ptr<ServedLiveScene> scene = served_scene(scene_file(path, {}));
  hold_towards(*scene, Vector3(0, 0.1, 1));
  hold_towards(*scene, Vector3(0, 0.1, 1));
  EXPECT_EQ(scene->state()["held"].size(), 0u);
  hold_towards(*scene, Vector3(0, 0.1, 1));
  hold_towards(*scene, Vector3(0.1, 1, 0));
  EXPECT_EQ(scene->state()["held"].size(), 2u);
  scene->apply(FreeFaces{});
  EXPECT_EQ(scene->state()["held"].size(), 0u);
}

TEST(SceneSource, SavesASurfaceThatWasSentWithItsMeshAndWritesOverNothing) {
  const TemporaryFolder folder;
  folder.write("part.obj", "not this one");
  folder.write("part.toml", "nor this");
  const std::unique_ptr<ServedLiveScene> scene =
      served_scene(sent_mesh({harmless_name("../part.obj"), tetrahedron}, folder.path()));
  hold_towards(*scene, Vector3(0, 0, -1));
  ASSERT_EQ(scene->state()["held"].size(), 1u);
  const std::vector<Index> held = [&] {
    scene->save();
    return supports_of(folder / "part-2.toml").at(0);
  }();
  EXPECT_EQ(folder.read("part.obj"), "not this one");
  EXPECT_EQ(folder.read("part.toml"), "nor this");
  EXPECT_EQ(folder.read("part-2.obj"), tetrahedron);
  EXPECT_GE(held.size(), 3u);
  EXPECT_FALSE(read_scene(folder / "part-2.toml").description.is_dynamic) << "at rest, for it is held";
}

TEST(SceneSource, RefusesFilesThatAreNoMeshesInTheReadersOwnLine) {
  const auto refusal = [](const std::string& name, const std::string& bytes) {
    try {
      served_scene(sent_mesh({name, bytes}, "."));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("a.stl", ""), "a.stl: the file is empty");
  EXPECT_THAT(refusal("a.stl", "solid x\nfacet what"), HasSubstr("a.stl: line 2"));
  EXPECT_THAT(refusal("a.png", "\x89PNG"), HasSubstr("a mesh in one of the formats"));
  EXPECT_THAT(refusal("a.node", "4 3 0 0\n"), HasSubstr("one that needs a.ele beside it"));
}

TEST(SceneSource, NamesOfSentFilesLeadNowhereElse) {
  EXPECT_EQ(harmless_name("bunny.stl"), "bunny.stl");
  EXPECT_EQ(harmless_name("../../etc/passwd"), "passwd");
  EXPECT_EQ(harmless_name("C:\\x\\y.ply"), "y.ply");
  EXPECT_EQ(harmless_name(".bashrc"), "bashrc");
  EXPECT_EQ(harmless_name("--out"), "out");
  EXPECT_EQ(harmless_name("a b;$(rm).obj"), "a_b___rm_.obj");
  EXPECT_EQ(harmless_name(""), "mesh");
  EXPECT_EQ(harmless_name("a/"), "mesh");
  EXPECT_EQ(harmless_name("öl.stl"), "öl.stl");
  EXPECT_EQ(harmless_name(std::string(500, 'x') + ".stl").size(), 100u);
  EXPECT_EQ(harmless_name("a\nb.stl"), "a_x0ab.stl");
}

}  // namespace
}  // namespace resilin::viewer
