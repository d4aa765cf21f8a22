#include "resilin/view/shown_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/facet.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

Description bar_of(const std::string& element, int dim) {
  Description scene = small_bar(dim, true);
  BodyDescription& body = scene.bodies[0];
  body.element = element;
  if (element == "Q1")
    body.mesh = dim == 3 ? make_hexahedron_box({1, 0.25, 0.25}, {8, 2, 2})
                         : make_quadrilateral_rectangle({1, 0.25}, {8, 2});
  return scene;
}

Vector3 vertex(const std::vector<float>& places, std::uint32_t v) {
  return Eigen::Map<const Eigen::Vector3f>(places.data() + 3 * std::size_t{v}).cast<double>();
}

std::vector<float> places_of(const ShownSurface& surface, const VectorX& x) {
  std::vector<float> places(static_cast<std::size_t>(3 * surface.num_vertices()));
  surface.positions(x, places);
  return places;
}

struct Case {
  const char* element;
  int dim;
  int triangles;  ///< triangles of the boundary of 8 x 2 x 2 cubes, in 2D of 8 x 2 squares
};
constexpr std::array<Case, 6> every_cell = {
    {{"P1", 3, 144}, {"P2", 3, 4 * 144}, {"Q1", 3, 144}, {"P1", 2, 32}, {"P2", 2, 4 * 32}, {"Q1", 2, 32}}};

TEST(ShownSurface, IsClosedAndTurnedOutwardsForEveryKindOfCell) {
  for (const Case& c : every_cell) {
    SCOPED_TRACE(std::string(c.element) + " in " + std::to_string(c.dim) + "D");
    const World world(bar_of(c.element, c.dim));
    const ShownSurface surface(world);
    EXPECT_EQ(surface.triangles().size(), static_cast<std::size_t>(c.triangles));
    const std::vector<float> places = places_of(surface, world.rest_positions);
    double size = 0;  // volume by the divergence theorem, in 2D area
    std::map<std::array<std::uint32_t, 2>, int> sides;
    std::set<std::uint32_t> used;
    for (const auto& [a, b, d] : surface.triangles()) {
      const Vector3 A = vertex(places, a), B = vertex(places, b), C = vertex(places, d);
      size += c.dim == 3 ? A.dot(B.cross(C)) / 6 : (B - A).cross(C - A).z() / 2;
      for (const auto& [i, j] : {std::array{a, b}, std::array{b, d}, std::array{d, a}}) {
        sides[{i, j}] += 1;
        sides[{j, i}] -= 1;
        used.insert(i);
      }
    }
    EXPECT_NEAR(size, c.dim == 3 ? 0.0625 : 0.25, 1e-7);  // rounding of floats
    if (c.dim == 3) {
      for (const auto& [side, count] : sides) EXPECT_EQ(count, 0);
    }
    EXPECT_EQ(used.size(), static_cast<std::size_t>(surface.num_vertices() - surface.parts()[0].num_inside));
    EXPECT_EQ(*used.rbegin() + 1, used.size());
  }
}

TEST(ShownSurface, HasEveryEdgeOfTheFacetsOnce) {
  // Euler: V - E + F = 2 for the facets of the bar, V - E + F = 1 in the plane; a quadratic edge counts twice
  // and has a vertex of its own.
  for (const Case& c : every_cell) {
    SCOPED_TRACE(std::string(c.element) + " in " + std::to_string(c.dim) + "D");
    const World world(bar_of(c.element, c.dim));
    const ShownSurface surface(world);
    const int facets = c.triangles / (c.element[0] == 'Q' ? 2 : c.element[1] == '2' ? 4 : 1);
    const int vertices = surface.num_vertices() - surface.parts()[0].num_inside,
              edges = static_cast<int>(surface.edges().size());
    EXPECT_EQ(vertices - edges + facets, c.dim == 3 ? 2 : 1);
    const std::set<ShownSurface::Edge> unique(surface.edges().begin(), surface.edges().end());
    EXPECT_EQ(unique.size(), surface.edges().size());
  }
}

/// Tetrahedra fill the body, and with them every node is there.
TEST(ShownSurface, HasTheInsideOfEveryKindOfCell) {
  for (const Case& c : every_cell) {
    SCOPED_TRACE(std::string(c.element) + " in " + std::to_string(c.dim) + "D");
    const World world(bar_of(c.element, c.dim));
    const ShownSurface surface(world);
    EXPECT_EQ(surface.num_vertices(), world.num_nodes());
    if (c.dim == 2) {
      EXPECT_TRUE(surface.tetrahedra().empty());
      continue;
    }
    const std::vector<float> places = places_of(surface, world.rest_positions);
    double volume = 0;
    for (const auto& [a, b, d, e] : surface.tetrahedra()) {
      const Vector3 A = vertex(places, a);
      const double sixth =
          (vertex(places, b) - A).cross(vertex(places, d) - A).dot(vertex(places, e) - A) / 6;
      EXPECT_GT(std::abs(sixth), 1e-9);
      volume += std::abs(sixth);
    }
    EXPECT_NEAR(volume, 0.0625, 1e-7);  // rounding of floats; more where two overlap
    EXPECT_GT(surface.parts()[0].num_inside, 0);
  }
}

TEST(ShownSurface, FollowsTheNodes) {
  const World world(bar_of("P2", 3));
  const ShownSurface surface(world);
  const VectorX moved = world.rest_positions.array() * 1.5 + 0.25;
  const std::vector<float> places = places_of(surface, moved);
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    const auto [nodes, weights] = surface.material_point(v);
    ASSERT_THAT(weights, ElementsAre(1.0));
    EXPECT_EQ(nodes[0], surface.nearest_node(v));
    EXPECT_LT((vertex(places, static_cast<std::uint32_t>(v)) - node_position(3, nodes[0], moved)).norm(),
              1e-6);
  }
}

TEST(ShownSurface, NumbersVerticesOverAllBodies) {
  Description scene = small_bar(2, true);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "other";
  scene.bodies[1].translate = {0, 1, 0};
  scene.fixes[0].body = scene.probes[0].body = "body";
  const ShownSurface surface{World(scene)};
  ASSERT_EQ(surface.parts().size(), 2u);
  const ShownSurface::Part& part = surface.parts()[1];
  EXPECT_EQ(part.name, "other");
  EXPECT_EQ(part.first_vertex, surface.parts()[0].num_vertices);
  EXPECT_EQ(part.first_triangle, 32);
  for (const auto& triangle : surface.triangles().subspan(32))
    EXPECT_GE(triangle[0], static_cast<std::uint32_t>(part.first_vertex));
}

TEST(ShownSurface, DrawsASkinBeforeTheCellsThatCarryIt) {
  Description scene = bar_of("P1", 3);
  scene.bodies[0].skin = SkinDescription{
      .surface = extract_surface(make_box({1, 0.25, 0.25}, {32, 8, 8})).mesh, .surface_name = "fine"};
  const World world(scene);
  const ShownSurface surface(world);
  ASSERT_EQ(surface.parts().size(), 2u);
  const ShownSurface::Part &skin = surface.parts()[0], &cells = surface.parts()[1];
  EXPECT_EQ(skin.kind, ShownSurface::Kind::skin);
  EXPECT_EQ(skin.num_triangles, 16 * 144);
  EXPECT_EQ(skin.num_edges, 0);
  EXPECT_EQ(cells.kind, ShownSurface::Kind::cells);
  EXPECT_EQ(cells.first_vertex, skin.num_vertices);
  EXPECT_GT(cells.num_edges, 0);

  VectorX moved = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) moved[3 * node + 1] *= 1 + moved[3 * node];
  const std::vector<float> places = places_of(surface, moved);
  for (Index v = 0; v < skin.num_vertices; ++v) {
    const auto [nodes, weights] = surface.material_point(v);
    ASSERT_EQ(nodes.size(), 4u);
    Vector3 place = Vector3::Zero();
    for (std::size_t a = 0; a < 4; ++a) place += weights[a] * node_position(3, nodes[a], moved);
    EXPECT_LT((vertex(places, static_cast<std::uint32_t>(v)) - place).norm(), 1e-6);
    EXPECT_THAT(nodes, ::testing::Contains(surface.nearest_node(v)));
  }
}

TEST(Normals, OfABoxAreThoseOfItsSidesAndOfLengthOneAtEdges) {
  const World world(bar_of("Q1", 3));
  const ShownSurface surface(world);
  std::vector<float> normals(static_cast<std::size_t>(3 * surface.num_vertices()));
  surface.normals(surface.rest_positions(), normals);
  const std::vector<float> places(surface.rest_positions().begin(), surface.rest_positions().end());
  for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(surface.num_vertices()); ++v) {
    const Vector3 X = vertex(places, v), normal = vertex(normals, v);
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
    const bool is_inside_a_side = X.z() == 0 && X.x() > 0 && X.x() < 1 && X.y() > 0 && X.y() < 0.25;
    if (is_inside_a_side) {
      EXPECT_LT((normal - Vector3(0, 0, -1)).norm(), 1e-6);
    }
  }
}

TEST(Normals, InThePlanePointTowardsTheViewerAlsoWhereThereIsNoArea) {
  const ShownSurface surface{World(small_bar(2, true))};
  std::vector<float> normals(static_cast<std::size_t>(3 * surface.num_vertices()));
  surface.normals(surface.rest_positions(), normals);
  const std::vector<float> nowhere(normals.size(), 0);
  std::vector<float> without_area(normals.size());
  surface.normals(nowhere, without_area);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_EQ(normals[i], i % 3 == 2 ? 1 : 0);
    EXPECT_EQ(without_area[i], i % 3 == 2 ? 1 : 0);
  }
}

TEST(ShownSurface, IsTheMeshOfARigidBody) {
  for (const int dim : {2, 3}) {
    Description scene = bar_of("P1", dim);
    scene.fixes.clear();
    scene.probes.clear();
    scene.bodies[0].rigid = RigidDescription{.density = 1000};
    const World world(scene);
    const ShownSurface surface(world);
    ASSERT_EQ(surface.parts().size(), 1u);
    const ShownSurface::Part& part = surface.parts()[0];
    EXPECT_EQ(part.kind, ShownSurface::Kind::cells);
    EXPECT_EQ(part.num_triangles, dim == 3 ? 144 : 32);
    EXPECT_EQ(static_cast<std::size_t>(part.num_vertices), scene.bodies[0].mesh.vertices.size());
    const auto move = [dim](const Vector3& X) {
      const Vector3 turned(0.6 * X.x() - 0.8 * X.y(), 0.8 * X.x() + 0.6 * X.y(), X.z());
      return Vector3(turned + Vector3(1, 2, dim == 3 ? 3 : 0));
    };
    VectorX x = world.rest_positions;
    for (Index node = 0; node < world.num_nodes(); ++node)
      x.segment(node * dim, dim) = move(node_position(dim, node, x)).head(dim);
    const std::vector<float> rest = places_of(surface, world.rest_positions), moved = places_of(surface, x);
    std::set<std::array<float, 3>> places;
    for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(surface.num_vertices()); ++v) {
      EXPECT_LT((vertex(moved, v) - move(vertex(rest, v))).norm(), 1e-6);
      places.insert({rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]});
    }
    EXPECT_EQ(places.size(), scene.bodies[0].mesh.vertices.size());
    for (Index node = 0; node < world.num_nodes(); ++node) {
      const std::optional<Index> mark = surface.vertex_of(node);  // for a pin to be drawn
      ASSERT_TRUE(mark);
      EXPECT_TRUE(surface.is_outside(*mark));
    }
  }
}

TEST(ShownSurface, FindsTheNodesOfBodiesBehindARigidOne) {
  Description scene = bar_of("P1", 3);
  scene.fixes.clear();
  scene.probes.clear();
  scene.bodies[0].rigid = RigidDescription{.density = 1000};
  scene.bodies[0].mesh = make_hexahedron_box({1, 1, 1}, {3, 3, 3});  // with vertices inside
  scene.bodies[0].element.clear();
  BodyDescription soft = bar_of("P1", 3).bodies[0];
  soft.name = "soft";
  soft.translate = {0, 5, 0};
  scene.bodies.push_back(soft);
  const World world(scene);
  const ShownSurface surface(world);
  ASSERT_GT(surface.parts()[0].num_inside, 0);
  for (Index node = world.bodies[1].first_node; node < world.num_nodes(); ++node) {
    const std::optional<Index> vertex = surface.vertex_of(node);
    ASSERT_TRUE(vertex) << node;
    EXPECT_EQ(surface.material_point(*vertex).nodes, std::vector<Index>{node});
  }
}

}  // namespace
}  // namespace resilin::testing
