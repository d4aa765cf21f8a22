#include "resilin/mesh/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

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

/// Two cells of a kind with a side between them, and the vertices of the second that are not on it.
struct Neighbours {
  std::string name;
  Mesh mesh;
  std::vector<Index> far;  ///< all at x = 2; the side is at x = 1
};

std::vector<Neighbours> all_neighbours() {
  Mesh tetrahedra, triangles;
  tetrahedra.vertices = {{0, 0.3, 0.3}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {2, 0.3, 0.3}};
  tetrahedra.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3, 1, 3, 2, 4}}};
  triangles.vertices = {{0, 0.3, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0.3, 0}};
  triangles.blocks = {{CellKind::triangle, {0, 1, 2, 1, 3, 2}}};
  std::vector<Neighbours> all = {{"tetrahedra", tetrahedra, {4}},
                                 {"triangles", triangles, {3}},
                                 {"hexahedra", make_hexahedron_box({2, 1, 1}, {2, 1, 1}), {}},
                                 {"quadrilaterals", make_quadrilateral_rectangle({2, 1}, {2, 1}), {}}};
  for (Neighbours& pair : all)
    if (pair.far.empty())
      for (std::size_t v = 0; v < pair.mesh.vertices.size(); ++v)
        if (pair.mesh.vertices[v].x() == 2) pair.far.push_back(static_cast<Index>(v));
  return all;
}

/// The second cell laid over the first one, in each order of their vertices.
TEST(CheckMesh, RefusesTwoCellsOnOneSideOfTheirSide) {
  for (const Neighbours& pair : all_neighbours()) {
    const int dim =
        dimension(pair.mesh.find_solid(3) != nullptr ? CellKind::tetrahedron : CellKind::triangle);
    for (const double x : {-1.0, 0.5, 2.0})
      for (int turned = 0; turned < 4; ++turned) {
        Mesh mesh = pair.mesh;
        for (const Index v : pair.far) mesh.vertices[static_cast<std::size_t>(v)].x() = x;
        CellBlock& block = mesh.block(mesh.find_solid(dim)->kind);
        std::vector<Index> nodes;
        for (Index cell = 0; cell < 2; ++cell) {
          std::vector<Index> one(block.cell(cell).begin(), block.cell(cell).end());
          if ((turned >> cell & 1) != 0) turn_around(block.kind, one);
          nodes.insert(nodes.end(), one.begin(), one.end());
        }
        block.nodes = nodes;
        const MeshReport report = check_mesh(mesh, dim);
        SCOPED_TRACE(pair.name + " " + std::to_string(x) + " " + std::to_string(turned));
        if (x == 2) {
          EXPECT_TRUE(report.errors.empty());
        } else {
          EXPECT_THAT(only_error(report), AllOf(HasSubstr("elements 0, 1"), HasSubstr("on the same side")));
        }
      }
  }
}

TEST(CheckMesh, WarnsOfComponentsThatShareSpace) {
  for (const double x : {0.3, 0.5, 1.0, 1.5}) {
    Mesh mesh = make_box({1, 1, 1}, {2, 2, 2});
    const Mesh other = make_box({1, 1, 1}, {2, 2, 2}, {x, 0.1, 0.2});
    const auto shift = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    std::vector<Index>& nodes = mesh.block(CellKind::tetrahedron).nodes;
    for (const Index node : other.find_solid(3)->nodes) nodes.push_back(node + shift);
    const MeshReport report = check_mesh(mesh, 3);
    EXPECT_TRUE(report.errors.empty());
    std::string all;
    for (const MeshIssue& issue : report.warnings) all += issue.text() + "\n";
    EXPECT_EQ(all.find("share space") != std::string::npos, x < 1) << x << "\n" << all;
  }
}

TEST(CheckSurface, WarnsWhereItIsOpen) {
  const Mesh box = make_box({1, 1, 1}, {2, 2, 2});
  Mesh surface;
  surface.vertices = box.vertices;
  surface.blocks = {boundary(*box.find_solid(3)).facets};
  const auto words_of = [](const Mesh& mesh) {
    std::string all;
    for (const MeshIssue& issue : check_surface(mesh).warnings) all += issue.text() + "\n";
    return all;
  };
  EXPECT_THAT(words_of(surface), ::testing::Not(HasSubstr("open")));
  for (const std::size_t missing : {1U, 2U, 5U}) {
    Mesh open = surface;
    open.blocks[0].nodes.resize(open.blocks[0].nodes.size() - 3 * missing);
    EXPECT_THAT(words_of(open), AllOf(HasSubstr("edge "), HasSubstr("the surface is open there"))) << missing;
  }
  // Vertices that are given again for each triangle: closed by places.
  Mesh soup;
  soup.blocks = {{CellKind::triangle, {}}};
  for (const Index node : surface.blocks[0].nodes) {
    soup.blocks[0].nodes.push_back(static_cast<Index>(soup.vertices.size()));
    soup.vertices.push_back(surface.vertices[static_cast<std::size_t>(node)]);
  }
  EXPECT_THAT(words_of(soup), ::testing::Not(HasSubstr("open")));
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
  EXPECT_EQ(only_warning(check_mesh(mesh, 3)),
            "mesh: vertex 3: a bow tie: tetrahedra are connected only through it; such a joint transmits no "
            "moment");
  Numbering numbering;
  numbering.first_vertex = 1;
  EXPECT_THAT(check_mesh(mesh, 3, numbering).warnings[0].text(), HasSubstr("vertex 4: a bow tie"));
}

TEST(CheckMesh, NamesAHinge) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  mesh.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3, 0, 1, 4, 5}}};
  EXPECT_THAT(check_mesh(mesh, 3).warnings[0].text(),
              HasSubstr("edge 0-1: tetrahedra are connected only along it"));
}

TEST(CheckSurface, NamesABowTie) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.blocks = {{CellKind::triangle, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,
                                       0, 5, 4, 0, 4, 6, 0, 6, 5, 4, 5, 6}}};  // two tetrahedra
  EXPECT_THAT(only_warning(check_surface(mesh)), HasSubstr("vertex 0: a bow tie: triangles are connected"));
}

}  // namespace
}  // namespace resilin
