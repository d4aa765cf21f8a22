// Lengths of bodies that do not hang on how they are turned.

#include "resilin/mesh/second_moments.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

Vector3 lengths_of(const Mesh& mesh, const Eigen::Matrix3d& turn, const Vector3& way, int dim) {
  VectorX places(static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    places.segment(static_cast<Eigen::Index>(v) * dim, dim) = (turn * mesh.vertices[v] + way).head(dim);
  return second_moments(mesh.blocks[0].kind, mesh.blocks[0].nodes, places, dim).lengths();
}

TEST(SecondMoments, OfABoxAreItsSidesHoweverItIsTurned) {
  const Mesh boxes[] = {make_box({0.3, 0.1, 0.2}, {3, 1, 2}),
                        make_hexahedron_box({0.3, 0.1, 0.2}, {2, 3, 1})};
  for (const Mesh& box : boxes)
    for (const double degrees : {0.0, 30.0, 45.0, 111.0}) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(degrees * 3.14159 / 180, Vector3(1, 2, 3).normalized()).toRotationMatrix();
      const Vector3 lengths = lengths_of(box, turn, {5, -3, 1}, 3);
      EXPECT_EQ(lengths[0], 0.1);
      EXPECT_EQ(lengths[1], 0.2);
      EXPECT_EQ(lengths[2], 0.3);
    }
}

TEST(SecondMoments, OfARectangleAreItsSidesHoweverItIsTurned) {
  const Mesh rectangle = make_rectangle({0.5, 0.02}, {4, 2});
  for (const double degrees : {0.0, 30.0, 45.0}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * 3.14159 / 180, Vector3::UnitZ()).toRotationMatrix();
    const Vector3 lengths = lengths_of(rectangle, turn, {1, 1, 0}, 2);
    EXPECT_EQ(lengths[0], 0);
    EXPECT_NEAR(lengths[1], 0.02, 1e-9);
    EXPECT_EQ(lengths[2], 0.5);
  }
}

/// A square of 0.4 m as two triangles, and a rectangle of four lines around the origin's right.
TEST(SecondMoments, OfASheetAreItsSides) {
  const std::vector<Vector3> corners = {{0, 0, 0}, {0.4, 0, 0}, {0.4, 0.24, 0.32}, {0, 0.24, 0.32}};
  const Vector3 lengths = second_moments(corners, std::vector<Index>{0, 1, 2, 0, 2, 3}, 3, false).lengths();
  EXPECT_NEAR(lengths[0], 0, 1e-7);
  EXPECT_NEAR(lengths[1], 0.4, 1e-9);
  EXPECT_NEAR(lengths[2], 0.4, 1e-9);
}

TEST(SecondMoments, OfAClosedLineAreThoseOfWhatItHolds) {
  const std::vector<Vector3> corners = {{1, 2, 0}, {1.3, 2, 0}, {1.3, 2.1, 0}, {1, 2.1, 0}};
  for (const std::vector<Index>& lines :
       {std::vector<Index>{0, 1, 1, 2, 2, 3, 3, 0}, std::vector<Index>{1, 0, 2, 1, 3, 2, 0, 3}}) {
    const Vector3 lengths = second_moments(corners, lines, 2, true).lengths();
    EXPECT_NEAR(lengths[1], 0.1, 1e-9);
    EXPECT_NEAR(lengths[2], 0.3, 1e-9);
  }
}

}  // namespace
}  // namespace resilin
