#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.hpp"
#include "resilin/io/mesh_file.hpp"
#include "solid_volume.hpp"
#include "temporary_folder.hpp"

// Input files of Abaqus and CalculiX.

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::mesh_file;
using testing::refusal;
using testing::solid_volume;

std::size_t group_size(const Mesh& mesh, const std::string& name) {
  const Group* group = mesh.find_group(name);
  return group == nullptr ? 0 : group->vertices.size();
}

Vector3 corner_of(const Mesh& mesh, const std::string& group) {
  Vector3 least = Vector3::Constant(1e9);
  for (const Index v : mesh.find_group(group)->vertices)
    least = least.cwiseMin(mesh.vertices[static_cast<std::size_t>(v)]);
  return least;
}

const std::string tetrahedron = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";

TEST(Abaqus, PlacesThePartsOfInstances) {
  const MeshFile file = read_mesh(mesh_file("parts.inp"));
  EXPECT_EQ(file.format, "Abaqus");
  EXPECT_EQ(file.mesh.vertices.size(), 22u);
  EXPECT_EQ(file.mesh.find_block(CellKind::hexahedron)->num_cells(), 2);
  EXPECT_EQ(file.mesh.find_block(CellKind::prism)->num_cells(), 1);
  // Moved by 3 along x, then turned by 90 degrees about the axis at x = 3: on its other side.
  EXPECT_LT((corner_of(file.mesh, "Bar-2") - Vector3(2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((corner_of(file.mesh, "Wedge-1") - Vector3(5, 0, 0)).norm(), 1e-12);
}

TEST(Abaqus, HasSetsAndSurfacesAsGroups) {
  const Mesh mesh = read_mesh(mesh_file("parts.inp")).mesh;
  EXPECT_EQ(group_size(mesh, "Bar-1.bottom"), 4u);
  EXPECT_EQ(group_size(mesh, "Bar-2.bottom"), 4u);
  EXPECT_EQ(group_size(mesh, "held"), 6u);  // bottom of one, a corner and node 3 of the other
  EXPECT_EQ(group_size(mesh, "both"), 16u);
  EXPECT_EQ(group_size(mesh, "wedge"), 6u);
  EXPECT_EQ(group_size(mesh, "Bar-1.top"), 4u);
  for (const Index v : mesh.find_group("Bar-1.top")->vertices)
    EXPECT_EQ(mesh.vertices[static_cast<std::size_t>(v)].z(), 1);
  EXPECT_EQ(group_size(mesh, "sides"), 7u);  // a quadrilateral and a triangle
  EXPECT_EQ(mesh.find_group("_top_S2"), nullptr);
}

TEST(Abaqus, CutsWedgesBesideHexahedra) {
  const MeshFile file = read_solid_mesh(mesh_file("parts.inp"), 3);
  EXPECT_NEAR(solid_volume(file.mesh), 2.5, 1e-12);
  EXPECT_THAT(file.warnings.front(), HasSubstr("2 hexahedra and 1 prisms are cut into 15 tetrahedra"));
  EXPECT_EQ(group_size(file.mesh, "Wedge-1"), 6u);
}

TEST(Abaqus, ReadsSecondOrderTetrahedraWithTheirMiddleNodes) {
  const MeshFile file = read_mesh(mesh_file("second_order.inp"));
  const CellBlock* block = file.mesh.find_block(CellKind::tetrahedron10);
  ASSERT_NE(block, nullptr);
  const auto X = [&](std::size_t n) {
    return file.mesh.vertices[static_cast<std::size_t>(block->cell(0)[n])];
  };
  const auto edges = cell_edges(CellKind::tetrahedron10);
  for (std::size_t e = 0; e < edges.size(); ++e)
    EXPECT_EQ(X(4 + e),
              0.5 * (X(static_cast<std::size_t>(edges[e][0])) + X(static_cast<std::size_t>(edges[e][1]))));
  EXPECT_EQ(group_size(file.mesh, "BASE"), 6u);
  EXPECT_EQ(group_size(file.mesh, "EALL"), 10u);
  EXPECT_EQ(file.mesh.vertices[10], Vector3(0.5, 0.1, 3));  // 0.5D0, 1.D-1
  EXPECT_THAT(file.warnings, ::testing::ElementsAre(HasSubstr("elements SPRINGA are skipped")));
}

TEST(Abaqus, ReadsCellsOfThePlane) {
  const MeshFile file = read_solid_mesh(mesh_file("plane.inp"), 2);
  EXPECT_EQ(file.mesh.find_block(CellKind::triangle)->num_cells(), 3);
  EXPECT_EQ(file.mesh.find_group("left")->vertices, (std::vector<Index>{0, 3}));
  EXPECT_EQ(file.mesh.find_group("quads")->cells[0].size(), 2u);
}

TEST(Abaqus, TakesHexahedraOf20NodesByTheirCorners) {
  std::string text = "*NODE\n";
  for (int i = 0; i < 20; ++i)
    text += std::to_string(i + 1) + ", " + std::to_string(i % 4 == 1 || i % 4 == 2) + ", " +
            std::to_string(i % 4 > 1) + ", " + std::to_string(i / 4) + "\n";
  text +=
      "*ELEMENT, TYPE=C3D20R\n1, 1,2,3,4,5,6,7,8,9,10\n11,12,13,14,15,16,17,18,19,20\n*NSET, NSET=all, "
      "GENERATE\n1, 20\n";
  const MeshFile file = read_mesh_from_memory("a.inp", text);
  EXPECT_EQ(file.mesh.vertices.size(), 8u);
  EXPECT_EQ(group_size(file.mesh, "all"), 8u);
  EXPECT_THAT(file.warnings,
              ::testing::ElementsAre(HasSubstr("1 second-order hexahedra are used by their corners")));
}

TEST(Abaqus, HasShellsInSpaceAsASurface) {
  MeshFile file = read_mesh_from_memory(
      "a.inp", "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,1\n4,0,1,1\n*ELEMENT,TYPE=S4R\n1,1,2,3,4\n");
  EXPECT_TRUE(file.is_surface);
  prepare_surface(file);
  EXPECT_EQ(file.mesh.find_block(CellKind::triangle)->num_cells(), 2);
}

TEST(Abaqus, IncludesFilesOfItsOwnFolderAlone) {
  const testing::TemporaryFolder folder;
  folder.write("nodes.inp", tetrahedron);
  const auto main =
      folder.write("main.inp", "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n");
  EXPECT_EQ(read_mesh(main).mesh.vertices.size(), 4u);
  const auto with = [](const std::string&) { return std::string("*INCLUDE, INPUT=a.inp\n"); };
  EXPECT_THAT(refusal("a.inp", "*INCLUDE, INPUT=a.inp\n", with), HasSubstr("files inside each other"));
  for (const char* name : {"../a.inp", "/etc/passwd", "C:\\a.inp", "..\\a.inp"})
    EXPECT_THAT(refusal("a.inp", "*NODE\n*INCLUDE, INPUT=" + std::string(name) + "\n", with),
                AllOf(HasSubstr("a.inp: line 2"), HasSubstr("a file beside this one")))
        << name;
}

struct Fault {
  std::string text;
  std::vector<std::string> words;
};

TEST(Abaqus, NamesLineAndCure) {
  const std::vector<Fault> faults = {
      {"1, 2, 3\n", {"line 1", "a keyword such as *NODE"}},
      {"*NODE\n1, 0, x, 0\n", {"line 2", "a coordinate of node 1", "got x"}},
      {"*NODE\n1, 0\n", {"line 2", "two or three coordinates"}},
      {"*NODE\n0, 0, 0, 0\n", {"line 2", "a node number from 1"}},
      {"*NODE\n1, 0, 0, 1e999\n", {"line 2", "finite"}},
      {"*NODE, SYSTEM=C\n1, 1, 90, 0\n", {"line 1", "Cartesian"}},
      {tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3\n",
       {"line 7", "4 nodes of element 1 of type C3D4", "got 3"}},
      {tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 9\n", {"element 1", "from 1 to 4", "got 9"}},
      {tetrahedron + "*ELEMENT\n1, 1, 2, 3, 4\n", {"line 6", "type=..."}},
      {tetrahedron + "*NGEN\n1, 4\n", {"line 6", "*ngen", "CalculiX"}},
      {tetrahedron + "*NSET, NSET=a\nbotom\n*NSET, NSET=bottom\n1\n",
       {"line 6", "given before \"a\"", "botom"}},
      {tetrahedron + "*NSET, NSET=bottom\n1\n*NSET, NSET=a\nbotom\n", {"line 8", "did you mean \"bottom\""}},
      {tetrahedron + "*ELEMENT, TYPE=SPRINGA\n1, 1, 2\n", {"no elements"}},
      {"*PART, NAME=a\n", {"*END PART", "the end of the file"}},
      {"*INSTANCE, NAME=a, PART=b\n", {"line 1", "a *PART before it"}},
      {"*END PART\n", {"line 1"}},
  };
  for (const Fault& fault : faults) {
    const std::string message = refusal("a.inp", fault.text);
    EXPECT_THAT(message, HasSubstr("a.inp")) << fault.text;
    for (const std::string& word : fault.words) EXPECT_THAT(message, HasSubstr(word)) << fault.text;
  }
}

TEST(Abaqus, WarnsOfNumbersInSetsThatAreOfNothing) {
  const MeshFile file = read_mesh_from_memory(
      "a.inp", tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*NSET, NSET=a\n1, 7, 8\n");
  EXPECT_EQ(group_size(file.mesh, "a"), 1u);
  EXPECT_THAT(file.warnings, ::testing::ElementsAre(HasSubstr("2 ids in sets, such as 7 in \"a\"")));
}

}  // namespace
}  // namespace resilin
