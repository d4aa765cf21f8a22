#include "resilin/world/shown_colliders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "resilin/mesh/facet.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar of 1 m and one collider of each kind that there is in this dimension, all far from it, all moving
/// and turning.
Description bar_and_all_kinds(int dim) {
  Description scene = small_bar(dim, true);
  for (const ShapeKind& kind : shape_kinds()) {
    if (dim == 2 && !kind.is_flat_too) continue;
    ColliderDescription collider;
    collider.name = std::string(kind.name);
    collider.kind = kind.name;
    const Vector3 place = {20.0 * static_cast<double>(scene.colliders.size() + 1), 30, 0};
    collider.shape.point = {0, -50, 0};
    collider.shape.normal = {0.1, 1, 0};
    collider.shape.center = collider.shape.start = place;
    collider.shape.end = place + Vector3(0, 1, 0);
    collider.shape.radius = 0.5;
    collider.shape.size = {1, 2, 3};
    collider.shape.translate = place;
    // A tetrahedron with a wing, an edge and a point; in 2D what is left of them.
    collider.shape.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    if (dim == 3) collider.shape.mesh.block(CellKind::triangle).nodes = {0, 1, 2};
    collider.shape.mesh.block(CellKind::line).nodes = {3, 4};
    collider.shape.mesh.block(CellKind::point).nodes = {5};
    collider.shape.mesh.vertices.insert(collider.shape.mesh.vertices.end(),
                                        {{3, 0, 0}, {4, 0, 0}, {6, 0, 0}});
    collider.velocity = {0.1, 0.2, 0};
    collider.rotate =
        ColliderTurn{.axis = Vector3::UnitZ(), .center = place, .degrees = 10, .degrees_per_second = 30};
    scene.colliders.push_back(collider);
  }
  return scene;
}

std::vector<Vector3> places_of(const ShownCollider& collider, const Conditions& c) {
  std::vector<Vector3> places;
  for (const Vector3& X : collider.mesh.vertices) places.push_back(collider.place(c)(X));
  return places;
}

TEST(ShownColliders, LieWhereBodiesFeelThem) {
  for (const int dim : {2, 3}) {
    const World world(bar_and_all_kinds(dim));
    const std::vector<ShownCollider> shown = shown_colliders(world);
    ASSERT_EQ(shown.size(), world.colliders.size() + world.mesh_colliders.size());
    for (const Conditions& c : {Conditions{.time = 0}, Conditions{.time = 2, .delay = 0.5}}) {
      for (std::size_t i = 0; i < world.colliders.size(); ++i)
        for (const Vector3& x : places_of(shown[i], c))
          EXPECT_NEAR(world.colliders[i]->distance(x, c), 0, 1e-11) << shown[i].name << ", dim " << dim;
      for (std::size_t i = 0; i < world.mesh_colliders.size(); ++i) {
        const ContactSurface& surface = world.mesh_colliders[i]->surface();
        const VectorX expected = surface.places(world.rest_positions, c);
        const std::vector<Vector3> found = places_of(shown[world.colliders.size() + i], c);
        for (std::size_t v = 0; v < found.size(); ++v)
          EXPECT_LT(
              (found[v] - node_position(dim, surface.num_body_vertices() + static_cast<Index>(v), expected))
                  .norm(),
              1e-12);
      }
    }
  }
}

TEST(ShownColliders, KnowWhetherTheyHaveAnInsideAndAnEnd) {
  for (const int dim : {2, 3})
    for (const ShownCollider& collider : shown_colliders(World(bar_and_all_kinds(dim)))) {
      EXPECT_EQ(collider.is_endless, collider.name == "half_space");
      EXPECT_EQ(collider.is_closed, collider.name != "half_space" && collider.name != "mesh")
          << collider.name;
      EXPECT_EQ(is_closed(collider.mesh, dim), collider.is_closed) << collider.name << ", dim " << dim;
    }
}

TEST(ColliderFacets, AreTrianglesLinesAndPointsWithTheNumbersOfTheirColliders) {
  for (const int dim : {2, 3}) {
    const World world(bar_and_all_kinds(dim));
    const ColliderFacets facets = collider_facets(world, {.time = 1});
    EXPECT_TRUE(facets.mesh.is_whole());
    std::size_t cells = 0;
    for (const CellBlock& block : facets.mesh.blocks) cells += static_cast<std::size_t>(block.num_cells());
    ASSERT_EQ(facets.numbers.size(), cells);
    EXPECT_EQ(facets.mesh.find_block(CellKind::triangle) != nullptr, dim == 3);
    const CellBlock* points = facets.mesh.find_block(CellKind::point);
    ASSERT_NE(points, nullptr);
    ASSERT_EQ(points->num_cells(), 1);
    const std::vector<ShownCollider> shown = shown_colliders(world);
    const std::vector<Vector3> last = places_of(shown.back(), {.time = 1});
    const Vector3& point = facets.mesh.vertices[static_cast<std::size_t>(points->nodes[0])];
    EXPECT_TRUE(std::ranges::any_of(last, [&](const Vector3& x) { return (x - point).norm() < 1e-12; }));
    EXPECT_EQ(facets.numbers.back(), static_cast<double>(shown.size() - 1));
    EXPECT_EQ(std::ranges::min(facets.numbers), 0);
  }
}

/// However the world keeps them: those with an exact distance come first there.
TEST(ColliderFacets, HaveTheNumbersOfTheScene) {
  Description scene = small_bar(3, true);
  ColliderDescription box, floor;
  box.name = "box";
  box.kind = "box";
  box.shape.center = {0, 10, 0};
  box.shape.size = {1, 1, 1};
  floor.name = "floor";
  floor.shape.point = {0, 0, -5};
  floor.shape.normal = Vector3::UnitZ();
  scene.colliders = {box, floor};
  const ColliderFacets facets = collider_facets(World(scene), {});
  EXPECT_EQ(std::ranges::count(facets.numbers, 0.0), 12);  // triangles of a box
  EXPECT_EQ(std::ranges::count(facets.numbers, 1.0), 2);
}

/// Seen from outside, triangles of exact shapes turn as those of bodies do.
TEST(ColliderFacets, OfABallFaceOutwards) {
  Description scene = small_bar(3, true);
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0, 10, 0};
  ball.shape.radius = 0.5;
  scene.colliders = {ball};
  const ShownCollider shown = shown_colliders(World(scene)).front();
  double volume = 0;
  for (std::size_t f = 0; f < shown.mesh.facets.size(); f += 3) {
    const auto corner = [&](std::size_t k) -> Vector3 {
      return shown.mesh.vertices[static_cast<std::size_t>(shown.mesh.facets[f + k])] - ball.shape.center;
    };
    const double part = corner(0).dot(corner(1).cross(corner(2))) / 6;
    EXPECT_GT(part, 0);
    volume += part;
  }
  EXPECT_NEAR(volume, 4.0 / 3 * std::numbers::pi * 0.125, 0.01 * volume);  // 64 sides around
}

}  // namespace
}  // namespace resilin::testing
