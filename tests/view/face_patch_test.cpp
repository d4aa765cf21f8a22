#include "resilin/view/face_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "round_skin.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

Vector3 rest_place(const ShownSurface& surface, Index vertex) {
  return Eigen::Map<const Eigen::Vector3f>(surface.rest_positions().data() + 3 * std::ptrdiff_t{vertex})
      .cast<double>();
}

/// The vertex of the surface that is nearest to a place.
Index vertex_at(const ShownSurface& surface, const Vector3& place) {
  Index best = 0;
  for (Index v = 0; v < surface.num_vertices(); ++v)
    if ((rest_place(surface, v) - place).norm() < (rest_place(surface, best) - place).norm()) best = v;
  return best;
}

FacePatch patch_at(const ShownSurface& surface, const Vector3& place, const FaceReach& reach) {
  return face_patch(surface, vertex_at(surface, place), place, surface.rest_positions(), reach);
}

/// A bar of 1 x 0.25 x 0.25 m, in 2D of 1 x 0.25 m.
TEST(FacePatch, IsTheWholeOfAFlatSideAndEndsAtItsEdges) {
  for (const int dim : {2, 3}) {
    const World world(small_bar(dim, true));
    const ShownSurface surface(world);
    const FacePatch top = patch_at(surface, {0.52, 0.25, dim == 3 ? 0.13 : 0}, {.angle = 30});
    Index expected = 0;
    for (Index v = 0; v < surface.num_vertices(); ++v) expected += rest_place(surface, v).y() == 0.25 ? 1 : 0;
    EXPECT_EQ(static_cast<Index>(top.vertices.size()), expected) << dim;
    for (const Index v : top.vertices) EXPECT_EQ(rest_place(surface, v).y(), 0.25);
    const std::vector<Index> nodes = nodes_of_patch(surface, top);
    EXPECT_EQ(nodes.size(), top.vertices.size());
    for (const Index node : nodes) EXPECT_EQ(node_position(dim, node, world.rest_positions).y(), 0.25);
    const FacePatch all = patch_at(surface, {0.52, 0.25, dim == 3 ? 0.13 : 0}, {.angle = 180});
    EXPECT_GT(all.vertices.size(), 2 * top.vertices.size());
    const FacePatch near = patch_at(surface, {0.02, 0.25, dim == 3 ? 0.13 : 0}, {.angle = 30, .radius = 0.3});
    EXPECT_LT(near.vertices.size(), top.vertices.size());
    for (const Index v : near.vertices) EXPECT_LT(rest_place(surface, v).x(), 0.6);
  }
}

/// On a ball the cap, whose half angle is the reach, to about an edge.
TEST(FacePatch, OfARoundSkinIsACapAndItsNodesCarryIt) {
  Description scene = small_bar(3, true);
  scene.fixes.clear();
  scene.probes.clear();
  scene.bodies[0].mesh = make_box({2.2, 2.2, 2.2}, {3, 3, 3}, {-1.1, -1.1, -1.1});
  scene.bodies[0].skin.emplace();
  scene.bodies[0].skin->surface = ball_surface(1, Vector3::Zero(), 4);
  scene.bodies[0].skin->surface_name = "ball";
  const World world(scene);
  const ShownSurface surface(world);
  const double radius = rest_place(surface, 0).norm();
  const FacePatch cap = patch_at(surface, {0, 0, radius}, {.angle = 30});
  double lowest = radius;
  for (const Index v : cap.vertices) lowest = std::min(lowest, rest_place(surface, v).z());
  EXPECT_GT(lowest, radius * std::cos(45 * std::numbers::pi / 180));
  EXPECT_LT(lowest, radius * std::cos(20 * std::numbers::pi / 180));
  // Where the nodes stand still, so does the cap, whatever the others do.
  VectorX moved = 1.5 * world.rest_positions;
  for (const Index node : nodes_of_patch(surface, cap))
    moved.segment<3>(3 * Eigen::Index{node}) = world.rest_positions.segment<3>(3 * Eigen::Index{node});
  std::vector<float> places(3 * static_cast<std::size_t>(surface.num_vertices()));
  surface.positions(moved, places);
  for (const Index v : cap.vertices) {
    const Vector3 now =
        Eigen::Map<const Eigen::Vector3f>(places.data() + 3 * std::ptrdiff_t{v}).cast<double>();
    EXPECT_LT((now - rest_place(surface, v)).norm(), 1e-6 * radius);
  }
}

TEST(FacePatch, RefusesAVertexOfTheInside) {
  const World world(small_bar(3, true));
  const ShownSurface surface(world);
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    if (surface.is_outside(v)) continue;
    EXPECT_THROW(face_patch(surface, v, rest_place(surface, v), surface.rest_positions(), {}), InputError);
  }
}

}  // namespace
}  // namespace resilin::testing
