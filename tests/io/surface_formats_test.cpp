#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "refusal.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/mesh/quality.hpp"
#include "shared_data.hpp"
#include "test_names.hpp"

// STL and PLY: what they may hold, and what they may not. The cubes were written by meshio and by hand
// (tests/data/make_meshes.py).

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::refusal;
using ::testing::StartsWith;

std::string bytes_of(const std::string& name) {
  return read_file(testing::source_folder() / "tests" / "data" / "meshes" / name);
}

double enclosed_volume(const Mesh& mesh) {
  double volume = 0;
  const CellBlock& triangles = *mesh.find_block(CellKind::triangle);
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(triangles.cell(t)[i])];
    };
    volume += X(0).dot(X(1).cross(X(2))) / 6;
  }
  return volume;
}

class CubeSurface : public ::testing::TestWithParam<std::string> {};

TEST_P(CubeSurface, IsTheClosedUnitCubeOf12TrianglesAnd8Vertices) {
  const MeshFile cube = read_mesh_from_memory(GetParam(), bytes_of(GetParam()));
  EXPECT_TRUE(cube.is_surface);
  EXPECT_EQ(cube.mesh.vertices.size(), 8u);
  ASSERT_EQ(cube.mesh.blocks.size(), 1u);
  EXPECT_EQ(cube.mesh.blocks[0].num_cells(), 12);
  EXPECT_TRUE(open_edges(cube.mesh, cube.mesh.blocks[0]).empty());
  EXPECT_DOUBLE_EQ(enclosed_volume(cube.mesh), 1);
  EXPECT_TRUE(check_mesh_file(cube).warnings.empty());
}

/// A file that ends before its triangles do is never a smaller mesh.
TEST_P(CubeSurface, IsRefusedWhenCutAnywhere) {
  const std::string bytes = bytes_of(GetParam());
  // The last number of a text may lose digits, and the name behind endsolid may be cut: that no reader can
  // see.
  const bool is_text = GetParam().find("ascii") != std::string::npos;
  const std::size_t least = is_text ? bytes.size() - 16 : bytes.find_last_not_of("\r\n ");
  for (std::size_t cut = 0; cut < least; ++cut)
    ASSERT_THAT(refusal(GetParam(), bytes.substr(0, cut)), StartsWith(GetParam())) << cut;
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, CubeSurface,
                         ::testing::Values("cube_ascii.stl", "cube_binary.stl", "cube_ascii.ply",
                                           "cube_binary.ply", "cube_big_endian.ply", "cube_ascii.vtp",
                                           "cube_base64.vtp", "cube_inline.vtp", "cube_raw.vtp",
                                           "cube_compressed.vtp", "cube_binary.glb", "cube_inline.gltf"),
                         [](const auto& test) { return testing::as_test_name(test.param); });

std::string facet(const std::string& corners) {
  return "facet normal nan 0 0\n outer loop\n " + corners + "\n endloop\nendfacet\n";
}
const std::string first_facet = facet("vertex 0 0 0 vertex 1 0 0 vertex 0 1 0");

TEST(Stl, JoinsCornersAtTheSamePlaceAndNoOthers) {
  const MeshFile file = read_mesh_from_memory(
      "a.stl",
      "solid a\n" + first_facet + facet("vertex 1 0 0 vertex -0 0 -0.0 vertex 0 1 1e-300") + "endsolid a\n");
  EXPECT_THAT(file.mesh.blocks[0].nodes, ElementsAre(0, 1, 2, 1, 0, 3));
}

TEST(Stl, SolidsWithNamesAreGroups) {
  const MeshFile file = read_mesh_from_memory(
      "a.stl", "solid left part\r\n" + first_facet + "endsolid left part\r\nSOLID\n" + first_facet +
                   "ENDSOLID\nsolid b\nendsolid\nsolid c\n" + first_facet + first_facet + "endsolid c");
  ASSERT_EQ(file.mesh.groups.size(), 2u);
  EXPECT_EQ(file.mesh.groups[0].name, "left part");
  EXPECT_THAT(file.mesh.groups[0].cells[0], ElementsAre(0));
  EXPECT_THAT(file.mesh.groups[1].cells[0], ElementsAre(2, 3));
  EXPECT_EQ(file.numbering.cell(0, 3), 4);
}

/// Many programs begin the header of a binary file with "solid".
TEST(Stl, BinaryFilesMayBeginWithSolid) {
  std::string bytes = bytes_of("cube_binary.stl");
  bytes.replace(0, 12, "solid facet\n");
  EXPECT_EQ(read_mesh_from_memory("a.stl", bytes).mesh.blocks[0].num_cells(), 12);
}

TEST(Stl, BytesBehindTheLastTriangleAreTold) {
  const MeshFile file = read_mesh_from_memory("a.stl", bytes_of("cube_binary.stl") + "xyz");
  EXPECT_EQ(file.mesh.blocks[0].num_cells(), 12);
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_THAT(file.warnings[0], HasSubstr("3 bytes"));
}

TEST(Stl, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(refusal("a.stl", ""), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal("a.stl", "solid a\nendsolid a\n"), HasSubstr("no triangles"));
  EXPECT_THAT(refusal("a.stl", "solid a\n" + first_facet), AllOf(HasSubstr("line 7"), HasSubstr("cut")));
  EXPECT_THAT(refusal("a.stl", "solid\n" + facet("vertex 0 0 0 vertex 1 nan 0 vertex 0 1 0") + "endsolid"),
              AllOf(HasSubstr("line 4"), HasSubstr("triangle 1"), HasSubstr("finite"), HasSubstr("got nan")));
  EXPECT_THAT(refusal("a.stl", "solid\n" + facet("vertex 0 0 0 vertex 1 0 0") + "endsolid"),
              AllOf(HasSubstr("line 5"), HasSubstr("expected vertex, got endloop")));
  std::string bytes = bytes_of("cube_binary.stl");
  EXPECT_THAT(refusal("a.stl", bytes.substr(0, 400)), AllOf(HasSubstr("684 bytes"), HasSubstr("12 triangles"),
                                                            HasSubstr("got 400"), HasSubstr("cut")));
  const float wrong = std::nanf("");
  std::memcpy(bytes.data() + 84 + 2 * 50 + 12, &wrong, 4);
  EXPECT_THAT(refusal("a.stl", bytes), AllOf(HasSubstr("triangle 3"), HasSubstr("finite")));
  EXPECT_THAT(refusal("a.stl", std::string(84, '\0')), HasSubstr("no triangles"));
}

std::string ply(const std::string& header, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}
const std::string three_vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string one_face = "element face 1\nproperty list uchar int vertex_index\n";
const std::string places = "0 0 0\n1 0 0\n0 1 0\n";

TEST(Ply, FacesMayComeBeforeTheVertices) {
  const MeshFile file = read_mesh_from_memory("a.ply", ply(one_face + three_vertices, "3 0 1 2\n" + places));
  EXPECT_THAT(file.mesh.blocks[0].nodes, ElementsAre(0, 1, 2));
}

TEST(Ply, IsToldByItsFirstLine) {
  EXPECT_EQ(read_mesh_from_memory("a.obj", ply(three_vertices + one_face, places + "3 0 1 2")).format, "PLY");
}

TEST(Ply, SaysWhatIsWrongAndWhere) {
  const std::string header = three_vertices + one_face;
  EXPECT_EQ(refusal("a.ply", ply(header, places + "3 0 1 2\n \n")), "");
  EXPECT_THAT(refusal("a.ply", ply(header, places + "3 0 1 2\n3 0 2 1\n")),
              AllOf(HasSubstr("the end of the file"), HasSubstr("8 more bytes")));
  EXPECT_THAT(refusal("a.ply", ply(header, places + "3 0 1 3\n")),
              AllOf(HasSubstr("face 0"), HasSubstr("from 0 to 2"), HasSubstr("got 3")));
  EXPECT_THAT(refusal("a.ply", ply(header, places + "3 0 1 -1\n")), HasSubstr("face 0"));
  EXPECT_THAT(refusal("a.ply", ply(header, places + "2 0 1\n")), HasSubstr("at least 3"));
  EXPECT_THAT(refusal("a.ply", ply(header, places + "3 0 1")),
              AllOf(HasSubstr("element face"), HasSubstr("cut")));
  EXPECT_THAT(refusal("a.ply", ply(header, "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n")),
              AllOf(HasSubstr("line 11"), HasSubstr("vertex 1"), HasSubstr("finite")));
  EXPECT_THAT(refusal("a.ply", ply(three_vertices, places)), HasSubstr("no faces"));
  EXPECT_THAT(refusal("a.ply", ply(one_face, "3 0 1 2\n")), HasSubstr("vertex"));
  EXPECT_THAT(
      refusal("a.ply", ply("element vertex 3\nproperty float x\nproperty float y\n", "0 0\n1 0\n0 1\n")),
      AllOf(HasSubstr("line 3"), HasSubstr("x, y and z")));
  EXPECT_THAT(refusal("a.ply", ply("element vertex 999999999\nproperty float x\n", "0\n")),
              HasSubstr("no room for more"));
  EXPECT_THAT(refusal("a.ply", ply("element vertex 3\n", "")), HasSubstr("properties of element vertex"));
  EXPECT_THAT(refusal("a.ply", ply("property float x\n", "")), HasSubstr("line 3"));
  EXPECT_THAT(refusal("a.ply", ply("element vertex 3\nproperty half x\n", "")), HasSubstr("half"));
  EXPECT_THAT(refusal("a.ply", "ply\nformat binary_middle_endian 1.0\nend_header\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal("a.ply", "ply\nelement vertex 0\nproperty int x\nend_header\n"), HasSubstr("format"));
}

}  // namespace
}  // namespace resilin
