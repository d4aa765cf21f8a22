// No step of any scheme adds energy: drops and throws against colliders, with steps of any length and
// searches cut short.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "every_integrator.hpp"
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
  body.material.constants = {{"youngs_modulus", std::pow(10, 5 + uniform(random))},
                             {"poissons_ratio", 0.35}};
  body.rotate = Rotation{.axis = {uniform(random), uniform(random), uniform(random)},
                         .degrees = 90 * uniform(random)};
  // The lowest corner is at most 0.35 m below the place of the body's corner.
  const double way = 5 * time_step * speed + 0.5 * 9.81 * std::pow(10 * time_step, 2);
  body.translate = {0, 0, 0.36 + way * (1 + 0.3 * uniform(random))};
  body.velocity = {0.3 * speed * uniform(random), 0, -speed};
  body.velocity_gradient = speed * Eigen::Matrix3d{{0, uniform(random), 0}, {uniform(random), 0, 0}, {0, 0, 0}};
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
  double gain = 0;              ///< the largest total energy less that of the start [J]
  double rise = 0;              ///< the same above the least so far
  double kinetic = 0;           ///< the largest kinetic energy
  double contact = 0;           ///< the largest energy of contact
  int num_guarded = 0;
  bool converged = true;
};

Throw result_of(const Description& scene) {
  Simulation simulation(scene);
  const double start = simulation.frame().total_energy();
  double least = start;
  Throw result{.kinetic = simulation.frame().kinetic_energy};
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    const Frame& frame = simulation.frame();
    if (!std::isfinite(frame.total_energy())) return {.gain = frame.total_energy()};
    result.converged &= report.status == StepReport::Status::converged;
    result.num_guarded += report.by_backward_euler || report.removed_energy > 0 ? 1 : 0;
    least = std::min(least, frame.total_energy());
    result.gain = std::max(result.gain, frame.total_energy() - start);
    result.rise = std::max(result.rise, frame.total_energy() - least);
    result.kinetic = std::max(result.kinetic, frame.kinetic_energy);
    result.contact = std::max(result.contact, frame.contact_energy);
  }
  return result;
}

struct EnergyOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EnergyOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// 48 throws of each scheme: every length of step with every speed and every limit of iterations.
TEST_P(EnergyOfEveryIntegrator, DoesNotGrowInDropsAndThrows) {
  unsigned seed = 0;
  int num_touched = 0;
  for (const double time_step : {1e-4, 1.0 / 500, 1.0 / 120, 1.0 / 30}) {
    for (const double speed : {0.0, 3.0, 100.0}) {
      for (const int max_iterations : {1, 2, 5, 100}) {
        const Throw thrown =
            result_of(random_throw(++seed, integrator, time_step, speed, max_iterations));
        // The guard allows half of it, and the least energy so far in place of the start's.
        EXPECT_LE(thrown.rise, 1e-3 * thrown.kinetic)
            << integrator << " seed " << seed << ", dt " << time_step << " s, " << speed << " m/s, at most "
            << max_iterations << " iterations: gain " << thrown.gain << " J of " << thrown.kinetic << " J";
        num_touched += thrown.contact > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GE(num_touched, 30) << "of 48 throws";
}

}  // namespace
}  // namespace resilin::testing
