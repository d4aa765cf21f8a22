#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <sstream>

#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/curved_cells.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/skin.hpp"
#include "round_skin.hpp"
#include "scene_text.hpp"
#include "shared_mesh.hpp"
#include "temporary_folder.hpp"
#include "test_names.hpp"

// From a file that holds nothing but a surface to a simulation.

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// Little-endian, as the format wants it and every machine that we test on has it.
void write_binary_stl(const std::filesystem::path& path, const Mesh& surface) {
  static_assert(std::endian::native == std::endian::little);
  std::ofstream stream(path, std::ios::binary);
  stream << std::string(80, ' ');
  const auto count = static_cast<std::uint32_t>(surface.blocks[0].num_cells());
  stream.write(reinterpret_cast<const char*>(&count), 4);
  for (Index t = 0; t < surface.blocks[0].num_cells(); ++t) {
    std::array<float, 12> numbers{};
    for (std::size_t i = 0; i < 9; ++i) {
      const auto vertex = static_cast<std::size_t>(surface.blocks[0].cell(t)[i / 3]);
      numbers[3 + i] = static_cast<float>(surface.vertices[vertex][static_cast<Eigen::Index>(i % 3)]);
    }
    stream.write(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    stream.write("\0\0", 2);
  }
}

/// A static scene of one body, 0.1 m long, that is held at its lowest tenth and hangs on it or stands.
Scene scene_of(const std::filesystem::path& file, const Mesh& surface, const std::string& mesh) {
  const BoundingBox box = bounding_box(surface);
  const Vector3 size = box.max - box.min;
  const double scale = 0.1 / size.maxCoeff();
  const double top = scale * (box.min.y() + 0.1 * size.y());
  return read_scene_from_text("[simulation]\ngravity = [0, -9.81, 0]\n[[body]]\nmesh = " + mesh +
                                  "\nscale = " + std::to_string(scale) +
                                  "\n[[fix]]\nwhere = { box = [[-1e9, -1e9, -1e9], [1e9, " +
                                  std::to_string(top) + ", 1e9]] }\n",
                              "a.toml", file.parent_path(), {});
}

/// @param outside  how far the surface may stand out of the cells [m]
void expect_converged(const Scene& scene, double outside) {
  Simulation simulation(scene.description);
  const Skin& skin = *simulation.world().bodies[0].skin;
  EXPECT_LE(skin.embedding.outside().distance, outside);
  while (!simulation.is_finished()) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
}

double volume_of(const Mesh& mesh) { return exact_volume(mesh, mesh.blocks[0]); }

constexpr double volume_of_ball = 4.09;  // volume of ball of radius 1, by its 512 triangles

struct SurfaceMesh : ::testing::Test {
  const TemporaryFolder folder;
  const Mesh ball = ball_surface(1, Vector3::Zero(), 3);

  std::filesystem::path write_ball() {
    write_binary_stl(folder / "ball.stl", ball);
    return folder / "ball.stl";
  }
};

TEST_F(SurfaceMesh, BecomesCellsThatCarryItAsSkin) {
  const Scene scene = scene_of(write_ball(), ball, "\"ball.stl\"");
  const BodyDescription& body = scene.description.bodies[0];
  EXPECT_NEAR(body.mesh.find_solid(3)->num_cells(), 4000, 1000);
  ASSERT_TRUE(body.skin);
  const std::vector<Vector3> given = read_mesh(folder / "ball.stl").mesh.vertices;
  ASSERT_GE(body.skin->surface.vertices.size(), given.size());  // triangles larger than cells are cut
  for (std::size_t v = 0; v < given.size(); ++v) EXPECT_EQ(body.skin->surface.vertices[v], given[v]) << v;
  EXPECT_THAT(scene.warnings, Not(Contains(HasSubstr("times the volume"))));
  EXPECT_NEAR(volume_of(body.mesh), volume_of_ball, 0.01 * volume_of_ball);
  expect_converged(scene, 1e-3);
}

TEST_F(SurfaceMesh, OfALatticeIsTooLargeAndThatIsTold) {
  const Scene scene = scene_of(write_ball(), ball, "{ surface = \"ball.stl\", mesher = \"lattice\" }");
  EXPECT_GT(volume_of(scene.description.bodies[0].mesh), 1.1 * volume_of_ball);
  EXPECT_THAT(scene.warnings,
              Contains(AllOf(HasSubstr("the mesh has 1."), HasSubstr("times the volume of the surface"),
                             HasSubstr("ball.stl"), HasSubstr("mesher = \"fitted\""))));
  expect_converged(scene, 0);
}

TEST_F(SurfaceMesh, InRealTimeGetsALatticeUnlessTheSceneChooses) {
  write_ball();
  SceneOptions options;
  options.is_for_real_time = true;
  const auto volume = [&](const std::string& mesh) {
    return volume_of(read_scene_from_text("[[body]]\nmesh = " + mesh + "\n", "a.toml", folder.path(), options)
                         .description.bodies[0]
                         .mesh);
  };
  EXPECT_GT(volume("\"ball.stl\""), 1.1 * volume_of_ball);
  EXPECT_LT(volume("{ surface = \"ball.stl\", mesher = \"fitted\" }"), 1.01 * volume_of_ball);
}

TEST_F(SurfaceMesh, HasAsManyCellsAsItsTableSays) {
  const Scene scene = scene_of(write_ball(), ball, "{ surface = \"ball.stl\", cells = 600 }");
  EXPECT_NEAR(scene.description.bodies[0].mesh.find_solid(3)->num_cells(), 600, 200);
}

TEST_F(SurfaceMesh, ASkinOfTheBodysOwnGoesFirst) {
  write_ball();
  write_mesh(folder / "other.obj", ball_surface(0.5, Vector3::Zero(), 1));
  const Scene scene = read_scene_from_text("[[body]]\nmesh = \"ball.stl\"\nskin = \"other.obj\"\n", "a.toml",
                                           folder.path(), {});
  EXPECT_EQ(scene.description.bodies[0].skin->surface_name, "other.obj");
}

TEST_F(SurfaceMesh, OfAnotherUnitIsTold) {
  write_ball();
  const auto warnings_at = [&](const std::string& scale) {
    return read_scene_from_text("[[body]]\nmesh = \"ball.stl\"\nscale = " + scale + "\n", "a.toml",
                                folder.path(), {})
        .warnings;
  };
  const auto is_told = Contains(AllOf(HasSubstr("a.toml:2"), HasSubstr("no unit")));
  EXPECT_THAT(warnings_at("20"), is_told);
  EXPECT_THAT(warnings_at("1e-4"), is_told);
  EXPECT_THAT(warnings_at("1"), Not(is_told));
}

TEST_F(SurfaceMesh, WhatIsNoBodyIsRefusedInOneLine) {
  write_ball();
  Mesh sheet = ball;
  sheet.blocks[0].nodes.resize(3 * 20);
  remove_unused_nodes(sheet);
  write_binary_stl(folder / "sheet.stl", sheet);
  folder.write("empty.stl", "");
  folder.write("cut.stl", std::string(80, ' ') + std::string("\5\0\0\0", 4) + std::string(60, '\0'));
  const auto message = [&](const std::string& mesh, const std::string& simulation = "") {
    return input_error([&] {
      read_scene_from_text(simulation + "[[body]]\nmesh = " + mesh + "\n", "a.toml", folder.path(), {});
    });
  };
  EXPECT_THAT(message("\"sheet.stl\""), HasSubstr("open sheet"));
  EXPECT_THAT(message("\"empty.stl\""), HasSubstr("the file is empty"));
  EXPECT_THAT(message("\"cut.stl\""), HasSubstr("the file is cut"));
  EXPECT_THAT(message("{ surface = \"ball.stl\", cells = 0 }"), HasSubstr("body[0].mesh.cells"));
  EXPECT_THAT(message("{ surface = \"ball.stl\", cells = 2000001 }"), HasSubstr("body[0].mesh.cells"));
  EXPECT_THAT(message("{ surface = \"ball.stl\", box = {} }"), HasSubstr("one of { surface = FILE"));
  EXPECT_THAT(message("{ cells = 10 }"), HasSubstr("one of { surface = FILE"));
  EXPECT_THAT(message("{ surface = \"ball.stl\", mesher = \"gmsh\" }"),
              AllOf(HasSubstr("body[0].mesh.mesher"), HasSubstr("fitted")));
  EXPECT_THAT(message("{ box = { size = [1, 1, 1], cells = [1, 1, 1] }, mesher = \"fitted\" }"),
              HasSubstr("is for a surface"));
  EXPECT_THAT(message("{ surface = \"ball.stl\" }", "[simulation]\ndimension = 2\n"),
              HasSubstr("dimension 2"));
}

/// A cube [0, 1]^3 that is moved along x, its lid a group of its own.
std::string cube_of_obj(double x, const std::string& sides, const std::string& lid, int first) {
  std::ostringstream text;
  for (int c = 0; c < 8; ++c) text << "v " << x + c % 2 << ' ' << c / 2 % 2 << ' ' << c / 4 << '\n';
  const auto quad = [&](int a, int b, int c, int d) {
    text << "f " << first + a << ' ' << first + b << ' ' << first + c << ' ' << first + d << '\n';
  };
  text << "g " << sides << '\n';
  quad(0, 2, 3, 1);
  quad(0, 1, 5, 4);
  quad(1, 3, 7, 5);
  quad(3, 2, 6, 7);
  quad(2, 0, 4, 6);
  text << "g " << lid << '\n';
  quad(4, 5, 7, 6);
  return text.str();
}

TEST(GroupsOfASurface, SelectVerticesAndCellsOfItsBody) {
  const TemporaryFolder folder;
  folder.write("lid.obj", cube_of_obj(0, "sides", "lid", 1));
  folder.write("two.obj", cube_of_obj(0, "left", "left", 1) + cube_of_obj(4, "right", "right", 9));
  const auto mesh_of = [&](const std::string& file, const std::string& mesher) {
    return read_scene_from_text("[[body]]\nmesh = { surface = \"" + file + "\", cells = 500, mesher = \"" +
                                    mesher + "\" }\n[[fix]]\nwhere = \"all\"\n",
                                "a.toml", folder.path(), {})
        .description.bodies[0]
        .mesh;
  };
  const Mesh lid = mesh_of("lid.obj", "fitted");
  ASSERT_NE(lid.find_group("lid"), nullptr);
  for (const Index v : lid.find_group("lid")->vertices)
    EXPECT_NEAR(lid.vertices[static_cast<std::size_t>(v)].z(), 1, 1e-9);
  EXPECT_TRUE(lid.find_group("lid")->cells.empty());
  for (const std::string mesher : {"fitted", "lattice"}) {
    const Mesh two = mesh_of("two.obj", mesher);
    const Group *left = two.find_group("left"), *right = two.find_group("right");
    ASSERT_TRUE(left != nullptr && right != nullptr);
    ASSERT_TRUE(left->cells.size() == 1 && right->cells.size() == 1);
    if (mesher == "fitted") {
      EXPECT_EQ(left->cells[0].size() + right->cells[0].size(),
                static_cast<std::size_t>(two.blocks[0].num_cells()));
    }
    for (const Index v : left->vertices) EXPECT_LT(two.vertices[static_cast<std::size_t>(v)].x(), 2.5);
  }
}

TEST(SizeOfCells, TakesThePlaceOfTheirNumber) {
  const TemporaryFolder folder;
  folder.write("cube.obj", cube_of_obj(0, "sides", "lid", 1));
  const auto count = [&](const std::string& keys) {
    return read_scene_from_text(
               "[[body]]\nmesh = { surface = \"cube.obj\", " + keys + " }\n[[fix]]\nwhere = \"all\"\n",
               "a.toml", folder.path(), {})
        .description.bodies[0]
        .mesh.blocks[0]
        .num_cells();
  };
  EXPECT_GT(count("size = 0.1"), 4 * count("size = 0.2"));
  EXPECT_THAT(input_error([&] { count("size = 0.1, cells = 10"); }), HasSubstr("replaces cells"));
  EXPECT_THAT(input_error([&] { count("size = 1e-5"); }), HasSubstr("a size of cells"));
  EXPECT_THAT(input_error([&] { count("size = 0.1, min_size = 0.2"); }),
              HasSubstr("min_size: expected at most the size, 0.1, got 0.2"));
  EXPECT_THAT(input_error([&] { count("min_size = 0.1, mesher = \"lattice\""); }),
              HasSubstr("is for fitted cells"));
  EXPECT_THAT(input_error([&] { count("min_size = 0"); }), HasSubstr("min_size: expected a number > 0"));
}

TEST_F(SurfaceMesh, IsCurvedForQuadraticElementsAlone) {
  write_ball();
  const auto mesh_of = [&](const std::string& element, const std::string& more = "") {
    return read_scene_from_text("[[body]]\nmesh = \"ball.stl\"\nelement = \"" + element + "\"\n" + more,
                                "a.toml", folder.path(), {})
        .description.bodies[0]
        .mesh;
  };
  for (const char* element : {"P2", "P2P0", "auto"})
    EXPECT_EQ(mesh_of(element).blocks[0].kind, CellKind::tetrahedron10) << element;
  EXPECT_EQ(mesh_of("P1").blocks[0].kind, CellKind::tetrahedron);
  // A rigid body has straight cells of the ball's mass.
  const Mesh rigid = mesh_of("auto", "rigid = { density = 1000 }\n");
  EXPECT_EQ(rigid.blocks[0].kind, CellKind::tetrahedron);
  EXPECT_NEAR(exact_volume(rigid, rigid.blocks[0]), volume_of_ball, 1e-2 * volume_of_ball);
  const Mesh mesh = mesh_of("P2");
  EXPECT_NEAR(exact_volume(mesh, mesh.blocks[0]), volume_of_ball, 2e-3 * volume_of_ball);
}

/// Surfaces of other projects, as they are or as the rim of a mesh.
struct SharedSurfaceMesh : ::testing::TestWithParam<std::string> {
  const TemporaryFolder folder;
};

TEST_P(SharedSurfaceMesh, GoesFromAnStlToAConvergedResult) {
  RESILIN_NEEDS_SHARED_MESH(GetParam());
  Mesh surface = read_mesh(*shared_mesh(GetParam())).mesh;
  if (surface.find_solid(3) != nullptr) surface = extract_surface(surface).mesh;
  write_binary_stl(folder / "a.stl", surface);
  for (const char* mesher : {"fitted", "lattice"}) {
    SCOPED_TRACE(mesher);
    const Scene scene =
        scene_of(folder / "a.stl", surface,
                 "{ surface = \"a.stl\", cells = 1500, mesher = \"" + std::string(mesher) + "\" }");
    expect_converged(scene, mesher == std::string("fitted") ? 0.01 : 0);  // relative to 0.1 m
  }
}

INSTANTIATE_TEST_SUITE_P(OfOtherProjects, SharedSurfaceMesh,
                         ::testing::Values("armadillo_skin.obj", "spot_surface.obj", "coarse_bunny.mesh",
                                           "bunny.mesh", "armadillo_13k.msh", "armadillo_coarse.node",
                                           "spot.mesh", "liver.mesh", "liver_small.mesh", "mat40x40.msh",
                                           "beam3_tet.veg"),
                         [](const auto& test) { return as_test_name(test.param); });

}  // namespace
}  // namespace resilin::testing
