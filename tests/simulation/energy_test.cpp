// No step of any scheme adds energy: drops and throws against colliders, with steps of any length and
// searches cut short.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "every_integrator.hpp"
#include "resilin/simulation/energy_guard.hpp"
#include "resilin/simulation/frame.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A small body somewhere above a floor, beside a ball or both, thrown at them.
Description random_throw(unsigned seed, const std::string& integrator, double time_step, double speed,
                         int max_iterations) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto choose = [&](auto... values) {
    const std::array list{values...};
    return list[std::uniform_int_distribution<std::size_t>(0, list.size() - 1)(random)];
  };
  Description scene;
  scene.is_dynamic = true;
  scene.integrator = integrator;
  scene.time_step = time_step;
  scene.end_time = 60 * time_step;
  scene.gravity = {0, 0, speed == 0 ? -9.81 : choose(0.0, -9.81)};
  scene.newton.max_iterations = max_iterations;
  BodyDescription body;
  const int n = choose(1, 1, 2, 3);
  const bool hexahedra = choose(true, false);
  body.mesh =
      hexahedra ? make_hexahedron_box({0.2, 0.2, 0.2}, {n, n, n}) : make_box({0.2, 0.2, 0.2}, {n, n, n});
  const bool is_quadratic = choose(false, false, true);
  body.element = hexahedra ? "Q1" : is_quadratic ? "P2" : "P1";
  body.mass = choose(MassKind::lumped, MassKind::consistent);
  body.material.law = choose("stable_neo_hookean", "neo_hookean", "corotated", "saint_venant_kirchhoff");
  body.material.constants = {{"youngs_modulus", std::pow(10, 5 + uniform(random))}, {"poissons_ratio", 0.35}};
  body.rotate =
      Rotation{.axis = {uniform(random), uniform(random), uniform(random)}, .degrees = 90 * uniform(random)};
  // The lowest corner is at most 0.35 m below the place of the body's corner.
  const double way = 5 * time_step * speed + 0.5 * 9.81 * std::pow(10 * time_step, 2);
  body.translate = {0, 0, 0.36 + way * (1 + 0.3 * uniform(random))};
  body.velocity = {0.3 * speed * uniform(random), 0, -speed};
  body.velocity_gradient =
      speed * Eigen::Matrix3d{{0, uniform(random), 0}, {uniform(random), 0, 0}, {0, 0, 0}};
  scene.bodies.push_back(body);
  ColliderDescription ground;
  ground.name = "ground";
  ground.shape.normal = {0.2 * uniform(random), 0, 1};
  scene.colliders.push_back(ground);
  if (choose(true, false)) {
    ColliderDescription ball;
    ball.name = "ball";
    ball.kind = "sphere";
    ball.shape.center = {0.1, 0.1, -0.3};
    ball.shape.radius = 0.35;
    scene.colliders.push_back(ball);
  }
  return scene;
}

struct Throw {
  double gain = 0;     ///< the largest total energy less that of the start [J]
  double kinetic = 0;  ///< the largest kinetic energy [J]
  bool touched = false;
};

Throw result_of(const Description& scene) {
  Simulation simulation(scene);
  const double start = simulation.frame().total_energy();
  Throw result{.kinetic = simulation.frame().kinetic_energy};
  while (!simulation.is_finished()) {
    simulation.step();
    const Frame& frame = simulation.frame();
    const double gain = frame.total_energy() - start;
    if (!(gain <= result.gain)) result.gain = gain;  // NaN, too
    result.kinetic = std::max(result.kinetic, frame.kinetic_energy);
    result.touched |= frame.contact_energy > 0;
  }
  return result;
}

struct EnergyOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EnergyOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// Steps of any length with every speed and every limit of iterations.
TEST_P(EnergyOfEveryIntegrator, DoesNotGrowInDropsAndThrows) {
  unsigned seed = 0;
  int num_throws = 0, num_touched = 0;
  std::mt19937 random(20);
  std::uniform_real_distribution<double> log_step(std::log(1e-4), std::log(1.0 / 30));
  for (const double speed : {0.0, 1.0, 10.0, 100.0}) {
    for (const int max_iterations : {1, 2, 5, 100}) {
      for (int repeat = 0; repeat < 2; ++repeat) {
        const double time_step = std::exp(log_step(random));
        const Throw thrown = result_of(random_throw(++seed, integrator, time_step, speed, max_iterations));
        EXPECT_LE(thrown.gain, 1e-3 * thrown.kinetic)
            << "seed " << seed << ", dt " << time_step << " s, " << speed << " m/s, at most "
            << max_iterations << " iterations: " << thrown.kinetic << " J";
        ++num_throws;
        num_touched += thrown.touched ? 1 : 0;
      }
    }
  }
  EXPECT_GE(num_touched, num_throws / 2);
}

/// A soft cube that falls on a plane, as it blew up with every scheme of second order.
TEST_P(EnergyOfEveryIntegrator, DoesNotGrowWhereAJellyFalls) {
  for (const double time_step : {1.0 / 120, 1.0 / 500}) {
    for (const double speed : {0.0, 100.0}) {
      Description scene;
      scene.is_dynamic = true;
      scene.integrator = integrator;
      scene.time_step = time_step;
      scene.end_time = 60 * time_step;
      scene.gravity = {0, 0, -9.81};
      BodyDescription body;
      body.element = "P1";
      body.mesh = make_box({0.2, 0.2, 0.2}, {3, 3, 3}, {0, 0, speed == 0 ? 0.02 : 0.3});
      body.material.law = "stable_neo_hookean";
      body.material.constants = {{"youngs_modulus", 1e4}, {"poissons_ratio", 0.45}};
      body.velocity = {0, 0, -speed};
      scene.bodies.push_back(body);
      scene.colliders.emplace_back();
      scene.colliders[0].name = "ground";
      scene.colliders[0].shape.normal = Vector3::UnitZ();
      const Throw thrown = result_of(scene);
      EXPECT_TRUE(thrown.touched);
      EXPECT_LE(thrown.gain, 1e-3 * thrown.kinetic) << "dt " << time_step << " s, " << speed << " m/s";
    }
  }
}

/// A body without contact keeps its momentum, however early its searches end, and no step of it is changed.
TEST_P(EnergyOfEveryIntegrator, LeavesFreeFlightAlone) {
  for (const int max_iterations : {1, 2, 5, 100}) {
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
      Description scene = small_bar(3, true);
      scene.fixes.clear();
      scene.gravity.setZero();
      scene.integrator = integrator;
      scene.time_step = 1e-3;
      scene.end_time = 0.03;
      scene.newton.max_iterations = max_iterations;
      scene.solver.kind = "cholesky";  // iterative solvers leave a part of 1e-9 of the forces
      scene.bodies[0].mass = mass;
      scene.bodies[0].velocity = {100, -30, 10};
      scene.bodies[0].velocity_gradient << 0.5, -3, 0, 3, 0, 1, 0, -1, 0;
      Simulation simulation(scene);
      const Vector3 momentum = simulation.frame().linear_momentum;
      while (!simulation.is_finished()) {
        const StepReport report = simulation.step();
        if (max_iterations == 100) {
          ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
        }
        EXPECT_FALSE(report.by_backward_euler);
        EXPECT_EQ(report.removed_energy, 0);
        EXPECT_LT((simulation.frame().linear_momentum - momentum).norm(), 1e-12 * momentum.norm());
      }
    }
  }
}

/// Takes the energy that it is asked for out of what a body does besides moving as a rigid one.
TEST(SlowingDown, KeepsTheMomentaOfFreeBodies) {
  for (const int dim : {2, 3}) {
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
      Description scene = small_bar(dim, true);
      scene.fixes.clear();
      scene.bodies[0].mass = mass;
      const World world(scene);
      State state;
      state.positions = world.rest_positions;
      state.velocities.resize(state.positions.size());
      std::mt19937 random(1);
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (double& v : state.velocities) v = 2 + uniform(random);
      const Frame before = measure_frame(world, state, nullptr);
      const double excess = 0.01 * before.kinetic_energy;
      ASSERT_TRUE(slow_down(world, state.positions, excess, true, state.velocities));
      const Frame after = measure_frame(world, state, nullptr);
      EXPECT_NEAR(before.kinetic_energy - after.kinetic_energy, excess, 1e-12 * before.kinetic_energy);
      EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(),
                1e-12 * before.linear_momentum.norm());
      EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(),
                1e-12 * before.angular_momentum.norm());
      // There is no more than that to take.
      const VectorX velocities = state.velocities;
      EXPECT_FALSE(slow_down(world, state.positions, after.kinetic_energy, true, state.velocities));
      EXPECT_EQ(state.velocities, velocities);
      EXPECT_TRUE(slow_down(world, state.positions, 0.999 * after.kinetic_energy, false, state.velocities));
      EXPECT_LT(measure_frame(world, state, nullptr).kinetic_energy, 0.0011 * after.kinetic_energy);
    }
  }
}

}  // namespace
}  // namespace resilin::testing
