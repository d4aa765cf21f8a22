#include "resilin/mesh/mesh.hpp"

#include <gtest/gtest.h>

#include "resilin/mesh/numbering.hpp"

namespace resilin {
namespace {

TEST(Mesh, MakesABlockOfAKindOnce) {
  Mesh mesh;
  EXPECT_EQ(mesh.find_block(CellKind::tetrahedron), nullptr);
  mesh.block(CellKind::tetrahedron).nodes = {0, 1, 2, 3};
  mesh.block(CellKind::triangle).nodes = {0, 1, 2};
  EXPECT_EQ(mesh.block(CellKind::tetrahedron).num_cells(), 1);
  EXPECT_EQ(mesh.blocks.size(), 2u);
  EXPECT_EQ(mesh.find_block(CellKind::triangle)->cell(0)[2], 2);
}

TEST(Mesh, FindsAGroupByItsName) {
  Mesh mesh;
  mesh.groups = {{"left", {}, {1}}, {"right", {}, {2}}};
  EXPECT_EQ(mesh.find_group("right")->vertices[0], 2);
  EXPECT_EQ(mesh.find_group("lefft"), nullptr);
}

TEST(Numbering, CountsFromTheFirstNumberUnlessThereIsAList) {
  Numbering numbering;
  numbering.first_vertex = 1;
  numbering.cells = {{10, 20, 30}};
  EXPECT_EQ(numbering.vertex(4), 5);
  EXPECT_EQ(numbering.cell(0, 2), 30);
  EXPECT_EQ(numbering.cell(1, 2), 2);
}

TEST(Numbering, ListsTheFirstFewAndCountsTheRest) {
  Numbering numbering;
  numbering.first_vertex = numbering.first_cell = 1;
  EXPECT_EQ(numbering.vertex_list(std::vector<Index>{4}), "vertex 5");
  EXPECT_EQ(numbering.vertex_list(std::vector<Index>{2, 5}), "vertices 3 and 6");
  EXPECT_EQ(numbering.cell_list(0, std::vector<Index>{0, 2}), "elements 1, 3");
  EXPECT_EQ(numbering.cell_list(0, std::vector<Index>{0, 1, 2, 3, 4, 5, 6}),
            "elements 1, 2, 3, 4, 5 and 2 more");
}

}  // namespace
}  // namespace resilin
