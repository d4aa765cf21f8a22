#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
#include "temporary_folder.hpp"

// Valid and invalid content of the smaller text formats.

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::refusal;

TEST(Formats, AreToldByTheirFirstBytesBeforeTheirExtension) {
  const MeshFile file =
      read_mesh_from_memory("wrong.obj",
                            "MeshVersionFormatted 1\nDimension 2\nVertices 3 0 0 0 1 0 0 0 1 0\n"
                            "Triangles 1 1 2 3 0\nEnd\n");
  EXPECT_EQ(file.format, "Medit");
}

TEST(Formats, AreListedWhenAFileIsOfNone) {
  EXPECT_THAT(refusal("a.dxf", "solid"), AllOf(HasSubstr("a.dxf"), HasSubstr(".msh"), HasSubstr(".veg")));
  const testing::TemporaryFolder folder;
  EXPECT_THROW(write_mesh(folder / "a.dxf", Mesh{}), InputError);
}

TEST(Formats, AMissingFileIsNamed) {
  try {
    read_mesh("no/such/mesh.msh");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_STREQ(error.what(), "no/such/mesh.msh: no such file");
  }
}

TEST(Obj, SplitsPolygonsAndCountsBackFromTheLastVertex) {
  const MeshFile file =
      read_mesh_from_memory("a.obj",
                            "o thing\nv 0 0 0 1\nv 1 0 0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                            "g top\nf 1/1/1 2/1/1 3//1 4\ng\nf -4 -3 \\\n-2\n");
  EXPECT_EQ(file.mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 0, 2, 3, 0, 1, 2}));
  EXPECT_EQ(file.numbering.cell(0, 1), 1);  // both halves of face 1
  EXPECT_EQ(file.numbering.cell(0, 2), 2);
  ASSERT_NE(file.mesh.find_group("top"), nullptr);
  EXPECT_EQ(file.mesh.find_group("top")->cells[0], (std::vector<Index>{0, 1}));
}

TEST(Obj, RefusesNumbersOfNoVertex) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face :
       {"f 1 2 0", "f 1 2 -4", "f 1 2 99999999999999999999", "f 1 2 x", "f 1 2 /3", "f 1 2 3.5"}) {
    EXPECT_THAT(refusal("a.obj", vertices + face), HasSubstr("a.obj: line 4")) << face;
  }
  EXPECT_THAT(refusal("a.obj", "v 0 0\nf 1 1 1"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("a.obj", vertices), HasSubstr("no elements"));
}

TEST(Obj, ReadsLinesAndPoints) {
  const Mesh mesh =
      read_mesh_from_memory("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\np 3 -3\nf 1 2 3\n").mesh;
  ASSERT_EQ(mesh.blocks.size(), 3U);
  EXPECT_EQ(mesh.find_block(CellKind::line)->nodes, (std::vector<Index>{0, 1, 1, 2}));
  EXPECT_EQ(mesh.find_block(CellKind::point)->nodes, (std::vector<Index>{2, 0}));
  EXPECT_EQ(mesh.find_block(CellKind::triangle)->nodes, (std::vector<Index>{0, 1, 2}));
}

const std::string tetgen_nodes =
    "# made by hand\n4 3 1 1\n1 0 0 0 7.5 0\n2 1 0 0 7.5 3\n3 0 1 0 7.5 3\n4 0 0 1 7.5 0\n";
const std::string tetgen_elements = "1 4 1\n1 1 2 3 4 5 # region 5\n";

TEST(Tetgen, ReadsNumbersFromOneAttributesAndMarkers) {
  const MeshFile file =
      read_mesh_from_memory("a.node", tetgen_nodes, [](const std::string&) { return tetgen_elements; });
  EXPECT_EQ(file.mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(file.mesh.find_group("point_3")->vertices, (std::vector<Index>{1, 2}));
  EXPECT_EQ(file.mesh.find_group("volume_5")->cells[0], (std::vector<Index>{0}));
  EXPECT_EQ(file.numbering.vertex(0), 1);
}

TEST(Tetgen, IsTheSameFromEitherFile) {
  const testing::TemporaryFolder folder;
  const auto node = folder.write("a.node", tetgen_nodes);
  const auto ele = folder.write("a.ele", tetgen_elements);
  EXPECT_EQ(read_mesh(node).mesh.blocks[0].nodes, read_mesh(ele).mesh.blocks[0].nodes);
}

TEST(Tetgen, ReadsTrianglesIn2D) {
  const MeshFile file = read_mesh_from_memory(
      "a.ele", "1 3 0\n0 0 1 2\n", [](const std::string&) { return "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n"; });
  EXPECT_EQ(file.mesh.blocks[0].kind, CellKind::triangle);
}

TEST(Tetgen, NamesTheFileAndElementThatIsWrong) {
  const auto with = [](const std::string& text) { return [text](const std::string&) { return text; }; };
  EXPECT_THAT(refusal("a.node", tetgen_nodes, with("1 4 0\n1 1 2 3 5\n")),
              AllOf(HasSubstr("a.ele: element 1"), HasSubstr("got 5")));
  EXPECT_THAT(refusal("a.ele", tetgen_elements, with("4 3 0 0\n1 0 0 0\n1 1 0 0\n3 0 1 0\n4 0 0 1\n")),
              HasSubstr("node 1"));
  EXPECT_THAT(refusal("a.ele", "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n", with(tetgen_nodes)), HasSubstr("4 nodes"));
  EXPECT_THAT(refusal("a.ele", tetgen_elements, with("4 3 0 0\n1 0 0 0\n2 1 0")),
              HasSubstr("a.node: line 3"));
  EXPECT_THAT(refusal("a.node", tetgen_nodes), HasSubstr("two files"));
}

const std::string vega_mesh =
    "# Vega\n*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n*ELEMENTS\nTETS\n2 4 0\n1 1 2 "
    "3 4\n2 2 3 4 5\n"
    "*MATERIAL BODY\nENU, 1000, 1e7, 0.45\n*REGION\nallElements, BODY\n";

TEST(Vega, ReadsSetsOfElements) {
  const MeshFile file = read_mesh_from_memory("a.veg", vega_mesh + "*SET half\n2,\n*SET all\n1,2\n");
  EXPECT_EQ(file.mesh.find_group("half")->cells[0], (std::vector<Index>{1}));
  EXPECT_EQ(file.mesh.find_group("half")->vertices, (std::vector<Index>{1, 2, 3, 4}));
  EXPECT_EQ(file.mesh.find_group("all")->cells[0], (std::vector<Index>{0, 1}));
}

TEST(Vega, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(refusal("a.veg", vega_mesh + "*SET half\n3\n"),
              AllOf(HasSubstr("line 19"), HasSubstr("got 3")));
  EXPECT_THAT(refusal("a.veg", "*INCLUDE other.veg\n"), HasSubstr("INCLUDE"));
  EXPECT_THAT(refusal("a.veg", "VERTICES"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("a.veg", "*VERTICES\n1 3 0 0\n1 0 0 0\n*ELEMENTS\nHEXES\n"), HasSubstr("TET"));
}

TEST(Medit, ReadsTwoDimensionsAndReferences) {
  const MeshFile file = read_mesh_from_memory(
      "a.mesh",
      "MeshVersionFormatted\n2\n# comment\nDimension\n2\nVertices 4\n0 0 0\n1 0 9\n1 1 0\n0 1 0\n"
      "Corners\n2\n1\n2\nTriangles\n2\n1 2 3 4\n1 3 4 5\nEdges\n1\n1 2 6\nEnd\n");
  EXPECT_EQ(file.mesh.vertices[2], Vector3(1, 1, 0));
  EXPECT_EQ(file.mesh.find_group("surface_4")->cells[0], (std::vector<Index>{0}));
  EXPECT_EQ(file.mesh.find_group("curve_6")->vertices, (std::vector<Index>{0, 1}));
  EXPECT_EQ(file.mesh.find_group("point_9")->vertices, (std::vector<Index>{1}));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(Medit, WarnsWhenTheEndIsMissing) {
  const MeshFile file = read_mesh_from_memory(
      "a.mesh",
      "MeshVersionFormatted 1\nDimension 2\nVertices 3\n0 0 0\n1 0 0\n0 1 0\nTriangles 1\n1 2 3 0\n");
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_THAT(file.warnings[0], HasSubstr("cut"));
}

TEST(Medit, NamesLineAndElement) {
  const std::string head = "MeshVersionFormatted 1\nDimension 3\nVertices\n";
  EXPECT_THAT(refusal("a.mesh", head + "2000000000\n0 0 0 0\n"), HasSubstr("a.mesh: line 4"));
  EXPECT_THAT(refusal("a.mesh", head + "1\n0 0 inf 0\n"), AllOf(HasSubstr("line 5"), HasSubstr("vertex 1")));
  EXPECT_THAT(refusal("a.mesh", head + "1\n0 0 0 0\nTriangles\n1\n1 1 2 0\n"), HasSubstr("element 1"));
  EXPECT_THAT(refusal("a.mesh", "MeshVersionFormatted 9\n"), HasSubstr("version 9"));
  EXPECT_THAT(refusal("a.mesh", head + "1\n0 0 0 0\n0 1\n"), HasSubstr("keyword"));
}

/// Two tetrahedra with what CELLS says of them.
std::string vtk_with(const std::string& cells, const std::string& types = "CELL_TYPES 2\n10 10\n") {
  return "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
         "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n" +
         cells + types;
}

TEST(Vtk, SizesThatDoNotGoTogetherNameCells) {
  EXPECT_EQ(testing::refusal("a.vtk", vtk_with("CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\n")), "");
  for (const char* cells : {
           "CELLS 2 5\n4 0 1 2 3\n4 1 2 3 4\n",    // room for one
           "CELLS 2 9\n4 0 1 2 3\n4 1 2 3 4\n",    // the last one is cut
           "CELLS 2 11\n4 0 1 2 3\n4 1 2 3 4\n",   // takes the next keyword for an index
           "CELLS 2 12\n4 0 1 2 3\n4 1 2 3 4\n",   //
           "CELLS 1 10\n4 0 1 2 3\n4 1 2 3 4\n",   // fewer cells than sizes
           "CELLS 1 5\n4 0 1 2 3\n4 1 2 3 4\n",    // numbers are left over
           "CELLS 3 10\n4 0 1 2 3\n4 1 2 3 4\n",   // more cells than sizes
           "CELLS 2 10\n5 0 1 2 3\n4 1 2 3 4\n",   // a size too large
           "CELLS 2 10\n3 0 1 2 3\n4 1 2 3 4\n",   // a size too small
           "CELLS 2 10\n-4 0 1 2 3\n4 1 2 3 4\n",  //
           "CELLS 2 10\n0 0 1 2 3\n4 1 2 3 4\n",   //
           "CELLS 2 1000000\n4 0 1 2 3\n4 1 2 3 4\n",
       }) {
    EXPECT_THAT(testing::refusal("a.vtk", vtk_with(cells)), AllOf(HasSubstr("a.vtk"), HasSubstr("CELLS")))
        << cells;
  }
  EXPECT_THAT(testing::refusal("a.vtk", vtk_with("CELLS 2 9\n4 0 1 2 3\n3 1 2 3\n")),
              AllOf(HasSubstr("CELLS: cell 1"), HasSubstr("4 points")));
}

TEST(Vtk, OffsetsThatDoNotGoTogetherNameCells) {
  const auto file = [](const std::string& sizes, const std::string& offsets) {
    return vtk_with("CELLS " + sizes + "\nOFFSETS vtktypeint64\n" + offsets +
                    "\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\n");
  };
  EXPECT_EQ(testing::refusal("a.vtk", file("3 8", "0 4 8")), "");
  for (const char* offsets : {"0 4 7", "0 4 9", "0 9 8", "1 4 8", "0 -4 8", "0 8 4"})
    EXPECT_THAT(testing::refusal("a.vtk", file("3 8", offsets)), HasSubstr("CELLS")) << offsets;
  for (const char* sizes : {"2 8", "4 8", "3 7", "3 9"})
    EXPECT_THAT(testing::refusal("a.vtk", file(sizes, "0 4 8")), HasSubstr("CELLS")) << sizes;
}

}  // namespace
}  // namespace resilin
