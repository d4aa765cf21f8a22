#include "resilin/contact/ball_facets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/sphere.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double reach = 2e-3;   // activation distance [m]
constexpr double radius = 0.03;  // radius of the ball [m]
constexpr double kappa = 1e5;    // Pa

VectorX ball_test_ways(Eigen::Index size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VectorX p(size);
  for (double& value : p) value = normal(random);
  return p;
}

/// A ball close to a block of 0.2 m that is one or a few cells: its nodes are far away.
struct BallCase {
  std::string name;
  Mesh mesh;
  Vector3 center;  // centre of the ball, its gap half the activation distance [m]
};

std::vector<BallCase> ball_cases() {
  const Vector3 up3(0, 0, radius + 0.5 * reach), up2(0, radius + 0.5 * reach, 0);
  const Vector3 low(0, 0, -0.2);
  const Mesh tetrahedra = make_box(Vector3::Constant(0.2), {1, 1, 1}, low);
  const Mesh triangles = make_rectangle({0.2, 0.2}, {1, 1}, {0, -0.2});
  const double diagonal = (radius + 0.5 * reach) / std::sqrt(2.0);
  return {{"facet", tetrahedra, Vector3(0.13, 0.06, 0) + up3},
          {"edge_within_a_face", tetrahedra, Vector3(0.081, 0.081, 0) + up3},
          {"ridge", tetrahedra, {0.2 + diagonal, 0.09, diagonal}},
          {"quadratic_facet", second_order(tetrahedra).mesh, Vector3(0.17, 0.04, 0) + up3},
          {"bilinear_facet", make_hexahedron_box(Vector3::Constant(0.2), {1, 1, 1}, low),
           Vector3(0.13, 0.06, 0) + up3},
          {"line", triangles, Vector3(0.07, 0, 0) + up2},
          {"quadratic_line", second_order(triangles).mesh, Vector3(0.06, 0, 0) + up2},
          {"side_of_a_quadrilateral", make_quadrilateral_rectangle({0.2, 0.2}, {1, 1}, {0, -0.2}),
           Vector3(0.07, 0, 0) + up2}};
}

class BallCases : public ::testing::TestWithParam<int> {
 protected:
  const BallCase at = ball_cases()[static_cast<std::size_t>(GetParam())];
  const int dim = at.center.z() == 0 ? 2 : 3;
  const ContactBody body{boundary(*at.mesh.find_solid(dim)).facets, kappa};
  VectorX x = places();

  VectorX places() const {
    VectorX all(static_cast<Eigen::Index>(at.mesh.vertices.size()) * dim);
    for (std::size_t v = 0; v < at.mesh.vertices.size(); ++v)
      all.segment(static_cast<Eigen::Index>(v) * dim, dim) = at.mesh.vertices[v].head(dim);
    return all;
  }
  std::shared_ptr<const BallFacets> facets(double size_of_ball) const {
    const ContactObstacle center{
        .mesh = {.vertices = {Vector3::Zero()},
                 .facets = std::vector<Index>(static_cast<std::size_t>(dim), Index{0})},
        .motion = {}};
    return std::make_shared<const BallFacets>(make_contact_surface(dim, std::span(&body, 1), x, center), x,
                                              size_of_ball, reach);
  }
  ColliderBarrier barrier(ColliderMotion motion = {}, double friction = 0) const {
    ColliderBarrier ball("ball", dim, std::make_shared<Sphere>(at.center, radius),
                         contact_nodes(dim, body.facets, x, kappa), reach, std::move(motion), friction);
    ball.meet_facets(facets(radius));
    return ball;
  }
};

INSTANTIATE_TEST_SUITE_P(All, BallCases, ::testing::Range(0, static_cast<int>(ball_cases().size())),
                         [](const auto& entry) {
                           return ball_cases()[static_cast<std::size_t>(entry.param)].name;
                         });

VectorX ball_test_gradient(const ColliderBarrier& ball, const VectorX& x) {
  VectorX gradient = VectorX::Zero(x.size());
  ball.add_gradient(x, {}, gradient);
  return gradient;
}

TEST_P(BallCases, SeeTheGapBetweenTheNodes) {
  const ColliderBarrier ball = barrier();
  EXPECT_GT(ball.nearest(x, {}).distance, 5 * reach);
  EXPECT_NEAR(ball.gap(x, {}), 0.5 * reach, 1e-12);
  EXPECT_GT(ball.value(x, {}), 0);
}

TEST_P(BallCases, HaveTheDerivativesOfTheirEnergy) {
  const ColliderBarrier ball = barrier();
  const VectorX at_rest = x + 1e-4 * ball_test_ways(x.size(), 3), p = ball_test_ways(x.size(), 5);
  const double h = 1e-8;
  const VectorX g = ball_test_gradient(ball, at_rest);
  ASSERT_GT(g.norm(), 0);
  EXPECT_NEAR(ball.difference(at_rest - h * p, at_rest + h * p, {}) / (2 * h), g.dot(p),
              1e-6 * g.norm() * p.norm());
  EXPECT_NEAR(ball.value(at_rest + h * p, {}) - ball.value(at_rest - h * p, {}), 2 * h * g.dot(p),
              1e-5 * h * g.norm() * p.norm());
  const auto num_nodes = static_cast<Index>(x.size() / dim);
  BlockPatternBuilder pattern(num_nodes);
  std::vector<Index> all;
  for (Index node = 0; node < num_nodes; ++node) all.push_back(node);
  pattern.add_cells(all, static_cast<int>(num_nodes));
  BlockMatrix hessian(dim, std::make_shared<BlockPattern>(pattern.build()));
  ball.add_hessian(at_rest, {}, Projection::none, hessian);
  VectorX product;
  multiply(hessian, p, product);
  const VectorX difference =
      (ball_test_gradient(ball, at_rest + h * p) - ball_test_gradient(ball, at_rest - h * p)) / (2 * h);
  EXPECT_LT((product - difference).norm(), 2e-5 * difference.norm());
}

TEST_P(BallCases, ActAndReact) {
  const ColliderBarrier ball = barrier();
  const VectorX g = ball_test_gradient(ball, x);
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  for (Index node = 0; node < static_cast<Index>(x.size() / dim); ++node) {
    force -= node_position(dim, node, g);
    torque -= node_position(dim, node, x).cross(node_position(dim, node, g));
  }
  const std::optional<Reaction> reaction = ball.reaction(x, {});
  ASSERT_TRUE(reaction);
  EXPECT_GT(reaction->force.norm(), 1e-3);
  EXPECT_LT((reaction->force - force).norm(), 1e-12 * force.norm());
  EXPECT_LT((reaction->torque - torque).norm(), 1e-12 * force.norm());
}

/// However nodes are thrown, no facet comes nearer to the ball than a tenth of its gap.
TEST_P(BallCases, KeepTheirDistanceInEveryStep) {
  const ColliderBarrier ball = barrier();
  int cut = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const VectorX p = 0.3 * ball_test_ways(x.size(), seed);
    const double step = ball.max_step(x, p, {});
    cut += step < 1 ? 1 : 0;
    for (const double t : {0.25, 0.5, 0.75, 1.0})
      EXPECT_GT(ball.gap(x + t * step * p, {}), (0.1 - 1e-9) * ball.gap(x, {})) << "seed " << seed;
  }
  EXPECT_GT(cut, 20);
}

TEST_P(BallCases, StayBehindWhereFacetsAreInTheWay) {
  const ColliderBarrier ball = barrier({.velocity = (dim == 2 ? Vector3(0, -1, 0) : Vector3(0, 0, -1))});
  const Conditions wanted{.time = 0.05, .delay = 0.05};
  const double delay = ball.least_delay(x, wanted);
  EXPECT_GT(delay, 0.04);
  EXPECT_GT(ball.gap(x, {.time = 0.05, .delay = delay}), 0);
}

TEST_P(BallCases, HaveTheDerivativesOfTheirParameters) {
  const ColliderBarrier ball = barrier();
  const VectorX w = ball_test_ways(x.size(), 11);
  for (const EnergyParameter& parameter : ball.parameters()) {
    const VectorX change = ball_test_ways(parameter.size, 13);
    VectorX forces = VectorX::Zero(x.size()), slopes = VectorX::Zero(parameter.size);
    ball.add_parameter_forces(parameter.name, x, change, {.time = 0.1}, forces);
    ball.add_parameter_slopes(parameter.name, x, w, {.time = 0.1}, slopes);
    EXPECT_NEAR(forces.dot(w), slopes.dot(change), 1e-10 * (1e-9 + std::abs(slopes.dot(change))))
        << parameter.name;
    if (parameter.name == "place") {
      EXPECT_GT(forces.norm(), 0);
    }
  }
}

TEST_P(BallCases, LeaveOutFacetsThatAreSmallBesideTheBall) {
  EXPECT_FALSE(facets(1.0)->empty());
  EXPECT_TRUE(facets(200.0)->empty());
}

/// A facet that slides feels friction against its way, no more than the coefficient times the normal force.
TEST_P(BallCases, HaveFrictionAtTheTouchedPoint) {
  const ColliderBarrier ball = barrier({}, 0.5);
  FrictionContacts contacts;
  ball.add_friction_contacts(x, x, {}, contacts);
  double limit = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    limit += contacts[i].contact.limit;
    double sum = 0;
    for (const WeightedNode& node : contacts[i].nodes) sum += node.weight;
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  EXPECT_NEAR(limit, 0.5 * ball.reaction(x, {})->force.norm(), 1e-9 * limit);
}

/// In a valley both sides press, each for itself.
TEST(ABallInAValley, IsPressedByBothSides) {
  CellBlock facets{.kind = CellKind::line, .nodes = {2, 1, 1, 0}};
  const ContactBody body{facets, kappa};
  VectorX x(6);
  x << -1, 1, 0, 0, 1, 1;
  const ContactObstacle center{.mesh = {.vertices = {Vector3::Zero()}, .facets = {0, 0}}, .motion = {}};
  const BallFacets valley(make_contact_surface(2, std::span(&body, 1), x, center), x, radius, reach);
  const Ball ball{.center = {0, (radius + 0.5 * reach) * std::sqrt(2.0), 0}, .radius = radius};
  int pressing = 0;
  for (const PartForce& force : valley.part_forces(x, ball)) {
    EXPECT_NEAR(force.distance, 0.5 * reach, 1e-12);
    pressing += force.force > 0 ? 1 : 0;
  }
  EXPECT_EQ(pressing, 2);
}

}  // namespace
}  // namespace resilin
