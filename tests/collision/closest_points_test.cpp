#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "resilin/collision/feature.hpp"
#include "resilin/collision/pair_distance.hpp"
#include "sample_pairs.hpp"

namespace resilin {
namespace {

using testing::SamplePairs;

/// For two convex sets: a plane between them with all of the one on its far side and all of the other on its
/// near side shows that no points are nearer. Returns the distance of the two planes [m].
template <int dim>
double proven_distance(PairKind kind, const std::vector<Vector<dim>>& x, const Vector<dim>& normal) {
  double least = std::numeric_limits<double>::infinity();
  const auto split = static_cast<std::size_t>(num_first(kind));
  for (std::size_t i = 0; i < split; ++i)
    for (std::size_t j = split; j < x.size(); ++j) least = std::min(least, normal.dot(x[i] - x[j]));
  return least;
}

template <int dim>
double largest_coordinate(const std::vector<Vector<dim>>& x) {
  double largest = 0;
  for (const Vector<dim>& v : x) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  return largest;
}

/// The weights say where the closest points are, and a plane between proves that none are closer: to 1e-10 of
/// the size, which is what the normals of slivers and of nearly parallel edges leave.
template <int dim>
void are_the_closest_points(PairKind kind, const std::vector<Vector<dim>>& x) {
  const PairDistance<dim> pair = pair_distance<dim>(kind, x);
  const double size = largest_coordinate<dim>(x);
  Vector<dim> gap = Vector<dim>::Zero();
  double first = 0, second = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool is_first = i < static_cast<std::size_t>(num_first(kind));
    EXPECT_GE(is_first ? pair.weights[i] : -pair.weights[i], 0);
    (is_first ? first : second) += pair.weights[i];
    gap += pair.weights[i] * x[i];
  }
  EXPECT_NEAR(first, 1, 4e-16);
  EXPECT_NEAR(second, -1, 4e-16);
  EXPECT_NEAR(gap.norm(), pair.distance, 4e-15 * size);
  EXPECT_NEAR(pair.normal.norm(), 1, 1e-15);
  EXPECT_EQ(std::sqrt(squared_distance<dim>(kind, x)), pair.distance);
  if (pair.distance < 1e-12 * size) return;  // none can be closer, and the normal is any
  EXPECT_LE(proven_distance<dim>(kind, x, pair.normal), pair.distance + 4e-15 * size);
  EXPECT_GE(proven_distance<dim>(kind, x, pair.normal), pair.distance - 1e-10 * size);
}

TEST(ClosestPoints, OfRandomPairsAreProvenByAPlaneBetween) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 1);
    for (int i = 0; i < 20000 && !HasFailure(); ++i) are_the_closest_points<3>(kind, samples.plain());
  }
  for (const PairKind kind : {PairKind::point_point, PairKind::point_edge}) {
    SamplePairs<2> samples(kind, 2);
    for (int i = 0; i < 20000 && !HasFailure(); ++i) are_the_closest_points<2>(kind, samples.plain());
  }
}

TEST(ClosestPoints, OfDegeneratePairsAreProvenByAPlaneBetween) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 3);
    for (int i = 0; i < 50000; ++i) {
      const auto x = samples.degenerate();
      are_the_closest_points<3>(kind, x);
      if (HasFailure()) {
        ADD_FAILURE() << testing::name_of(kind) << " " << i;
        for (const Vector3& v : x) ADD_FAILURE() << v.transpose();
        return;
      }
    }
  }
}

TEST(ClosestPoints, KnowEachRegionOfATriangleExactly) {
  const Vector3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  const auto weights = [&](const Vector3& p) {
    return pair_distance<3>(PairKind::point_triangle, std::array{p, a, b, c}).weights;
  };
  using W = std::array<double, 4>;
  EXPECT_EQ(weights({-1, -1, 1}), (W{1, -1, 0, 0}));
  EXPECT_EQ(weights({2, -1, 1}), (W{1, 0, -1, 0}));
  EXPECT_EQ(weights({-1, 2, 1}), (W{1, 0, 0, -1}));
  EXPECT_EQ(weights({0.25, -1, 1}), (W{1, -0.75, -0.25, 0}));
  EXPECT_EQ(weights({1, 1, 1}), (W{1, 0, -0.5, -0.5}));
  EXPECT_EQ(weights({-1, 0.25, 1}), (W{1, -0.75, 0, -0.25}));
  EXPECT_EQ(weights({0.25, 0.25, 1}), (W{1, -0.5, -0.25, -0.25}));
  // On an edge and on a corner, also in the plane.
  EXPECT_EQ(weights({0.25, 0, 0.5}), (W{1, -0.75, -0.25, 0}));
  EXPECT_EQ(weights({0, 0, 0.5}), (W{1, -1, 0, 0}));
  EXPECT_EQ(weights({0, 0, 0}), (W{1, -1, 0, 0}));
}

TEST(ClosestPoints, KnowEachRegionOfTwoEdgesExactly) {
  const Vector3 a(-1, 0, 0), b(1, 0, 0);
  const auto weights = [&](const Vector3& c, const Vector3& d) {
    return pair_distance<3>(PairKind::edge_edge, std::array{a, b, c, d}).weights;
  };
  using W = std::array<double, 4>;
  EXPECT_EQ(weights({0, -1, 1}, {0, 1, 1}), (W{0.5, 0.5, -0.5, -0.5}));
  EXPECT_EQ(weights({0, 1, 1}, {0, 3, 1}), (W{0.5, 0.5, -1, 0}));
  EXPECT_EQ(weights({3, -1, 1}, {3, 1, 1}), (W{0, 1, -0.5, -0.5}));
  EXPECT_EQ(weights({2, 1, 1}, {3, 2, 1}), (W{0, 1, -1, 0}));
  // Parallel: some end and a point of the other edge, always the same one.
  EXPECT_EQ(weights({0, 0, 1}, {2, 0, 1}), weights({0, 0, 1}, {2, 0, 1}));
  EXPECT_DOUBLE_EQ(
      pair_distance<3>(PairKind::edge_edge, std::array<Vector3, 4>{a, b, {0, 0, 1}, {2, 0, 1}}).distance, 1);
}

/// Feet that are closer to an edge or to a vertex than the root of what distances round to: their shares are
/// as exact as all others, so that forces turn continuously from part to part.
TEST(ClosestPoints, FindFeetNextToEdgesAndVertices) {
  using W = std::array<double, 4>;
  const auto are_the_weights = [](PairKind kind, const std::array<Vector3, 4>& x, const W& expected) {
    const W weights = pair_distance<3>(kind, x).weights;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(weights[i], expected[i], 1e-14);
      EXPECT_EQ(weights[i] == 0, expected[i] == 0);
    }
  };
  SamplePairs<3> samples(PairKind::point_triangle, 7);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Vector3 p = samples.place(), e = samples.place(), f = samples.place();
    if (e.cross(f).norm() < 0.3) continue;
    const Vector3 n = e.cross(f).normalized(), out = e.cross(n).normalized();
    const double o = std::pow(10, samples.uniform(-13, -7)), s = samples.uniform(0.1, 0.9),
                 gap = std::pow(10, samples.uniform(-4, 0));
    const auto above_triangle = [&](double u, double v) {
      const std::array x{Vector3(p + u * e + v * f + gap * n), p, Vector3(p + e), Vector3(p + f)};
      are_the_weights(PairKind::point_triangle, x, {1, u + v - 1, -u, -v});
    };
    above_triangle(s, o);
    above_triangle(o, s);
    above_triangle(1 - s - o, s);
    above_triangle(o, 0.3 * o);
    above_triangle(1 - 2 * o, o);
    above_triangle(o, 1 - 2 * o);
    // Beside the triangle, at its edge e and next to both ends.
    for (const double u : {o, 1 - o}) {
      const Vector3 place = p + u * e + gap * (0.8 * out + 0.6 * n);
      are_the_weights(PairKind::point_triangle, {place, p, p + e, p + f}, {1, u - 1, -u, 0});
      are_the_weights(PairKind::point_triangle, {place, p + f, p, p + e}, {1, 0, u - 1, -u});
      are_the_weights(PairKind::point_triangle, {place, p + e, p + f, p}, {1, -u, 0, u - 1});
    }
    // Edges that cross next to an end of one of them or of both, and an end beside the other edge.
    for (const double u : {o, 1 - o})
      for (const double v : {s, o, 1 - o}) {
        const Vector3 q = p + u * e + gap * n - v * f;
        are_the_weights(PairKind::edge_edge, {p, p + e, q, q + f}, {1 - u, u, v - 1, -v});
        are_the_weights(PairKind::edge_edge, {q, q + f, p, p + e}, {1 - v, v, u - 1, -u});
      }
    const Vector3 end = p + o * e + gap * out, away = end + samples.uniform(0.1, 2) * out + s * n;
    are_the_weights(PairKind::edge_edge, {end, away, p, p + e}, {1, 0, o - 1, -o});
    are_the_weights(PairKind::edge_edge, {away, end, p, p + e}, {0, 1, o - 1, -o});
    are_the_weights(PairKind::edge_edge, {p, p + e, end, away}, {1 - o, o, -1, 0});
    are_the_weights(PairKind::edge_edge, {p, p + e, away, end}, {1 - o, o, 0, -1});
  }
}

/// Edges that cross in their middles at a small angle: the parameters follow from triple products to
/// 1e-16 / angle times what the gap leaves, the distance to all digits.
TEST(ClosestPoints, KeepTheirDigitsForNearlyParallelEdges) {
  for (const double angle : {1e-2, 1e-4, 1e-6}) {
    const double gap = 1e-3;
    const Vector3 along(std::cos(angle), std::sin(angle), 0), up(0, 0, gap);
    const std::array<Vector3, 4> x = {Vector3(-1, 0, 0), Vector3(1, 0, 0), up - along, up + along};
    const PairDistance<3> pair = pair_distance<3>(PairKind::edge_edge, x);
    EXPECT_NEAR(pair.distance, gap, 1e-15 * gap);
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(std::abs(pair.weights[static_cast<std::size_t>(i)]), 0.5, 1e-15 / angle);
    EXPECT_NEAR(pair.normal.z(), -1, 1e-12);
  }
}

TEST(ClosestPoints, OfNumbersThatAreNoneAreNoneAtAll) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const PairKind kind : testing::every_pair_kind) {
    std::vector<Vector3> x = SamplePairs<3>(kind, 1).plain();
    x[0].y() = nan;
    EXPECT_FALSE(squared_distance<3>(kind, x) >= 0) << testing::name_of(kind);
  }
}

TEST(Features, AreOneWhateverPairTheyWereFoundIn) {
  // A point over the common corner 7 of three triangles, and over their common edge 7-8.
  using V = std::array<Index, 4>;
  const std::array<double, 4> corner = {1, 0, -1, 0};
  const Feature at_corner = closest_feature(PairKind::point_triangle, V{3, 5, 7, 8}, corner);
  EXPECT_EQ(at_corner, (Feature{PairKind::point_point, {3, 7, -1, -1}}));
  EXPECT_EQ(at_corner, closest_feature(PairKind::point_triangle, V{3, 8, 7, 9}, corner));
  EXPECT_EQ(at_corner, closest_feature(PairKind::edge_edge, V{7, 1, 2, 3}, {1, 0, 0, -1}));
  const Feature at_edge = closest_feature(PairKind::point_triangle, V{3, 8, 7, 9}, {1, -0.5, -0.5, 0});
  EXPECT_EQ(at_edge, (Feature{PairKind::point_edge, {3, 7, 8, -1}}));
  EXPECT_EQ(at_edge, closest_feature(PairKind::edge_edge, V{8, 7, 3, 2}, {0.25, 0.75, -1, 0}));
  EXPECT_EQ(closest_feature(PairKind::edge_edge, V{9, 4, 2, 3}, {0.5, 0.5, -0.5, -0.5}),
            (Feature{PairKind::edge_edge, {2, 3, 4, 9}}));
  EXPECT_EQ(closest_feature(PairKind::point_triangle, V{4, 3, 2, 1}, {1, -0.5, -0.25, -0.25}),
            (Feature{PairKind::point_triangle, {4, 1, 2, 3}}));
}

}  // namespace
}  // namespace resilin
