#include "resilin/contact/collider_barrier.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "resilin/contact/catalog.hpp"
#include "resilin/contact/half_space.hpp"
#include "resilin/contact/sphere.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double dhat = 0.02;  // m

ShapeDescription sample_shape(int dim) {
  ShapeDescription d;
  d.point = {0.1, -0.2, dim == 3 ? 0.3 : 0.0};
  d.normal = {0.5, 1, dim == 3 ? -2.0 : 0};
  d.center = {-0.3, 0.2, dim == 3 ? 0.1 : 0.0};
  d.radius = 0.7;
  return d;
}

VectorX random_direction(Eigen::Index size) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  VectorX p(size);
  for (double& value : p) value = normal(random);
  return p;
}

VectorX gradient(const ColliderBarrier& barrier, const VectorX& x) {
  VectorX g = VectorX::Zero(x.size());
  barrier.add_gradient(x, {}, g);
  return g;
}

Eigen::MatrixXd hessian(const ColliderBarrier& barrier, int dim, const VectorX& x, Projection projection) {
  const auto num_nodes = static_cast<Index>(x.size() / dim);
  BlockMatrix A(dim, std::make_shared<BlockPattern>(BlockPatternBuilder(num_nodes).build()));
  barrier.add_hessian(x, {}, projection, A);
  EXPECT_TRUE(A.extra.empty());  // diagonal blocks are always in the pattern
  Eigen::MatrixXd dense(x.size(), x.size());
  VectorX unit = VectorX::Zero(x.size()), column;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    unit[i] = 1;
    multiply(A, unit, column);
    dense.col(i) = column;
    unit[i] = 0;
  }
  return dense;
}

/// Every kind of collider in 2D and in 3D, with 40 nodes in random places of which about half are within the
/// activation distance, at d > 0.
struct EveryCollider : ::testing::TestWithParam<std::tuple<std::string_view, int>> {
  const int dim = std::get<1>(GetParam());
  const std::shared_ptr<const ColliderShape> shape =
      find_shape_kind(std::get<0>(GetParam()))->make(sample_shape(dim));
  VectorX x{Eigen::Index{40} * dim};
  ColliderBarrier barrier{"it", dim, shape, placed_nodes(), dhat};

  std::vector<ContactNode> placed_nodes() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1), share(0.02, 2);
    std::vector<ContactNode> nodes;
    for (Index i = 0; i < 40; ++i) {
      nodes.push_back({i, 5 + uniform(random)});
      Vector3 place(uniform(random), uniform(random), dim == 3 ? uniform(random) : 0);
      place += (share(random) * dhat - shape->distance(place)) * shape->normal(place);
      x.segment(Eigen::Index{i} * dim, dim) = place.head(dim);
    }
    return nodes;
  }
  Vector3 random_place(std::mt19937& random, double size) const {
    std::uniform_real_distribution<double> uniform(-size, size);
    Vector3 place(uniform(random), uniform(random), uniform(random));
    if (dim == 2) place.z() = 0;
    return place;
  }
};

std::vector<std::string_view> names_of_shapes() {
  std::vector<std::string_view> names;
  for (const ShapeKind& kind : shape_kinds())
    if (kind.make != nullptr) names.push_back(kind.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryCollider,
                         ::testing::Combine(::testing::ValuesIn(names_of_shapes()), ::testing::Values(2, 3)),
                         [](const auto& entry) {
                           return std::string(std::get<0>(entry.param)) + "_" +
                                  std::to_string(std::get<1>(entry.param)) + "d";
                         });

TEST_P(EveryCollider, IsOfItsKindAndNearNodesThatItDoesNotTouch) {
  EXPECT_EQ(shape->kind(), std::get<0>(GetParam()));
  EXPECT_GT(barrier.nearest(x, {}).distance, 0);
  EXPECT_LT(barrier.nearest(x, {}).distance, dhat);
}

TEST_P(EveryCollider, HasAUnitNormalThatIsTheSlopeOfItsDistance) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Vector3 place = random_place(random, 1), n = shape->normal(place);
    EXPECT_NEAR(n.norm(), 1, 1e-15);
    EXPECT_LT((shape->curvature(place) * n).norm(), 1e-14 * (1 + shape->curvature(place).norm()));
    const double h = 1e-6;
    for (int k = 0; k < dim; ++k) {
      const Vector3 e = h * Vector3::Unit(k);
      EXPECT_NEAR((shape->distance(place + e) - shape->distance(place - e)) / (2 * h), n[k], 1e-9);
      EXPECT_NEAR(shape->distance_change(place - e, place + e) / (2 * h), n[k], 1e-9);
      const Vector3 turn = (shape->normal(place + e) - shape->normal(place - e)) / (2 * h);
      EXPECT_LT((turn - shape->curvature(place).col(k)).norm(), 1e-8 * (1 + shape->curvature(place).norm()));
    }
  }
}

TEST_P(EveryCollider, IsCalledFlatWhereItDoesNotCurve) {
  EXPECT_EQ(shape->is_flat(), shape->curvature(Vector3(1, 2, 3)).isZero(0));
}

TEST_P(EveryCollider, TellsWhenAPathFirstComesNear) {
  std::mt19937 random(5);
  int met = 0;
  for (int i = 0; i < 1000; ++i) {
    Vector3 place = random_place(random, 2);
    if (shape->distance(place) < 0) place += (0.1 - shape->distance(place)) * shape->normal(place);
    const Vector3 p = random_place(random, 3);
    const double wanted = 0.1 * shape->distance(place);
    const double t = shape->time_of_approach(place, p, wanted);
    // Never before t on the way there, exactly then.
    for (double s = 0; s < 1; s += 0.05)
      EXPECT_GT(shape->distance(place + s * std::min(t, 10.0) * p), wanted - 1e-12);
    if (t > 1e3) continue;
    ++met;
    EXPECT_NEAR(shape->distance(place + t * p), wanted, 1e-11 * (1 + t));
  }
  EXPECT_GT(met, 50);
}

TEST_P(EveryCollider, HasItsSlopeAsGradientAndItsCurvatureAsHessian) {
  const VectorX p = random_direction(x.size());
  const VectorX g = gradient(barrier, x);
  const double h = 1e-8;  // 1e-5 of the smallest distance
  EXPECT_GT(g.norm(), 0);
  EXPECT_NEAR((barrier.value(x + h * p, {}) - barrier.value(x - h * p, {})) / (2 * h), g.dot(p),
              1e-6 * g.norm() * p.norm());
  EXPECT_NEAR(barrier.difference(x - h * p, x + h * p, {}) / (2 * h), g.dot(p), 1e-7 * g.norm() * p.norm());
  const VectorX difference = (gradient(barrier, x + h * p) - gradient(barrier, x - h * p)) / (2 * h);
  EXPECT_LT((hessian(barrier, dim, x, Projection::none) * p - difference).norm(), 1e-5 * difference.norm());
  VectorX magnitude = VectorX::Zero(x.size());
  barrier.add_gradient_magnitude(x, {}, magnitude);
  EXPECT_EQ(magnitude, g.cwiseAbs());
}

TEST_P(EveryCollider, IsPositiveSemidefiniteOnceProjected) {
  for (const Projection projection : {Projection::clamp, Projection::absolute}) {
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian(barrier, dim, x, projection)).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-13 * values.maxCoeff());
  }
  // Projection leaves the push along the normal alone.
  const Eigen::MatrixXd change =
      hessian(barrier, dim, x, Projection::clamp) - hessian(barrier, dim, x, Projection::none);
  for (const Index node : barrier.points().numbers) {
    const Vector3 y = node_position(dim, node, x);
    const VectorX n = barrier.shape().normal(y).head(dim);
    EXPECT_LT((change.block(node * dim, node * dim, dim, dim) * n).norm(), 1e-12 * (1 + change.norm()));
  }
}

TEST_P(EveryCollider, StepsAtMostNineTenthsOfTheWayIn) {
  for (const double length : {1e-3, 0.1, 1.0, 1e6}) {
    const VectorX p = length * random_direction(x.size());
    const double t = barrier.max_step(x, p, {});
    ASSERT_GT(t, 0);
    ASSERT_LE(t, 1);
    for (const Index node : barrier.points().numbers) {
      const double before = barrier.shape().distance(node_position(dim, node, x));
      const double after = barrier.shape().distance(node_position(dim, node, x + t * p));
      EXPECT_GE(after, 0.1 * before - 1e-9 * before);
    }
    EXPECT_TRUE(std::isfinite(barrier.value(x + t * p, {})));
  }
  EXPECT_EQ(barrier.max_step(x, 1e-9 * random_direction(x.size()), {}), 1);
}

TEST_P(EveryCollider, CanBeMovedTowardsBodiesWithoutTouchingThem) {
  const double before = barrier.nearest(x, {}).distance;
  const Vector3 motion = 10 * barrier.shape().normal(Vector3::Zero());
  for (int i = 0; i < 20; ++i) {
    const double part = barrier.largest_motion(x, motion, {});
    ASSERT_GT(part, 0);
    barrier.move_by(part * motion);
    ASSERT_GT(barrier.nearest(x, {}).distance, 0);
  }
  EXPECT_LT(barrier.nearest(x, {}).distance, 1e-5 * before);
  // A half-space has all bodies on one side, and goes away from them all the way.
  if (barrier.shape().kind() == "half_space") {
    EXPECT_EQ(barrier.largest_motion(x, -motion, {}), 1);
  }
  barrier.move_to(barrier.shape().reference_point());
  EXPECT_EQ(barrier.nearest(x, {}).distance, before);
}

TEST(ColliderBarrier, MovesWithTimeUntilItStops) {
  const auto floor = std::make_shared<HalfSpace>(Vector3(0, 0, 1), Vector3(0, 0, 2));
  const ColliderBarrier barrier("floor", 3, floor, {{0, 1}}, dhat, {.velocity = {0, 0, 0.5}, .until = 2});
  const VectorX x = Vector3(4, 5, 3);
  EXPECT_EQ(barrier.nearest(x, {.time = 0}).distance, 2);
  EXPECT_EQ(barrier.nearest(x, {.time = 1}).distance, 1.5);
  EXPECT_EQ(barrier.nearest(x, {.time = 7}).distance, 1);
  EXPECT_EQ(barrier.nearest(x, {.time = 1, .delay = 0.5}).distance, 1.75);
  EXPECT_EQ(barrier.place({.time = 7}), Vector3(0, 0, 2));
}

TEST(ColliderBarrier, IsNotThereWhenSwitchedOff) {
  const auto ball = std::make_shared<Sphere>(Vector3(0, 0, 0), 1);
  ColliderBarrier barrier("ball", 3, ball, {{0, 1}}, dhat);
  const VectorX x = Vector3(0.5, 0, 0), outside = Vector3(1.01, 0, 0);
  EXPECT_EQ(barrier.value(x, {}), std::numeric_limits<double>::infinity());
  EXPECT_GT(barrier.reaction(outside, {})->force.x(), 0);
  barrier.set_active(false);
  EXPECT_EQ(barrier.value(x, {}), 0);
  EXPECT_EQ(barrier.max_step(outside, -outside, {}), 1);
  EXPECT_EQ(barrier.reaction(outside, {})->force, Vector3::Zero());
  barrier.set_active(true);
  barrier.set_shape(std::make_shared<Sphere>(Vector3(0, 0, 0), 0.4));
  EXPECT_TRUE(std::isfinite(barrier.value(x, {})));
}

/// Facets in one plane share its area; a corner of a box has its share of one face.
TEST(ContactNodes, ShareTheSurfaceAmongAllTheirNodes) {
  for (const char* kind : {"P1", "P2"}) {
    Mesh mesh = make_box({1, 2, 3}, {1, 2, 2});
    if (std::string_view(kind) == "P2") mesh = second_order(mesh).mesh;
    VectorX X(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      X.segment<3>(3 * static_cast<Eigen::Index>(i)) = mesh.vertices[i];
    const CellBlock facets = boundary(*mesh.find_solid(3)).facets;
    CellBlock bottom{.kind = facets.kind, .nodes = {}};
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = facets.cell(facet);
      if (std::ranges::all_of(nodes, [&](Index node) { return X[3 * node + 2] == 0; }))
        bottom.nodes.insert(bottom.nodes.end(), nodes.begin(), nodes.end());
    }
    std::map<Index, double> of_all;
    for (const ContactNode& node : contact_nodes(3, facets, X, 7)) {
      EXPECT_GT(node.stiffness, 0);
      of_all[node.node] = node.stiffness;
    }
    double sum = 0;
    for (const ContactNode& node : contact_nodes(3, bottom, X, 7)) {
      sum += node.stiffness;
      EXPECT_GE(of_all.at(node.node), node.stiffness * (1 - 1e-12));  // stiffness of the largest face
    }
    EXPECT_NEAR(sum, 7 * 2.0, 1e-12 * sum) << kind;
  }
}

/// On a ball, whose facets look in nearly one direction around each node, next to nothing is lost.
TEST(ContactNodes, OfARoundSurfaceHaveItsArea) {
  const int count = 60;
  VectorX X(2 * count);
  CellBlock ring{.kind = CellKind::line, .nodes = {}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / count;
    X.segment<2>(2 * Eigen::Index{i}) << std::cos(angle), std::sin(angle);
    ring.nodes.insert(ring.nodes.end(), {i, (i + 1) % count});
  }
  const double length = 2 * std::sin(std::acos(-1.0) / count), bend = std::cos(2 * std::acos(-1.0) / count);
  for (const ContactNode& node : contact_nodes(2, ring, X, 1))
    EXPECT_NEAR(node.stiffness, 0.5 * length * (1 + bend), 1e-12);
}

TEST(ContactNodes, OfASecondOrderLineAreThoseOfSimpsonsRule) {
  VectorX X(6);
  X << 0, 0, 6, 0, 3, 0;
  const std::vector<ContactNode> nodes = contact_nodes(2, {CellKind::line3, {0, 1, 2}}, X, 1);
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_NEAR(nodes[0].stiffness, 1, 1e-14);
  EXPECT_NEAR(nodes[1].stiffness, 1, 1e-14);
  EXPECT_NEAR(nodes[2].stiffness, 4, 1e-14);
}

/// As a pressure would share: the integrals of N_a 2 pi r; of second order those of N_a^2 in proportion.
TEST(ContactNodes, OfATurnedLineAreThoseOfTheFullTurn) {
  const double pi = std::acos(-1.0);
  VectorX X(6);
  X << 0, 0, 6, 0, 3, 0;
  const Depth turned{.is_turned = true};
  const std::vector<ContactNode> linear = contact_nodes(2, {CellKind::line, {0, 1}}, X, 1, turned);
  ASSERT_EQ(linear.size(), 2U);
  EXPECT_NEAR(linear[0].stiffness, 12 * pi, 1e-12);
  EXPECT_NEAR(linear[1].stiffness, 24 * pi, 1e-12);
  const std::vector<ContactNode> nodes = contact_nodes(2, {CellKind::line3, {0, 1, 2}}, X, 1, turned);
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_NEAR(nodes[0].stiffness, 1.5 * pi, 1e-12);
  EXPECT_NEAR(nodes[1].stiffness, 10.5 * pi, 1e-12);
  EXPECT_NEAR(nodes[2].stiffness, 24 * pi, 1e-12);
  X << 0, 0, 0, 6, 0, 3;
  EXPECT_TRUE(contact_nodes(2, {CellKind::line3, {0, 1, 2}}, X, 1, turned).empty());
}

}  // namespace
}  // namespace resilin
