#include "resilin/contact/facing_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "resilin/contact/contact_surface.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

struct FacingMesh {
  ContactSurface surface;
  std::vector<Vector3> places;

  FacingMesh(int dim, const Mesh& mesh) {
    const ContactBody body{boundary(*mesh.find_solid(dim)).facets, 1e5};
    VectorX positions(static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      positions.segment(static_cast<Eigen::Index>(v) * dim, dim) = mesh.vertices[v].head(dim);
    surface = make_contact_surface(dim, std::span(&body, 1), positions);
    const VectorX y = surface.places(positions);
    for (Eigen::Index v = 0; v < y.size() / dim; ++v) {
      places.emplace_back(Vector3::Zero());
      places.back().head(dim) = y.segment(v * dim, dim);
    }
  }
  /// Sum over all vertices with the last coordinate `height`.
  double sum_at(int axis, double height) const {
    double sum = 0;
    for (std::size_t v = 0; v < places.size(); ++v)
      if (std::abs(places[v][axis] - height) < 1e-9) sum += surface.point_areas[v];
    return sum;
  }
};

/// A face of a box counts as what it is, ridges included. Corners count the larger share of three faces: of
/// squares cut in two, two thirds of a half where a face has but one.
TEST(FacingAreas, OfAFaceAddUpToIt) {
  const FacingMesh box(3, make_box({1, 1, 1}, {4, 4, 4}));
  for (const int axis : {0, 1, 2})
    for (const double height : {0.0, 1.0}) {
      EXPECT_GE(box.sum_at(axis, height), 1 - 1e-12) << axis;
      EXPECT_LE(box.sum_at(axis, height), 1 + 1.0 / 48 + 1e-12) << axis;
    }
  const FacingMesh square(2, make_rectangle({1, 1}, {5, 5}));
  for (const int axis : {0, 1}) EXPECT_NEAR(square.sum_at(axis, 1), 1, 1e-12) << axis;
}

/// Where a surface bends little, little is lost: of a ring the share 1 - cos of half of its edges' angle.
TEST(FacingAreas, OfASmoothSurfaceAreAllOfIt) {
  Mesh disc = make_rectangle({1, 1}, {40, 40}, {-0.5, -0.5});
  for (Vector3& X : disc.vertices) {
    const double size = std::max(std::abs(X.x()), std::abs(X.y())), length = X.norm();
    if (length > 0) X *= size / length;
  }
  const FacingMesh ring(2, disc);
  const std::vector<double>& areas = ring.surface.point_areas;
  const double seen = std::accumulate(areas.begin(), areas.end(), 0.0);
  const std::vector<double>& lengths = ring.surface.edge_lengths;
  const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  EXPECT_LE(seen, whole);
  EXPECT_GT(seen, 0.998 * whole);
}

/// A half section in r and z has areas of the full turn; lines on the axis are no surface.
TEST(FacingAreas, OfATurnedBodyAreThoseOfTheFullTurn) {
  const Mesh mesh = make_rectangle({2, 1}, {4, 4});
  VectorX positions(2 * static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    positions.segment<2>(2 * static_cast<Eigen::Index>(v)) = mesh.vertices[v].head<2>();
  const ContactBody body{boundary(*mesh.find_solid(2)).facets, 1e5};
  const ContactSurface surface =
      make_contact_surface(2, std::span(&body, 1), positions, {}, {.is_turned = true});
  EXPECT_EQ(surface.parts.edges.size() / 2, 12U);  // four of sixteen are on the axis
  EXPECT_EQ(surface.parts.num_vertices(), 13U);
  const VectorX places = surface.places(positions);
  double top = 0;
  for (Eigen::Index v = 0; v < 13; ++v)
    if (places[2 * v + 1] == 1) top += surface.point_areas[static_cast<std::size_t>(v)];
  EXPECT_NEAR(top, 4 * std::acos(-1.0), 1e-12);
}

}  // namespace
}  // namespace resilin
