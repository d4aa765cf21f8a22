#include "resilin/contact/sliding_normals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"
#include "round_skin.hpp"

namespace resilin::testing {
namespace {

/// One body's facets: triangles, in 2D lines.
struct FacetSurface {
  CollisionSurface parts;
  VectorX places;

  FacetSurface(int dim, const Mesh& mesh, std::span<const Index> facets)
      : places(static_cast<Eigen::Index>(mesh.vertices.size()) * dim) {
    parts.dim = dim;
    add_body(parts, static_cast<Index>(mesh.vertices.size()), facets);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      places.segment(static_cast<Eigen::Index>(v) * dim, dim) = mesh.vertices[v].head(dim);
  }
  Vector3 place(Index vertex) const {
    Vector3 X = Vector3::Zero();
    X.head(parts.dim) = places.segment(Eigen::Index{vertex} * parts.dim, parts.dim);
    return X;
  }
  /// Normal at a point that is apart from a part of the surface in this direction.
  Vector3 normal(const std::vector<Index>& part, const std::vector<double>& weights,
                 const Vector3& apart) const {
    PartForce pair{.kind = part.size() == 3   ? PairKind::point_triangle
                           : part.size() == 2 ? PairKind::point_edge
                                              : PairKind::point_point,
                   .vertices = {0, -1, -1, -1},
                   .weights = {1, 0, 0, 0},
                   .normal = apart.normalized(),
                   .distance = 1e-3,
                   .force = 1};
    for (std::size_t i = 0; i < part.size(); ++i) {
      pair.vertices[i + 1] = part[i];
      pair.weights[i + 1] = -weights[i];
    }
    return SlidingNormals(parts).normal_at(pair, places);
  }
  Vector3 facet_normal(std::span<const Index> triangle) const {
    return (place(triangle[1]) - place(triangle[0])).cross(place(triangle[2]) - place(triangle[0]));
  }
};

/// From either side of an edge, from the edge itself and from its ends: one normal, near that of the ball.
TEST(SlidingNormals, GoThroughTheEdgesOfABallWithoutAJump) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 3);
  const std::vector<Index>& triangles = ball.find_block(CellKind::triangle)->nodes;
  const FacetSurface surface(3, ball, triangles);
  std::map<std::array<Index, 2>, Vector3> normal_at_edge;
  int compared = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles[t + k], b = triangles[t + (k + 1) % 3], c = triangles[t + (k + 2) % 3];
      const bool rises = a < b;
      const std::array<Index, 2> edge = {std::min(a, b), std::max(a, b)};
      const double share = rises ? 0.3 : 0.7;
      const Vector3 facet = surface.facet_normal(std::span(triangles).subspan(t, 3));
      const Vector3 normal = surface.normal({a, b, c}, {1 - share, share, 0}, facet);
      const Vector3 across = (1 - share) * surface.place(a) + share * surface.place(b);
      EXPECT_LT((normal - across.normalized()).norm(), 0.06);
      EXPECT_LT((normal - surface.normal({a, b}, {1 - share, share}, across)).norm(), 1e-14);
      EXPECT_LT((surface.normal({a, b, c}, {1, 0, 0}, facet) - surface.normal({a}, {1}, across)).norm(),
                1e-14);
      const auto [other, is_new] = normal_at_edge.try_emplace(edge, normal);
      if (is_new) continue;
      EXPECT_LT((normal - other->second).norm(), 1e-14);
      ++compared;
    }
  EXPECT_EQ(compared, triangles.size() / 2);
}

/// The faces of a box stay planes up to their edges, and about these the normal turns by the way that things
/// are apart.
TEST(SlidingNormals, OfABoxAreThoseOfItsFaces) {
  const Mesh box = make_box({1, 1, 1}, {2, 2, 2});
  const CellBlock facets = boundary(*box.find_solid(3)).facets;
  const FacetSurface surface(3, box, facets.nodes);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (Index t = 0; t < facets.num_cells(); ++t) {
    const std::span<const Index> v = facets.cell(t);
    const Vector3 facet = surface.facet_normal(v).normalized();
    const double a = uniform(generator), b = (1 - a) * uniform(generator);
    EXPECT_LT((surface.normal({v[0], v[1], v[2]}, {1 - a - b, a, b}, facet) - facet).norm(), 1e-14);
    EXPECT_LT((surface.normal({v[0], v[1], v[2]}, {1 - a - b, a, b}, -facet) + facet).norm(), 1e-14);
  }
  Index from = -1, to = -1;  // from and to of the edge along z at x = y = 1
  for (Index v = 0; v < static_cast<Index>(box.vertices.size()); ++v) {
    if (box.vertices[static_cast<std::size_t>(v)] == Vector3(1, 1, 0)) from = v;
    if (box.vertices[static_cast<std::size_t>(v)] == Vector3(1, 1, 0.5)) to = v;
  }
  ASSERT_TRUE(from >= 0 && to >= 0);
  const Vector3 diagonal = Vector3(1, 1, 0).normalized();
  EXPECT_LT((surface.normal({from, to}, {0, 1}, diagonal) - diagonal).norm(), 0.1);
  EXPECT_LT((surface.normal({from, to}, {0.5, 0.5}, diagonal) - diagonal).norm(), 0.3);
}

/// For a polygon with many corners, and for one with three.
TEST(SlidingNormals, InThePlane) {
  const auto polygon = [](Index count) {
    Mesh mesh;
    for (Index i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
      mesh.block(CellKind::line).nodes.insert(mesh.block(CellKind::line).nodes.end(), {i, (i + 1) % count});
    }
    return mesh;
  };
  const Mesh round = polygon(60), triangle = polygon(3);
  const FacetSurface disc(2, round, round.find_block(CellKind::line)->nodes),
      wedge(2, triangle, triangle.find_block(CellKind::line)->nodes);
  const auto middle = [](const FacetSurface& surface) {
    return Vector3(0.5 * (surface.place(0) + surface.place(1)));
  };
  for (const double share : {0.0, 0.2, 0.5, 1.0}) {
    const Vector3 at = (1 - share) * disc.place(0) + share * disc.place(1);
    EXPECT_LT((disc.normal({0, 1}, {1 - share, share}, middle(disc)) - at.normalized()).norm(), 1e-3);
    EXPECT_LT((wedge.normal({0, 1}, {1 - share, share}, middle(wedge)) - middle(wedge).normalized()).norm(),
              1e-14);
  }
  EXPECT_LT((wedge.normal({0}, {1}, Vector3::UnitX()) - Vector3::UnitX()).norm(), 1e-14);
}

}  // namespace
}  // namespace resilin::testing
