#include "resilin/contact/crossing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "resilin/core/orientation.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

/// Separate parts in a box, each a body of its own.
struct Parts {
  CollisionSurface surface;
  VectorX places;
};

Parts random_parts(int dim, int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Parts parts;
  parts.surface.dim = dim;
  const std::vector<Index> facet = dim == 3 ? std::vector<Index>{0, 1, 2} : std::vector<Index>{0, 1};
  for (int i = 0; i < count; ++i) add_body(parts.surface, dim, facet);
  parts.places = VectorX::NullaryExpr(Eigen::Index{count} * dim * dim, [&] { return unit(generator); });
  return parts;
}

/// Whether a segment meets a triangle, by the solution of p + t (q - p) = a + u (b - a) + v (c - a).
bool meets(const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b, const Vector3& c) {
  Eigen::Matrix3d m;
  m << b - a, c - a, p - q;
  const Vector3 s = m.inverse() * (p - a);
  return s.x() >= 0 && s.y() >= 0 && s.x() + s.y() <= 1 && s.z() >= 0 && s.z() <= 1;
}

bool meet_2d(const Parts& parts, Index e, Index f) {
  std::array<Eigen::Vector2d, 4> p;
  for (std::size_t k = 0; k < 4; ++k) {
    const Index edge = k < 2 ? e : f;
    p[k] = parts.places.segment<2>(2 * parts.surface.edges[static_cast<std::size_t>(2 * edge) + k % 2]);
  }
  Eigen::Matrix2d m;
  m << p[1] - p[0], p[2] - p[3];
  const Eigen::Vector2d s = m.inverse() * (p[2] - p[0]);
  return s.minCoeff() >= 0 && s.maxCoeff() <= 1;
}

bool meet_3d(const Parts& parts, Index edge, Index triangle) {
  const auto place = [&](Index vertex) -> Vector3 {
    return parts.places.segment<3>(Eigen::Index{vertex} * 3);
  };
  const auto& e = parts.surface.edges;
  const auto& t = parts.surface.triangles;
  const auto i = static_cast<std::size_t>(2 * edge), j = static_cast<std::size_t>(3 * triangle);
  if (parts.surface.bodies[static_cast<std::size_t>(e[i])] ==
      parts.surface.bodies[static_cast<std::size_t>(t[j])])
    return false;
  return meets(place(e[i]), place(e[i + 1]), place(t[j]), place(t[j + 1]), place(t[j + 2]));
}

class CrossingsOfRandomParts : public ::testing::TestWithParam<int> {};

TEST_P(CrossingsOfRandomParts, AreThoseThatEquationsFind) {
  const int dim = GetParam();
  int crossed = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Parts parts = random_parts(dim, 4, seed);
    const auto found = first_crossing(parts.surface, BodyMeetings(4), parts.places);
    const auto num_edges = static_cast<Index>(parts.surface.edges.size() / 2);
    const Index num_others = dim == 3 ? static_cast<Index>(parts.surface.triangles.size() / 3) : num_edges;
    std::optional<Crossing> expected;
    for (Index e = 0; e < num_edges && !expected; ++e)
      for (Index other = dim == 3 ? 0 : e + 1; other < num_others && !expected; ++other)
        if (dim == 3 ? meet_3d(parts, e, other) : meet_2d(parts, e, other)) expected = Crossing{e, other};
    ASSERT_EQ(found.has_value(), expected.has_value()) << seed;
    if (!found) continue;
    ++crossed;
    EXPECT_EQ(found->edge, expected->edge);
    EXPECT_EQ(found->other, expected->other);
  }
  EXPECT_GT(crossed, 20);
  EXPECT_LT(crossed, 195);
}

INSTANTIATE_TEST_SUITE_P(InTwoAndThreeDimensions, CrossingsOfRandomParts, ::testing::Values(2, 3));

/// Two slivers, nearly in one plane that is turned anyhow.
VectorX nearly_flat_slivers(std::mt19937& generator) {
  std::uniform_real_distribution<double> unit(-1, 1), exponent(-16, 0);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::UnitRandom();
  const double width = std::pow(10, exponent(generator)), height = std::pow(10, exponent(generator));
  VectorX places(18);
  for (Eigen::Index i = 0; i < 6; ++i)
    places.segment<3>(3 * i) =
        turn * Vector3(unit(generator), width * unit(generator), height * unit(generator));
  return places;
}

/// By signs of determinants alone, which are exact.
bool goes_through_by_signs(const Parts& parts, Index edge, Index triangle) {
  const auto place = [&](const std::vector<Index>& part, Index corner) -> Vector3 {
    return parts.places.segment<3>(Eigen::Index{part[static_cast<std::size_t>(corner)]} * 3);
  };
  const Vector3 p = place(parts.surface.edges, 2 * edge), q = place(parts.surface.edges, 2 * edge + 1);
  std::array<Vector3, 3> t;
  for (Index k = 0; k < 3; ++k)
    t[static_cast<std::size_t>(k)] = place(parts.surface.triangles, 3 * triangle + k);
  if (orientation(t[0], t[1], t[2], p) * orientation(t[0], t[1], t[2], q) >= 0) return false;
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  return std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0;
}

TEST(CrossingsOfSlivers, AreThoseOfExactSigns) {
  std::mt19937 generator(3);
  std::srand(3);  // for Eigen
  int crossed = 0;
  Parts parts = random_parts(3, 2, 1);
  for (int i = 0; i < 20000; ++i) {
    parts.places = nearly_flat_slivers(generator);
    std::optional<Index> expected;
    for (Index edge = 0; edge < 6 && !expected; ++edge)
      if (goes_through_by_signs(parts, edge, edge < 3 ? 1 : 0)) expected = edge;
    const auto found = first_crossing(parts.surface, BodyMeetings(2), parts.places);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ASSERT_EQ(found->edge, *expected) << i;
    ++crossed;
  }
  EXPECT_GT(crossed, 2000);
  EXPECT_LT(crossed, 18000);
}

/// A box or a square of side 2 size around a place.
void add_box(Parts& parts, const Vector3& middle, double size) {
  const int dim = parts.surface.dim;
  const Mesh mesh =
      dim == 3 ? make_box({2, 2, 2}, {1, 1, 1}, {-1, -1, -1}) : make_rectangle({2, 2}, {1, 1}, {-1, -1});
  const CellBlock facets = boundary(*mesh.find_solid(dim)).facets;
  const Eigen::Index old = parts.places.size();
  parts.places.conservativeResize(old + static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    parts.places.segment(old + static_cast<Eigen::Index>(v) * dim, dim) =
        (middle + size * mesh.vertices[v]).head(dim);
  add_body(parts.surface, static_cast<Index>(mesh.vertices.size()), facets.nodes);
}

TEST(ABodyInAnother, IsFoundWhereSurfacesDoNotCross) {
  for (const int dim : {2, 3}) {
    Parts parts = random_parts(dim, 0, 1);
    add_box(parts, {0, 0, 0}, 1);
    add_box(parts, {0.3, 0.2, dim == 3 ? -0.4 : 0}, 0.1);
    add_box(parts, {1.2, 0.2, 0}, 0.1);
    EXPECT_FALSE(first_crossing(parts.surface, BodyMeetings(3), parts.places));
    EXPECT_FALSE(has_piece_inside(parts.surface, 0, 1, parts.places)) << dim;
    EXPECT_TRUE(has_piece_inside(parts.surface, 1, 0, parts.places)) << dim;
    EXPECT_FALSE(has_piece_inside(parts.surface, 2, 0, parts.places)) << dim;
    EXPECT_FALSE(has_piece_inside(parts.surface, 2, 1, parts.places)) << dim;
  }
}

/// A triangle above another one, moved down until its tip has gone through by a hair.
TEST(ACrossing, IsSeenToTheLastBit) {
  Parts parts = random_parts(3, 2, 1);
  parts.places << 0, 0, 0, 1, 0, 0, 0, 1, 0,  // flat
      0.25, 0.25, 0, 0.2, 0.2, 1, 0.3, 0.2, 1;
  const auto crosses = [&](double height) {
    parts.places[11] = height;
    return first_crossing(parts.surface, BodyMeetings(2), parts.places).has_value();
  };
  EXPECT_FALSE(crosses(1e-300));
  EXPECT_FALSE(crosses(0));
  EXPECT_TRUE(crosses(-1e-100));
  BodyMeetings apart(2);
  apart.set(0, 1, false);
  EXPECT_FALSE(first_crossing(parts.surface, apart, parts.places));
}

}  // namespace
}  // namespace resilin
