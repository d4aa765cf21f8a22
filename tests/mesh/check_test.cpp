#include "resilin/mesh/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Mesh two_tets() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3, 1, 2, 3, 4}}};
  return mesh;
}

std::string only_error(const MeshReport& report) {
  EXPECT_EQ(report.errors.size(), 1u);
  return report.errors.empty() ? "" : report.errors[0].text();
}

std::string only_warning(const MeshReport& report) {
  EXPECT_TRUE(report.errors.empty());
  EXPECT_EQ(report.warnings.size(), 1u);
  return report.warnings.empty() ? "" : report.warnings[0].text();
}

TEST(CheckMesh, HasNothingToSayAboutABox) {
  for (const TetPattern pattern : {TetPattern::kuhn6, TetPattern::five}) {
    const MeshReport report = check_mesh(make_box({1, 2, 3}, {2, 3, 4}, {1e3, 0, 0}, pattern), 3);
    EXPECT_TRUE(report.errors.empty());
    EXPECT_TRUE(report.warnings.empty());
  }
  EXPECT_TRUE(check_mesh(make_rectangle({1, 1}, {3, 3}), 2).warnings.empty());
}

TEST(CheckMesh, NamesTheKindsThatItFoundInstead) {
  EXPECT_EQ(only_error(check_mesh(make_rectangle({1, 1}, {1, 1}), 3)),
            "mesh: no tetrahedra (found triangles, lines)");
  EXPECT_EQ(only_error(check_mesh(Mesh{}, 3)), "mesh: no elements");
}

TEST(CheckMesh, RefusesOtherSolidCellsBesideTetrahedra) {
  Mesh mesh = two_tets();
  mesh.blocks.push_back({CellKind::pyramid, {0, 1, 2, 3, 4}});
  EXPECT_THAT(only_error(check_mesh(mesh, 3)), HasSubstr("pyramids"));
}

TEST(CheckMesh, RefusesNodesThatDoNotExist) {
  for (const Index node : {5, -1, std::numeric_limits<Index>::max()}) {
    Mesh mesh = two_tets();
    mesh.blocks[0].nodes[6] = node;
    EXPECT_THAT(only_error(check_mesh(mesh, 3)),
                AllOf(HasSubstr("element 1"), HasSubstr(std::to_string(node))));
  }
}

TEST(CheckMesh, RefusesCoordinatesThatAreNotFinite) {
  Mesh mesh = two_tets();
  mesh.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(only_error(check_mesh(mesh, 3)), HasSubstr("vertex 3"));
}

TEST(CheckMesh, RefusesA2DMeshThatLeavesItsPlane) {
  Mesh mesh = make_rectangle({1, 1}, {1, 1});
  mesh.vertices[2].z() = 0.5;
  EXPECT_THAT(only_error(check_mesh(mesh, 2)), AllOf(HasSubstr("vertex 2"), HasSubstr("z is not zero")));
}

TEST(CheckMesh, RefusesACellThatUsesANodeTwice) {
  Mesh mesh = two_tets();
  mesh.blocks[0].nodes[7] = 1;
  const MeshReport report = check_mesh(mesh, 3);
  ASSERT_FALSE(report.errors.empty());
  EXPECT_THAT(report.errors[0].text(), AllOf(HasSubstr("element 1"), HasSubstr("volume")));
}

TEST(CheckMesh, RefusesMoreThanTwoCellsAtOneSide) {
  Mesh mesh = two_tets();
  mesh.vertices.emplace_back(2, 2, 2);
  mesh.blocks[0].nodes.insert(mesh.blocks[0].nodes.end(), {1, 2, 3, 5});
  EXPECT_THAT(only_error(check_mesh(mesh, 3)), HasSubstr("elements 0, 1, 2"));
}

TEST(CheckMesh, ThrowsItsFirstErrorOnRequest) {
  EXPECT_NO_THROW(check_mesh(two_tets(), 3).require_no_errors());
  try {
    check_mesh(Mesh{}, 3).require_no_errors();
    FAIL() << "an empty mesh was accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "mesh: no elements");
  }
}

TEST(CheckMesh, ShowsAFewOfManyIssuesAndCountsTheRest) {
  Mesh mesh = two_tets();
  for (int i = 0; i < 10; ++i) mesh.vertices.emplace_back(3 + i, 0, 0);
  EXPECT_THAT(only_warning(check_mesh(mesh, 3)), HasSubstr("vertices 5, 6, 7, 8, 9 and 5 more"));
}

TEST(CheckMesh, NamesABowTie) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 1}, {0, -1, 1}, {0, 0, 2}};
  mesh.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3, 3, 4, 5, 6}}};
  const MeshReport report = check_mesh(mesh, 3);
  EXPECT_TRUE(report.errors.empty());
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_EQ(
      report.warnings[0].text(),
      "mesh: vertex 3: a bow tie: tetrahedra hang together only through it; such a joint holds no moment");
  EXPECT_THAT(report.warnings[1].text(), HasSubstr("parts are joined only at a single vertex"));
  Numbering numbering;
  numbering.first_vertex = 1;
  EXPECT_THAT(check_mesh(mesh, 3, numbering).warnings[0].text(), HasSubstr("vertex 4: a bow tie"));
}

TEST(CheckMesh, NamesAHinge) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  mesh.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3, 0, 1, 4, 5}}};
  EXPECT_THAT(check_mesh(mesh, 3).warnings[0].text(),
              HasSubstr("edge 0-1: tetrahedra hang together only along it"));
}

TEST(CheckSurface, NamesABowTie) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.blocks = {{CellKind::triangle, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,
                                       0, 5, 4, 0, 4, 6, 0, 6, 5, 4, 5, 6}}};  // two tetrahedra
  EXPECT_THAT(only_warning(check_surface(mesh)), HasSubstr("vertex 0: a bow tie: triangles hang together"));
}

}  // namespace
}  // namespace resilin
