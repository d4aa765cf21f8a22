#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

/// A box with all that a mesh can hold: overlapping groups, a group of vertices alone, fields on two blocks.
Mesh rich_box() {
  Mesh box = make_box({1, 2, 3}, {2, 1, 2}, {0.1, 1.0 / 3, -1e-7});
  box.groups.push_back({"some cells", {{0, 3, 5}}, {}});
  for (const Index cell : {0, 3, 5}) {
    const auto nodes = box.blocks[0].cell(cell);
    auto& vertices = box.groups.back().vertices;
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  box.groups.push_back({"probe", {}, {4, 7}});
  for (std::size_t b = 0; b < 2; ++b) {
    CellField field{"young " + std::to_string(b), b, {}};
    for (Index cell = 0; cell < box.blocks[b].num_cells(); ++cell) field.values.push_back(1e5 / (cell + 1));
    box.cell_fields.push_back(field);
  }
  return box;
}

Mesh written_and_read(const Mesh& mesh, const std::string& name) {
  const testing::TemporaryFolder folder;
  write_mesh(folder / name, mesh);
  return read_mesh(folder / name).mesh;
}

/// The same vertices bit by bit, and the same cells in the same order.
void expect_same_cells(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  for (const CellBlock& block : a.blocks) {
    ASSERT_NE(b.find_block(block.kind), nullptr) << name(block.kind);
    EXPECT_EQ(b.find_block(block.kind)->num_cells(), block.num_cells());
  }
}

void expect_same_order(const Mesh& a, const Mesh& b) {
  for (const CellBlock& block : a.blocks) EXPECT_EQ(b.find_block(block.kind)->nodes, block.nodes);
}

void expect_same_groups(const Mesh& a, const Mesh& b) {
  for (const Group& group : a.groups) {
    ASSERT_NE(b.find_group(group.name), nullptr) << group.name;
    EXPECT_EQ(b.find_group(group.name)->vertices, group.vertices) << group.name;
    for (std::size_t i = 0; i < group.cells.size(); ++i) {
      const auto kind = a.blocks[i].kind;
      for (std::size_t j = 0; j < b.blocks.size(); ++j) {
        if (b.blocks[j].kind != kind) continue;
        const auto& cells = b.find_group(group.name)->cells;
        EXPECT_EQ(j < cells.size() ? cells[j].size() : 0, group.cells[i].size()) << group.name;
      }
    }
  }
}

TEST(RoundTrip, VtuKeepsEverything) {
  const Mesh box = rich_box();
  const Mesh back = written_and_read(box, "a.vtu");
  expect_same_cells(box, back);
  expect_same_order(box, back);
  expect_same_groups(box, back);
  ASSERT_EQ(back.cell_fields.size(), 2u);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_EQ(back.cell_fields[f].name, box.cell_fields[f].name);
    EXPECT_EQ(back.cell_fields[f].block, box.cell_fields[f].block);
    EXPECT_EQ(back.cell_fields[f].values, box.cell_fields[f].values);
  }
}

/// MSH sorts cells by their groups; each cell keeps its value.
TEST(RoundTrip, MshKeepsGroupsAndFields) {
  const Mesh box = rich_box();
  const Mesh back = written_and_read(box, "a.msh");
  expect_same_cells(box, back);
  expect_same_groups(box, back);
  ASSERT_EQ(back.cell_fields.size(), 2u);
  for (const CellField& field : box.cell_fields) {
    const auto found = std::find_if(back.cell_fields.begin(), back.cell_fields.end(),
                                    [&](const CellField& f) { return f.name == field.name; });
    ASSERT_NE(found, back.cell_fields.end());
    const CellBlock& before = box.blocks[field.block];
    const CellBlock& after = back.blocks[found->block];
    for (Index cell = 0; cell < after.num_cells(); ++cell) {
      const auto nodes = after.cell(cell);
      Index same = 0;
      while (!std::equal(nodes.begin(), nodes.end(), before.cell(same).begin())) ++same;
      EXPECT_EQ(found->values[static_cast<std::size_t>(cell)], field.values[static_cast<std::size_t>(same)]);
    }
  }
}

TEST(RoundTrip, MshWithoutGroupsKeepsTheOrderOfCells) {
  Mesh box = make_box({1, 1, 1}, {2, 2, 2});
  box.groups.clear();
  const Mesh back = written_and_read(box, "a.msh");
  expect_same_cells(box, back);
  expect_same_order(box, back);
}

TEST(RoundTrip, MeditKeepsVerticesAndCells) {
  const Mesh box = rich_box();
  const Mesh back = written_and_read(box, "a.mesh");
  expect_same_cells(box, back);
  expect_same_order(box, back);
}

TEST(RoundTrip, ObjKeepsTheSurface) {
  const Mesh box = rich_box();
  const Mesh back = written_and_read(box, "a.obj");
  const Surface surface = extract_surface(box);
  expect_same_cells(surface.mesh, back);
  expect_same_order(surface.mesh, back);
}

TEST(RoundTrip, EveryKindOfCellPassesThroughMshAndVtu) {
  for (const CellKind kind : {CellKind::point, CellKind::line, CellKind::triangle, CellKind::quadrilateral,
                              CellKind::tetrahedron, CellKind::hexahedron, CellKind::prism, CellKind::pyramid,
                              CellKind::line3, CellKind::triangle6, CellKind::tetrahedron10}) {
    Mesh mesh;
    for (int i = 0; i < 10; ++i) mesh.vertices.emplace_back(i, i * i, 1.0 / (i + 1));
    for (int n = num_nodes(kind); n > 0; --n) mesh.block(kind).nodes.push_back(n - 1);
    for (const char* file : {"a.msh", "a.vtu"}) {
      const Mesh back = written_and_read(mesh, file);
      expect_same_cells(mesh, back);
      expect_same_order(mesh, back);
    }
  }
}

TEST(RoundTrip, TwoDimensionsPassThroughEveryFormat) {
  const Mesh mesh = make_rectangle({1, 1}, {3, 3});
  for (const char* file : {"a.msh", "a.vtu", "a.mesh"}) {
    const Mesh back = written_and_read(mesh, file);
    expect_same_cells(mesh, back);
  }
}

}  // namespace
}  // namespace resilin
