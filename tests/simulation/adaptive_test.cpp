// Steps that adapt, with contact, after loads and where searches are cut short: as many as accuracy asks for,
// no more.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// A cube of 0.2 m that falls on a plane or on a ball, turned a little, until 0.1 s after it could be there.
Description random_drop(unsigned seed, const std::string& integrator, double tolerance) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double height = 0.01 + 0.1 * uniform(random);
  Description scene;
  scene.is_dynamic = true;
  scene.integrator = integrator;
  scene.gravity = {0, 0, -9.81};
  scene.time_step = 1e-3;
  scene.end_time = std::sqrt(2 * height / 9.81) + 0.1;
  scene.adaptive.emplace().tolerance = tolerance;
  BodyDescription body;
  body.element = "P1";
  body.mesh = make_box({0.2, 0.2, 0.2}, {2, 2, 2}, {0, 0, height});
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", std::pow(10, 4 + 3 * uniform(random))},
                             {"poissons_ratio", 0.4}};
  body.rotate = Rotation{.axis = Vector3::UnitX(), .degrees = 2 * uniform(random)};
  scene.bodies.push_back(body);
  ColliderDescription collider;
  collider.name = "ground";
  collider.shape.normal = Vector3::UnitZ();
  if (seed % 2 == 0) {
    collider.kind = "sphere";
    collider.shape.center = {0.1, 0.1, -0.15};
    collider.shape.radius = 0.15;
  }
  scene.colliders.push_back(collider);
  return scene;
}

/// Bound of the cost of a tolerance: far more than it does, far less than steps that creep.
int most_steps(double tolerance) { return static_cast<int>(20 / std::sqrt(tolerance)); }

struct AdaptiveRun {
  int steps = 0, cut_short = 0;
  double gain = 0, kinetic = 0;  ///< gain and kinetic of the total energy; the largest kinetic energy [J]
  bool touched = false;
  std::string reason;
  VectorX positions;
};

AdaptiveRun run_adaptive(const Description& scene, int most) {
  Simulation simulation(scene);
  const double start = simulation.frame().total_energy();
  AdaptiveRun run;
  while (!simulation.is_finished() && run.steps < most) {
    const StepReport report = simulation.step();
    ++run.steps;
    run.cut_short += report.status == StepReport::Status::converged ? 0 : 1;
    if (!report.reason.empty()) run.reason = report.reason;
    const Frame& frame = simulation.frame();
    run.touched |= frame.contact_energy > 0;
    run.kinetic = std::max(run.kinetic, frame.kinetic_energy);
    const double gain = frame.total_energy() - start;
    if (!(gain <= run.gain)) run.gain = gain;  // NaN, too
    if (scene.adaptive) {
      EXPECT_LE(report.time_error, scene.adaptive->tolerance * simulation.world().largest_extent());
    }
  }
  EXPECT_TRUE(simulation.is_finished()) << "at " << simulation.state().time << " s of " << scene.end_time;
  run.positions = simulation.state().positions;
  return run;
}

struct AdaptiveContactOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, AdaptiveContactOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(AdaptiveContactOfEveryIntegrator, TakesAsManyStepsAsItsToleranceAsksFor) {
  unsigned seed = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    for (int repeat = 0; repeat < 4; ++repeat) {
      const Description scene = random_drop(++seed, integrator, tolerance);
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", tolerance " << tolerance);
      const AdaptiveRun run = run_adaptive(scene, most_steps(tolerance));
      EXPECT_EQ(run.cut_short, 0) << run.reason;
      EXPECT_TRUE(run.touched);
      EXPECT_LE(run.gain, 1e-3 * run.kinetic);
      expect_same_bits_after_a_checkpoint(scene, run.steps / 2);
      // The errors of all steps add up, and one at contact goes on as a velocity: a few times their sum.
      Description fine = scene;
      fine.adaptive.reset();
      fine.time_step = scene.end_time / (10 * run.steps);
      const VectorX way = run_adaptive(fine, 11 * run.steps).positions - run.positions;
      double distance = 0;
      for (Eigen::Index i = 0; i < way.size(); i += 3)
        distance = std::max(distance, way.segment<3>(i).norm());
      EXPECT_LE(distance, 5 * run.steps * tolerance * 0.2);
    }
  }
}

/// A bar that vibrates after a load has risen.
Description ramped_bar(const std::string& integrator, double youngs_modulus, double tolerance) {
  Description scene = small_bar(3, true);
  scene.integrator = integrator;
  scene.time_step = 1e-3;
  scene.end_time = 0.3;
  scene.gravity.setZero();
  scene.bodies[0].material.constants = {{"youngs_modulus", youngs_modulus}, {"poissons_ratio", 0.3}};
  LoadDescription load;
  load.value = {0, 0, 0.1 * youngs_modulus};
  load.time_function.form = TimeFunction::Ramp{.from = 0.1, .until = 0.11};
  scene.loads.push_back(load);
  scene.adaptive.emplace().tolerance = tolerance;
  return scene;
}

/// Stiff vibrations that no step resolves count by what they move, whether the scheme damps them or not.
TEST_P(AdaptiveContactOfEveryIntegrator, IsNotSlowedDownByWhatALoadHasLeftVibrating) {
  for (const double youngs_modulus : {1e5, 1e6, 1e7})
    for (const double tolerance : {1e-3, 1e-4}) {
      SCOPED_TRACE(::testing::Message() << youngs_modulus << " Pa, tolerance " << tolerance);
      const AdaptiveRun run =
          run_adaptive(ramped_bar(integrator, youngs_modulus, tolerance), most_steps(tolerance));
      EXPECT_EQ(run.cut_short, 0) << run.reason;
    }
}

/// A shorter step is no cure for a search that is cut short on purpose; the report says that it was.
TEST_P(AdaptiveContactOfEveryIntegrator, TakesNoMoreStepsWhereSearchesAreCutShort) {
  for (const double tolerance : {1e-2, 1e-3}) {
    for (const int scene_number : {0, 1, 2}) {
      Description scene = scene_number == 0 ? ramped_bar(integrator, 1e6, tolerance)
                                            : random_drop(20 + scene_number, integrator, tolerance);
      const int whole = run_adaptive(scene, most_steps(tolerance)).steps;
      for (const int max_iterations : {1, 2, 3}) {
        scene.newton.max_iterations = max_iterations;
        SCOPED_TRACE(::testing::Message()
                     << "scene " << scene_number << ", " << max_iterations << " iterations");
        const AdaptiveRun run = run_adaptive(scene, most_steps(tolerance));
        EXPECT_LE(run.steps, 2 * whole + 10);  // a motion that is cut short is less smooth
        if (scene_number > 0) {                // a load does work on the other
          EXPECT_LE(run.gain, 1e-3 * run.kinetic);
        }
        if (max_iterations == 1) {
          EXPECT_GT(run.cut_short, 0);
          EXPECT_THAT(run.reason, HasSubstr("limit of Newton iterations"));
        }
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
