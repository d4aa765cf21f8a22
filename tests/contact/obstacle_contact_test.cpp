#include "resilin/contact/obstacle_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/half_space.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double felt_from = 0.02;       // activation distance [m]
constexpr double block_stiffness = 1e5;  // Pa

/// A block upon z = 0 (y = 0 in 2D), a clearance above.
struct Block {
  int dim;
  ContactBody body;
  VectorX positions;

  Block(int dimension, int n, double clearance) : dim(dimension) {
    const Mesh mesh = dim == 3 ? make_box({1, 1, 0.5}, {n, n, 1}, {-0.5, -0.5, clearance})
                               : make_rectangle({1, 0.5}, {n, 1}, {-0.5, clearance});
    body = {boundary(*mesh.find_solid(dim)).facets, block_stiffness};
    positions.resize(static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      positions.segment(static_cast<Eigen::Index>(v) * dim, dim) = mesh.vertices[v].head(dim);
  }
  ObstacleContact contact(ContactObstacle obstacle) const {
    return {"obstacle", make_contact_surface(dim, std::span(&body, 1), positions, std::move(obstacle)),
            felt_from, positions};
  }
};

/// The plane z = 0 from -size to size in n by n squares, each cut in two; in 2D the line y = 0 in n parts.
ColliderMesh sheet(int dim, double size, int n) {
  const Mesh mesh = make_rectangle({2 * size, dim == 3 ? 2 * size : 1}, {n, dim == 3 ? n : 1},
                                   {-size, dim == 3 ? -size : 0});
  if (dim == 3) return collider_mesh(mesh, 3);
  ColliderMesh line;
  for (Index i = 0; i <= n; ++i) {
    line.vertices.emplace_back(-size + 2 * size * i / n, 0, 0);
    if (i > 0) line.facets.insert(line.facets.end(), {i - 1, i});
  }
  return line;
}

VectorX obstacle_test_gradient(const Energy& energy, const VectorX& x, const Conditions& c = {}) {
  VectorX gradient = VectorX::Zero(x.size());
  energy.add_gradient(x, c, gradient);
  return gradient;
}

double upward_force(const Energy& energy, const Block& block) {
  const VectorX gradient = obstacle_test_gradient(energy, block.positions);
  double force = 0;
  for (Eigen::Index i = block.dim - 1; i < gradient.size(); i += block.dim) force -= gradient[i];
  return force;
}

/// Force of a half-space at the same gap.
double force_of_half_space(const Block& block) {
  const ColliderBarrier floor(
      "floor", block.dim, std::make_shared<HalfSpace>(Vector3::Zero(), Vector3::Unit(block.dim - 1)),
      contact_nodes(block.dim, block.body.facets, block.positions, block_stiffness), felt_from);
  return upward_force(floor, block);
}

/// However a flat floor is cut into parts, a block feels the force that a half-space gives.
TEST(AFlatMesh, PushesAsAHalfSpaceDoes) {
  for (const int dim : {2, 3})
    for (const int n : {1, 3, 16, 40})
      for (const double gap : {0.2, 0.6}) {
        const Block block(dim, 6, gap * felt_from);
        const ObstacleContact floor = block.contact({sheet(dim, 2, n), {}});
        const double force = upward_force(floor, block), expected = force_of_half_space(block);
        EXPECT_GE(force, 0.999999 * expected) << dim << "D, " << n;
        EXPECT_LE(force, 1.03 * expected) << dim << "D, " << n;  // 2 % by the floor's own points
        EXPECT_NEAR(floor.reaction(block.positions, {})->force[dim - 1], force, 1e-12 * force);
      }
}

struct ObstacleCase {
  std::string name;
  int dim;
  ContactObstacle obstacle;
};

/// Everything that may be an obstacle, pressed against the underside of a block, on its way.
std::vector<ObstacleCase> obstacle_cases() {
  const ColliderMotion turning{
      .velocity = {0.1, 0, 0},
      .turn = ColliderTurn{
          .axis = {0, 0, 1}, .center = {0.05, 0.02, 0}, .degrees = 11, .degrees_per_second = 70}};
  const ColliderMotion swinging{
      .displacement = {0.02, 0.01, 0},
      .time_function = {TimeFunction::Sine{.frequency = 3}},
      .turn = ColliderTurn{.axis = {1, 2, 10}, .center = {0.1, 0, -1}, .degrees_per_second = 0.5}};
  const ColliderMotion rising{.velocity = {0.01, 0.02, 0}};
  const ColliderMotion tipping{
      .turn = ColliderTurn{.center = {0.05, -0.5, 0}, .degrees = 0.3, .degrees_per_second = 0.5}};
  const auto points = [](int dim) {
    ColliderMesh mesh;
    for (Index i = 0; i < 8; ++i) {
      mesh.vertices.emplace_back(-0.4 + 0.11 * i, dim == 3 ? 0.3 - 0.09 * i : 0, 0);
      for (int k = 0; k < dim; ++k) mesh.facets.push_back(i);
    }
    return mesh;
  };
  const ColliderMesh knives{
      .vertices = {{-0.3, -0.7, -0.001}, {-0.1, 0.6, 0}, {0.3, 0.8, 0.001}, {0.1, -0.4, 0}},
      .facets = {0, 1, 1, 2, 3, 3}};
  const ColliderMesh roof{.vertices = {{-0.8, -0.3, 0}, {0, 0, 0}, {0.8, -0.3, 0}}, .facets = {0, 1, 1, 2}};
  return {
      {"sheet", 3, {sheet(3, 0.4, 3), turning}},
      {"box", 3, {box_mesh({0, 0, -0.2}, {0.5, 0.7, 0.4}, 3), turning}},
      {"tilted box", 3, {box_mesh({0, 0, -0.2}, {0.5, 0.7, 0.4}, 3), swinging}},
      {"capsule", 3, {capsule_mesh({-0.2, 0, -0.15}, {0.2, 0.1, -0.15}, 0.15, 3), turning}},
      {"cylinder", 3, {cylinder_mesh({-0.2, -0.8, -0.15}, {0.2, 0.9, -0.15}, 0.15), rising}},
      {"knives", 3, {knives, swinging}},
      {"points", 3, {points(3), turning}},
      {"line", 2, {sheet(2, 0.4, 5), rising}},
      {"roof", 2, {roof, tipping}},
      {"box", 2, {box_mesh({0.1, -0.2, 0}, {0.4, 0.4, 0}, 2), tipping}},
      {"capsule", 2, {capsule_mesh({-0.2, -0.1, 0}, {0.2, -0.1, 0}, 0.1, 2), rising}},
      {"points", 2, {points(2), rising}},
  };
}

struct ObstacleCases : ::testing::TestWithParam<int> {
  ObstacleCase which = obstacle_cases()[static_cast<std::size_t>(GetParam())];
  Block block{which.dim, 4, 0.5 * felt_from};
  std::mt19937 generator{static_cast<unsigned>(GetParam())};
  Conditions conditions{.time = 0.31, .delay = 0.02, .weight = 0.7};
  VectorX x = block.positions + 1e-3 * random(block.positions.size());
  ObstacleContact contact = block.contact(which.obstacle);

  VectorX random(Eigen::Index size) {
    std::normal_distribution<double> normal;
    return VectorX::NullaryExpr(size, [&] { return normal(generator); });
  }
};
INSTANTIATE_TEST_SUITE_P(All, ObstacleCases, ::testing::Range(0, static_cast<int>(obstacle_cases().size())));

TEST_P(ObstacleCases, HaveTheDerivativesOfTheirEnergy) {
  const VectorX gradient = obstacle_test_gradient(contact, x, conditions);
  ASSERT_GT(gradient.norm(), 0) << which.name;
  const auto pattern = std::make_shared<const BlockPattern>(
      BlockPatternBuilder(static_cast<Index>(x.size() / which.dim)).build());
  BlockMatrix hessian(which.dim, pattern);
  contact.add_hessian(x, conditions, Projection::none, hessian);
  for (int i = 0; i < 3; ++i) {
    const VectorX way = random(x.size());
    const double h = 1e-7;
    EXPECT_NEAR(contact.difference(x - h * way, x + h * way, conditions) / (2 * h), gradient.dot(way),
                1e-6 * gradient.cwiseAbs().dot(way.cwiseAbs()))
        << which.name;
    const VectorX rate = (obstacle_test_gradient(contact, x + h * way, conditions) -
                          obstacle_test_gradient(contact, x - h * way, conditions)) /
                         (2 * h);
    VectorX product;
    multiply(hessian, way, product);
    EXPECT_LT((rate - product).norm(), 1e-4 * product.norm()) << which.name;
  }
}

/// Bodies and obstacle push each other with the same force and torque, and force times way is the change of
/// the energy with time.
TEST_P(ObstacleCases, ActAndReact) {
  const VectorX gradient = obstacle_test_gradient(contact, x, conditions);
  Reaction sum;
  for (Index node = 0; node < x.size() / which.dim; ++node) {
    const Vector3 force = -node_position(which.dim, node, gradient);
    sum.force += force;
    sum.torque += node_position(which.dim, node, x).cross(force);
  }
  const Reaction reaction = *contact.reaction(x, conditions);
  EXPECT_LT((reaction.force - sum.force).norm(), 1e-12 * gradient.cwiseAbs().sum()) << which.name;
  EXPECT_LT((reaction.torque - sum.torque).norm(), 1e-11 * gradient.cwiseAbs().sum()) << which.name;
  Conditions later = conditions, earlier = conditions;
  const double h = 1e-8;  // s; the power itself changes by its ten-thousandth meanwhile
  later.time += h;
  earlier.time -= h;
  const double change = contact.value(x, later) - contact.value(x, earlier);
  EXPECT_NEAR(*contact.driven_work(x, earlier, x, later) / h, change / h,
              1e-3 * std::abs(change / h) + 1e-6 * gradient.cwiseAbs().sum())
      << which.name;
}

TEST_P(ObstacleCases, StagesSeeTheSame) {
  const std::unique_ptr<Energy> own = contact.begin_stage(Stage{.base_positions = x});
  const VectorX p = 0.01 * random(x.size());
  EXPECT_EQ(own->value(x, conditions), contact.value(x, conditions));
  own->prepare(x, p, conditions);
  EXPECT_EQ(own->max_step(x, p, conditions), contact.max_step(x, p, conditions));
  const VectorX y = x + 0.3 * own->max_step(x, p, conditions) * p;
  EXPECT_EQ(own->value(y, conditions), contact.value(y, conditions));
  EXPECT_EQ(own->difference(x, y, conditions), contact.difference(x, y, conditions));
}

/// An obstacle goes on where bodies let it, and never through them.
TEST_P(ObstacleCases, StayBehindWhereBodiesAreInTheWay) {
  const auto is_apart = [&](const Conditions& c) { return contact.smallest_gap(x, c).distance > 0; };
  for (const double wanted : {0.02, 0.5, 3.0}) {
    const Conditions c{.time = conditions.time + wanted, .delay = wanted};
    const double delay = contact.least_delay(x, c);
    EXPECT_GE(delay, 0);
    EXPECT_LT(delay, wanted);
    EXPECT_TRUE(is_apart({.time = c.time, .delay = delay})) << which.name;
  }
}

TEST(AnObstacle, GoesItsWholeWayWhereNobodyIs) {
  const Block block(3, 2, 1);
  ColliderMotion motion{.velocity = {0, 0, 0.5}, .until = 1};
  const ObstacleContact rising = block.contact({box_mesh({0, 0, -0.2}, {1, 1, 0.4}, 3), motion});
  EXPECT_EQ(rising.least_delay(block.positions, {.time = 3, .delay = 3}), 0);
  motion.until = 3;
  const ObstacleContact through = block.contact({box_mesh({0, 0, -0.2}, {1, 1, 0.4}, 3), motion});
  const double delay = through.least_delay(block.positions, {.time = 3, .delay = 3});
  EXPECT_GT(delay, 1);
  EXPECT_LT(delay, 1 + 2 * felt_from);  // at the block after two seconds
}

TEST(AnObstacle, IsNotFeltByWhatIsHeld) {
  const Block block(3, 2, 0.3 * felt_from);
  ContactSurface surface = make_contact_surface(3, std::span(&block.body, 1), block.positions,
                                                ContactObstacle{sheet(3, 2, 3), {}});
  std::vector<std::uint8_t> is_held;
  for (Eigen::Index node = 0; node < block.positions.size() / 3; ++node)
    is_held.push_back(block.positions[3 * node + 2] < 0.1 ? 1 : 0);
  leave_held_out(surface, is_held);
  const ObstacleContact contact("floor", surface, felt_from, block.positions);
  EXPECT_EQ(contact.value(block.positions, {}), 0);
}

}  // namespace
}  // namespace resilin
