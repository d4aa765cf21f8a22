#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "solid_volume.hpp"

// Meshes of FEBio, Nastran, universal files, OFF, 3MF, surfaces and structured grids of VTK, and old MSH
// files.

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::mesh_file;
using testing::refusal;
using testing::solid_volume;

std::vector<Index> group_vertices(const Mesh& mesh, const std::string& name) {
  const Group* group = mesh.find_group(name);
  return group == nullptr ? std::vector<Index>{} : group->vertices;
}

double enclosed(const Mesh& mesh) {
  const CellBlock& triangles = *mesh.find_block(CellKind::triangle);
  double volume = 0;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(triangles.cell(t)[i])];
    };
    volume += X(0).dot(X(1).cross(X(2))) / 6;
  }
  return volume;
}

TEST(Febio, ReadsTheMeshOfVersion4) {
  const MeshFile file = read_solid_mesh(mesh_file("cube_4.feb"), 3);
  EXPECT_NEAR(solid_volume(file.mesh), 1.5, 1e-12);
  EXPECT_EQ(group_vertices(file.mesh, "Bottom"), (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(group_vertices(file.mesh, "Left"), (std::vector<Index>{0, 3, 4, 7}));
  EXPECT_EQ(group_vertices(file.mesh, "Wedge"), (std::vector<Index>{4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(group_vertices(file.mesh, "All").size(), 10u);
  EXPECT_EQ(group_vertices(file.mesh, "Part").size(), 8u);
}

TEST(Febio, ReadsTheGeometryOfVersion25) {
  const MeshFile file = read_solid_mesh(mesh_file("tet_25.feb"), 3);
  EXPECT_NEAR(solid_volume(file.mesh), 1.0 / 6, 1e-12);
  EXPECT_EQ(group_vertices(file.mesh, "Fixed"), (std::vector<Index>{0, 1}));
  EXPECT_EQ(group_vertices(file.mesh, "Load"), (std::vector<Index>{0, 1, 2}));
  for (const char* group : {"Part1", "Soft & wet", "Set"})
    EXPECT_EQ(group_vertices(file.mesh, group).size(), 4u) << group;
}

std::string feb(const std::string& mesh) {
  return "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Mesh>\n<Nodes>\n<node "
         "id=\"1\">0,0,0</node>\n"
         "<node id=\"2\">1,0,0</node>\n<node id=\"3\">0,1,0</node>\n<node id=\"4\">0,0,1</node>\n</Nodes>\n" +
         mesh + "\n</Mesh>\n</febio_spec>\n";
}

TEST(Febio, NamesLineAndCure) {
  EXPECT_THAT(refusal("a.feb", feb("<Elements type=\"tet4\">\n<elem id=\"1\">1,2,3</elem>\n</Elements>")),
              AllOf(HasSubstr("a.feb: line 11"), HasSubstr("4 nodes of tet4 1"), HasSubstr("got 3")));
  EXPECT_THAT(refusal("a.feb", feb("<Elements type=\"tet4\">\n<elem id=\"1\">1,2,3,7</elem>\n</Elements>")),
              AllOf(HasSubstr("element 1"), HasSubstr("from 1 to 4"), HasSubstr("got 7")));
  EXPECT_THAT(refusal("a.feb", feb("<Elements type=\"ring8\">\n<elem id=\"1\">1</elem>\n</Elements>")),
              AllOf(HasSubstr("line 11"), HasSubstr("tet4, tet10 or hex8"), HasSubstr("ring8")));
  EXPECT_THAT(refusal("a.feb", feb("<NodeSet name=\"a\">1,9</NodeSet>")),
              AllOf(HasSubstr("line 10"), HasSubstr("the id of a node in \"a\""), HasSubstr("got 9")));
  EXPECT_THAT(
      refusal("a.feb", "<?xml version=\"1.0\"?>\n<febio_spec>\n<Mesh><Nodes>\n<node id=\"1\">0,,0</node>"),
      AllOf(HasSubstr("line 4"), HasSubstr("3 coordinates of node 1")));
  EXPECT_THAT(refusal("a.feb", feb("")), HasSubstr("no elements"));
  EXPECT_THAT(refusal("a.feb", "<?xml version=\"1.0\"?><other/>"), HasSubstr("<febio_spec>"));
  const std::string elsewhere = "<?xml version=\"1.0\"?><febio_spec>\n<Mesh from=\"../b.feb\"/></febio_spec>";
  EXPECT_THAT(refusal("a.feb", elsewhere), AllOf(HasSubstr("line 2"), HasSubstr("a file beside this one")));
}

/// A document that defines entities gets them as they stand, which is no number.
TEST(Febio, ExpandsNoEntities) {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE a [<!ENTITY b \"1\"><!ENTITY c SYSTEM \"/etc/passwd\">]>\n"
      "<febio_spec>\n<Mesh><Nodes>\n<node id=\"&b;\">0,0,&c;</node></Nodes></Mesh></febio_spec>";
  EXPECT_THAT(refusal("a.feb", text), AllOf(HasSubstr("line 5"), HasSubstr("&b;")));
}

TEST(Febio, TakesTheMeshOfAnotherFileOfItsFolder) {
  const std::string main = "<?xml version=\"1.0\"?><febio_spec><Geometry from=\"b.feb\"/></febio_spec>";
  const std::string other = feb("<Elements type=\"tet4\"><elem id=\"1\">1,2,3,4</elem></Elements>");
  const MeshFile file = read_mesh_from_memory(
      "a.feb", main, [&](const std::string& name) { return name == "b.feb" ? other : ""; });
  EXPECT_EQ(file.mesh.find_block(CellKind::tetrahedron)->num_cells(), 1);
}

TEST(Nastran, ReadsSmallLargeAndFreeFields) {
  const MeshFile file = read_solid_mesh(mesh_file("mixed.bdf"), 3);
  EXPECT_NEAR(solid_volume(file.mesh), 1 + 0.5 + 1.0 / 6, 1e-12);
  EXPECT_EQ(group_vertices(file.mesh, "volume_1").size(), 8u);
  EXPECT_EQ(group_vertices(file.mesh, "volume_3").size(), 4u);
  EXPECT_EQ(group_vertices(file.mesh, "surface_4"), (std::vector<Index>{0, 1, 2, 3}));
}

TEST(Nastran, NamesLineAndCure) {
  const std::string grid = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n";
  EXPECT_THAT(refusal("a.bdf", grid + "CTETRA,1,1,1,2,3,x\n"),
              AllOf(HasSubstr("a.bdf: line 5"), HasSubstr("a node of element 1"), HasSubstr("got x")));
  EXPECT_THAT(refusal("a.bdf", grid + "CTETRA,1,1,1,2,3\n"),
              AllOf(HasSubstr("line 5"), HasSubstr("got nothing")));
  EXPECT_THAT(refusal("a.bdf", grid + "CTETRA,1,1,1,2,3,5\n"),
              AllOf(HasSubstr("element 1"), HasSubstr("got 5")));
  EXPECT_THAT(refusal("a.bdf", "GRID,1,7,0.,0.,0.\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("global coordinates")));
  EXPECT_THAT(refusal("a.bdf", "GRID,1,,0.,1.e999,0.\n"), AllOf(HasSubstr("line 1"), HasSubstr("finite")));
  EXPECT_THAT(refusal("a.bdf", grid), HasSubstr("no elements"));
  EXPECT_THAT(refusal("a.bdf", "INCLUDE 'b.bdf'\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("copy the included")));
}

TEST(Unv, ReadsElementsAndGroups) {
  const MeshFile file = read_solid_mesh(mesh_file("cube.unv"), 3);
  EXPECT_NEAR(solid_volume(file.mesh), 1, 1e-12);
  EXPECT_EQ(group_vertices(file.mesh, "below").size(), 8u);
  EXPECT_EQ(group_vertices(file.mesh, "corner and edge"), (std::vector<Index>{0, 1, 4}));
}

TEST(Unv, NamesLineAndCure) {
  EXPECT_THAT(refusal("a.unv", "hello\n"),
              AllOf(HasSubstr("a.unv: line 1"), HasSubstr("-1 before a dataset")));
  EXPECT_THAT(refusal("a.unv", "-1\n2411\n1 1 1 11\n0 0\n-1\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("coordinates of node 1")));
  EXPECT_THAT(refusal("a.unv", "-1\n2412\n1 111 2 1 7 4\n1 2 3\n-1\n"),
              AllOf(HasSubstr("line 5"), HasSubstr("nodes of element 1")));
  EXPECT_THAT(refusal("a.unv", "-1\n2467\n1 0 0 0 0 0 0 99999999\nname\n-1\n"), HasSubstr("line 3"));
}

class CubeOfPolygons : public ::testing::TestWithParam<const char*> {};

TEST_P(CubeOfPolygons, IsAClosedSurface) {
  const MeshFile file = read_mesh(mesh_file(GetParam()));
  EXPECT_TRUE(file.is_surface);
  EXPECT_NEAR(enclosed(file.mesh), 1, 1e-12);
  EXPECT_TRUE(check_mesh_file(file).warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(OfOtherPrograms, CubeOfPolygons, ::testing::Values("cube.off", "cube_surface.vtk"),
                         [](const auto& test) { return test.index == 0 ? "Off" : "Vtk"; });

TEST(Off, NamesLineAndCure) {
  EXPECT_THAT(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n"),
              AllOf(HasSubstr("a.off: line 5"), HasSubstr("a coordinate of vertex 2")));
  EXPECT_THAT(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              AllOf(HasSubstr("face 0"), HasSubstr("got 3")));
  EXPECT_THAT(refusal("a.off", "OFF BINARY\n"), HasSubstr("OFF in text"));
  EXPECT_THAT(refusal("a.off", "4OFF\n"), HasSubstr("three coordinates"));
  EXPECT_THAT(refusal("a.off", "OFF\n99999999 1 0\n"), HasSubstr("no room for more"));
  EXPECT_EQ(refusal("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n"), "");
}

class ThreeMf : public ::testing::TestWithParam<const char*> {};

/// A cube and its mirror image, which a component moves: -1 to 1 and what lies behind, in metres.
TEST_P(ThreeMf, PlacesItsObjectsInMetres) {
  const MeshFile file = read_mesh(mesh_file(GetParam()));
  EXPECT_NEAR(enclosed(file.mesh), 2, 1e-9);
  EXPECT_EQ(file.mesh.vertices.size(), 16u);
  EXPECT_EQ(group_vertices(file.mesh, "cube").size(), 16u);
  double least = 0;
  for (const Vector3& X : file.mesh.vertices) least = std::min(least, X.x());
  EXPECT_NEAR(least, -3, 1e-12);
  EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("its unit is millimeter")));
}

INSTANTIATE_TEST_SUITE_P(DeflatedAndStored, ThreeMf, ::testing::Values("cubes.3mf", "cubes_stored.3mf"),
                         [](const auto& test) { return test.index == 0 ? "Deflated" : "Stored"; });

TEST(ThreeMfFile, IsRefusedWhereItIsCut) {
  const std::string bytes = read_file(mesh_file("cubes.3mf"));
  for (std::size_t size = 4; size < bytes.size(); size += 7)
    EXPECT_THAT(refusal("a.3mf", bytes.substr(0, size)), HasSubstr("a.3mf")) << size;
  EXPECT_THAT(refusal("a.3mf", "no zip"), AllOf(HasSubstr("ZIP archive"), HasSubstr("another kind")));
}

TEST(VtkLegacy, ReadsVoxelsAndStructuredGrids) {
  EXPECT_NEAR(solid_volume(read_solid_mesh(mesh_file("voxel.vtk"), 3).mesh), 1, 1e-12);
  const MeshFile grid = read_solid_mesh(mesh_file("rising.vtk"), 3);
  EXPECT_NEAR(solid_volume(grid.mesh), 2, 1e-12);
  EXPECT_EQ(grid.mesh.cell_fields[0].values, (std::vector<double>{1, 2}));
}

TEST(VtkLegacy, NamesSectionAndCureOfSurfaces) {
  const std::string head = "# vtk DataFile Version 3.0\na\nASCII\nDATASET ";
  const std::string points = "POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
  EXPECT_THAT(refusal("a.vtk", head + "STRUCTURED_POINTS\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("Threshold")));
  EXPECT_THAT(refusal("a.vtk", head + points), HasSubstr("points and lines alone are no surface"));
  EXPECT_THAT(refusal("a.vtk", head + points + "POLYGONS 1 4\n3 0 1 3\n"),
              AllOf(HasSubstr("cell 0"), HasSubstr("got 3")));
  EXPECT_THAT(refusal("a.vtk", head + points + "POLYGONS 1 3\n2 0 1\n"), HasSubstr("POLYGONS: cell 0"));
  EXPECT_THAT(
      refusal("a.vtk", head + "STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n"),
      HasSubstr("as many points as DIMENSIONS"));
}

TEST(VtkXml, IsReadUnderTheNameOfLegacyFiles) {
  const std::string text =
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" "
      "NumberOfComponents=\"3\" "
      "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" "
      "Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
      "format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray>"
      "</Cells></Piece></UnstructuredGrid></VTKFile>";
  EXPECT_EQ(read_mesh_from_memory("a.vtk", text).format, "VTU");
}

TEST(OldMsh, OfVersion1IsRead) {
  const MeshFile file = read_solid_mesh(mesh_file("tet_1.msh"), 3);
  EXPECT_EQ(file.format, "MSH 1");
  EXPECT_EQ(file.mesh.find_block(CellKind::tetrahedron)->num_cells(), 2);
  EXPECT_EQ(group_vertices(file.mesh, "volume_7"), (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(group_vertices(file.mesh, "surface_3"), (std::vector<Index>{0, 1, 2}));
  EXPECT_THAT(refusal("a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n1 4 1 1 3 1 1 1\n$ENDELM\n"),
              AllOf(HasSubstr("line 7"), HasSubstr("4 nodes of element 1"), HasSubstr("got 3")));
}

TEST(OldMsh, ParametersOfNodesArePassedOver) {
  const MeshFile file = read_solid_mesh(mesh_file("parametric_22.msh"), 2);
  EXPECT_EQ(file.mesh.find_block(CellKind::triangle)->num_cells(), 2);
  EXPECT_EQ(file.mesh.vertices[2], Vector3(1, 1, 0));
}

TEST(AWedge, GivenAsAHexahedronIsReadAsOne) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 0 1 "
      "1\n"
      "$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 1 4 5 6 4\n$EndElements\n";
  MeshFile file = read_mesh_from_memory("a.msh", text);
  EXPECT_NE(file.mesh.find_block(CellKind::prism), nullptr);
  prepare_solid_mesh(file, 3);
  EXPECT_NEAR(solid_volume(file.mesh), 0.5, 1e-12);
}

TEST(AFileOfNoKnownFormat, IsAnsweredWithWhatMakesAMeshOfIt) {
  EXPECT_THAT(refusal("a.xdmf", "<?xml version=\"1.0\"?><Xdmf/>"), HasSubstr("Mesh.from_meshio"));
  EXPECT_THAT(refusal("a.step", "ISO-10303-21;"), HasSubstr("gmsh"));
}

}  // namespace
}  // namespace resilin
