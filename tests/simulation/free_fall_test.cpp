// Bodies that fall freely keep their shape: gravity and inertia are of one mass.

#include <gtest/gtest.h>

#include "every_integrator.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/world/loads.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

struct FallCase {
  const ElementInfo* element;
  MassKind mass;
  std::string integrator;
};

std::vector<FallCase> all_falls() {
  std::vector<FallCase> cases;
  for (const ElementInfo* element : elements())
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent})
      for (const std::string& integrator : integrator_names()) cases.push_back({element, mass, integrator});
  return cases;
}

std::string name_of_fall(const ::testing::TestParamInfo<FallCase>& info) {
  return std::string(info.param.element->name) + "_" + std::to_string(info.param.element->dim) + "d_" +
         std::string(spelling(info.param.mass)) + "_" + info.param.integrator;
}

/// A body of uneven cells, thrown up, with gravity along the last axis.
Description thrown_body(const FallCase& c) {
  const int dim = c.element->dim;
  Description scene = small_bar(dim, true);
  scene.fixes.clear();
  scene.integrator = c.integrator;
  BodyDescription& body = scene.bodies[0];
  body.element = c.element->name;
  body.mass = c.mass;
  const bool simplices = is_simplex(c.element->shape);
  body.mesh =
      dim == 3
          ? (simplices ? make_box({1, 0.5, 0.5}, {3, 2, 1}) : make_hexahedron_box({1, 0.5, 0.5}, {3, 2, 1}))
          : (simplices ? make_rectangle({1, 0.5}, {3, 2}) : make_quadrilateral_rectangle({1, 0.5}, {3, 2}));
  for (Vector3& x : body.mesh.vertices) x += 0.1 * x.x() * x.x() * Vector3(1, 0.5, dim == 3 ? 0.3 : 0);
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.4}};
  body.velocity = {0.3, 0.2, dim == 3 ? 0.1 : 0};
  return scene;
}

struct EveryFall : ::testing::TestWithParam<FallCase> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryFall, ::testing::ValuesIn(all_falls()), name_of_fall);

/// With consistent masses, whose entries of both signs are no measure of rounding themselves.
TEST_P(EveryFall, WithoutWeightOrThrowIsRestInBalance) {
  if (GetParam().mass != MassKind::consistent) return;
  Description scene = thrown_body(GetParam());
  scene.gravity = {0, 0, 0};
  scene.bodies[0].velocity = {0, 0, 0};
  scene.bodies[0].translate = {0, 1.7, 0};
  Simulation simulation(scene);
  for (int step = 0; step < 10; ++step) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

TEST_P(EveryFall, IsFreeOfStressAndLeavesNoNodeBehind) {
  const Description scene = thrown_body(GetParam());
  const int dim = scene.dimension;
  Simulation simulation(scene);
  const World& world = simulation.world();
  const double pressure = 1000 * 9.81 * 1;  // rho g L [Pa]
  double time = 0;
  for (int step = 0; step < 10; ++step) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    EXPECT_EQ(simulation.frame().newton_iterations, 0) << "a fall needs no search";
    time += scene.time_step;
    const State& state = simulation.state();
    double strain = 0;
    for (const Matrix<3>& F : world.bodies[0].domains.front().energy->deformation_gradients(state.positions))
      strain = std::max(strain, (F - Matrix<3>::Identity()).cwiseAbs().maxCoeff());
    // lambda + 2 mu = 2.1 E here.
    EXPECT_LT(3 * 1e6 * strain, 1e-9 * pressure);
    const double speed = scene.bodies[0].velocity[dim - 1] - 9.81 * time;
    for (Index node = 0; node < world.num_nodes(); ++node)
      EXPECT_NEAR(state.velocities[Eigen::Index{node} * dim + dim - 1], speed, 1e-12);
    // The weight has the momentum that falls.
    EXPECT_NEAR(simulation.frame().linear_momentum[dim - 1], world.bodies[0].mass * speed,
                1e-12 * world.bodies[0].mass);
  }
}

/// The sum of the forces is the weight, in motion and at rest; at rest it is spread by the shape functions.
TEST(Gravity, IsTheWeightHoweverTheMassIsSpread) {
  for (const ElementInfo* element : elements()) {
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
      const World world(thrown_body({element, mass, "backward_euler"}));
      const int dim = world.dimension;
      for (const bool is_in_motion : {false, true}) {
        const auto gravity = make_gravity(world.gravity, {}, world, is_in_motion);
        VectorX gradient = VectorX::Zero(world.rest_positions.size());
        gravity->add_gradient(world.rest_positions, {}, gradient);
        const double weight = 9.81 * world.bodies[0].mass;
        EXPECT_NEAR(gradient(Eigen::seqN(dim - 1, world.num_nodes(), dim)).sum(), weight, 1e-12 * weight)
            << element->name;
        VectorX inertia;
        world.mass->multiply(world.gravity.head(dim).replicate(world.num_nodes(), 1), inertia);
        const bool is_one_mass = (gradient + inertia).norm() < 1e-13 * inertia.norm();
        if (is_in_motion || mass == MassKind::consistent) {
          EXPECT_TRUE(is_one_mass) << element->name;
        }
        if (!is_in_motion && mass == MassKind::lumped && element->degree == 2) {
          EXPECT_FALSE(is_one_mass) << element->name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
