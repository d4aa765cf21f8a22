// Contact through surfaces that cells carry: derivatives, forces, and what is the same as through the cells'
// own.

#include <gtest/gtest.h>

#include <random>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/half_space.hpp"
#include "resilin/contact/surface_contact.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"
#include "round_skin.hpp"

namespace resilin::testing {
namespace {

constexpr double felt_skins_from = 0.02;

/// Two coarse boxes with a ball in each, the balls nearer than the activation distance, all nodes shaken.
struct CarriedBalls {
  VectorX rest;
  std::vector<ContactBody> bodies;

  CarriedBalls(const std::string& element_name, bool is_smooth, int num_cuts) {
    const ElementInfo& element = require_element(element_name, 3, "element");
    for (const double z : {0.0, 1 + 0.5 * felt_skins_from}) {
      Mesh mesh = make_box({1, 1, 1}, {2, 2, 2}, {0, 0, z});
      if (element.degree == 2) mesh = second_order(mesh).mesh;
      const auto first = static_cast<Index>(rest.size() / 3);
      std::vector<Index> cells = mesh.find_solid(3)->nodes;
      for (Index& node : cells) node += first;
      rest.conservativeResize(rest.size() + 3 * static_cast<Eigen::Index>(mesh.vertices.size()));
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        rest.segment<3>(Eigen::Index{first} * 3 + 3 * static_cast<Eigen::Index>(v)) = mesh.vertices[v];
      const Mesh ball = ball_surface(0.5, {0.5, 0.5, z + 0.5}, num_cuts);
      bodies.push_back({ball.blocks[0], z == 0 ? 1e4 : 3e5,
                        std::make_shared<Embedding>(element, cells, rest, ball.vertices, is_smooth)});
    }
  }
  SurfaceContact contact() const {
    return {"contact", make_contact_surface(3, bodies, rest), BodyMeetings(2), felt_skins_from, rest};
  }
  VectorX shaken(unsigned seed) const {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> noise(-0.003, 0.003);
    return rest + VectorX::NullaryExpr(rest.size(), [&] { return noise(generator); });
  }
};

VectorX skin_gradient(const Energy& energy, const VectorX& x) {
  VectorX gradient = VectorX::Zero(x.size());
  energy.add_gradient(x, {}, gradient);
  return gradient;
}

BlockMatrix skin_hessian(const Energy& energy, const VectorX& x, Projection projection) {
  const auto pattern =
      std::make_shared<const BlockPattern>(BlockPatternBuilder(static_cast<Index>(x.size() / 3)).build());
  BlockMatrix hessian(3, pattern);
  energy.add_hessian(x, {}, projection, hessian);
  return hessian;
}

using SkinKind = std::tuple<const char*, bool>;

struct CarriedSkins : ::testing::TestWithParam<SkinKind> {
  const CarriedBalls balls{std::get<0>(GetParam()), std::get<1>(GetParam()), 3};
  const SurfaceContact contact = balls.contact();
  const ColliderBarrier floor = make_floor();
  std::mt19937 generator{7};

  VectorX random_way() {
    std::normal_distribution<double> normal;
    return VectorX::NullaryExpr(balls.rest.size(), [&] { return normal(generator); });
  }
  ColliderBarrier make_floor() const {
    const ContactSurface surface = make_contact_surface(3, {&balls.bodies[0], 1}, balls.rest);
    ContactPoints points;
    points.places = surface.vertices;
    points.numbers = surface.numbers;
    for (const double area : surface.point_areas) points.stiffness.push_back(1e4 * area);
    return {"floor", 3, std::make_shared<HalfSpace>(Vector3(0, 0, -0.5 * felt_skins_from), Vector3::UnitZ()),
            points, felt_skins_from};
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, CarriedSkins,
                         ::testing::Values(SkinKind{"P1", false}, SkinKind{"P1", true},
                                           SkinKind{"P2", false}),
                         [](const auto& kind) {
                           return std::string(std::get<0>(kind.param)) +
                                  (std::get<1>(kind.param) ? "Smooth" : "");
                         });

TEST_P(CarriedSkins, HaveTheGradientAndHessianOfTheirEnergy) {
  for (const Energy* energy : {static_cast<const Energy*>(&contact), static_cast<const Energy*>(&floor)}) {
    const VectorX x = balls.shaken(3);
    const VectorX gradient = skin_gradient(*energy, x);
    ASSERT_GT(gradient.norm(), 0) << energy->name();
    const BlockMatrix hessian = skin_hessian(*energy, x, Projection::none);
    for (int i = 0; i < 3; ++i) {
      const VectorX way = random_way();
      const double h = 1e-7;
      EXPECT_NEAR(energy->difference(x - h * way, x + h * way, {}) / (2 * h), gradient.dot(way),
                  1e-6 * gradient.cwiseAbs().dot(way.cwiseAbs()))
          << energy->name();
      VectorX product;
      multiply(hessian, way, product);
      const VectorX rate =
          (skin_gradient(*energy, x + h * way) - skin_gradient(*energy, x - h * way)) / (2 * h);
      EXPECT_LT((rate - product).norm(), 1e-4 * product.norm()) << energy->name();
    }
  }
}

TEST_P(CarriedSkins, HaveNoNegativeCurvatureOnceProjected) {
  for (const Energy* energy : {static_cast<const Energy*>(&contact), static_cast<const Energy*>(&floor)}) {
    const VectorX x = balls.shaken(5);
    const BlockMatrix hessian = skin_hessian(*energy, x, Projection::clamp);
    for (int i = 0; i < 20; ++i) {
      const VectorX way = random_way();
      VectorX product;
      multiply(hessian, way, product);
      EXPECT_GE(way.dot(product), -1e-12 * way.norm() * product.norm()) << energy->name();
    }
  }
}

/// Weights sum to one and reproduce places: neither force nor torque is lost on the way to the nodes.
TEST_P(CarriedSkins, PushEachOtherWithOppositeForcesAndTorques) {
  const VectorX x = balls.shaken(4);
  const VectorX gradient = skin_gradient(contact, x);
  const Eigen::Index num_nodes = x.size() / 3;
  Vector3 lower = Vector3::Zero(), upper = lower;
  for (Eigen::Index node = 0; node < num_nodes; ++node)
    (node < num_nodes / 2 ? lower : upper) += gradient.segment<3>(3 * node);
  ASSERT_GT(lower.norm(), 0);
  EXPECT_LT((lower + upper).norm(), 1e-12 * lower.norm());
  const auto reported = contact.body_contacts(x, {});
  ASSERT_EQ(reported.size(), 1u);
  EXPECT_LT((reported[0].force + upper).norm(), 1e-9 * upper.norm());
}

TEST_P(CarriedSkins, KnowTheSizeOfTheirForces) {
  for (const Energy* energy : {static_cast<const Energy*>(&contact), static_cast<const Energy*>(&floor)}) {
    const VectorX x = balls.shaken(6);
    VectorX magnitude = VectorX::Zero(x.size());
    energy->add_gradient_magnitude(x, {}, magnitude);
    EXPECT_TRUE((magnitude.array() >= skin_gradient(*energy, x).cwiseAbs().array() * (1 - 1e-12)).all())
        << energy->name();
  }
}

/// The map is that of the skin that is drawn.
TEST_P(CarriedSkins, AreWhereTheyAreDrawn) {
  const VectorX x = balls.shaken(8);
  const ContactSurface& surface = contact.surface();
  const VectorX places = surface.places(x);
  for (std::size_t body = 0; body < 2; ++body) {
    const Embedding& carrier = *balls.bodies[body].carrier;
    std::vector<double> drawn(3 * static_cast<std::size_t>(carrier.num_points()));
    carrier.apply(x, drawn);
    for (std::size_t v = 0; v < surface.parts.num_vertices(); ++v) {
      if (surface.parts.bodies[v] != static_cast<Index>(body)) continue;
      const Eigen::Map<const Vector3> point(drawn.data() + 3 * surface.numbers[v]);
      EXPECT_LT((point - places.segment<3>(3 * static_cast<Eigen::Index>(v))).norm(), 1e-10);
    }
  }
}

TEST(ASkinOfTheCellsOwnFacets, IsTheirOwnSurface) {
  const Mesh mesh = make_box({1, 1, 0.5}, {3, 3, 2});
  const CellBlock& cells = *mesh.find_solid(3);
  VectorX rest(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    rest.segment<3>(3 * static_cast<Eigen::Index>(v)) = mesh.vertices[v];
  const ContactBody own{boundary(cells).facets, 1e5};
  ContactBody carried = own;
  carried.carrier =
      std::make_shared<Embedding>(require_element("P1", 3, "element"), cells.nodes, rest, mesh.vertices);
  const ContactSurface a = make_contact_surface(3, {&own, 1}, rest);
  const ContactSurface b = make_contact_surface(3, {&carried, 1}, rest);
  EXPECT_EQ(a.parts.triangles, b.parts.triangles);
  EXPECT_EQ(a.parts.edges, b.parts.edges);
  EXPECT_EQ(a.vertices.nodes, b.vertices.nodes);  // rounding is no weight
  EXPECT_EQ(a.vertices.shares, b.vertices.shares);
  EXPECT_EQ(a.numbers, b.numbers);
  EXPECT_EQ(a.point_areas, b.point_areas);
}

}  // namespace
}  // namespace resilin::testing
