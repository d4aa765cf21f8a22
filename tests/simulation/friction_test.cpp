// Friction between bodies and colliders, in motion and at rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "every_integrator.hpp"
#include "resilin/world/friction.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double g = 9.81;                  // [m/s^2]
const double slope_angle = std::atan(0.5);  // where a coefficient of 0.5 is critical

/// A stiff block of 0.2 m that starts half an activation distance above the ground. Gravity is that of a
/// slope which the ground is part of.
Description block(int dimension, double angle, double friction) {
  Description scene;
  scene.dimension = dimension;
  scene.is_dynamic = true;
  const int up = dimension - 1;
  scene.gravity = g * (std::sin(angle) * Vector3::UnitX() - std::cos(angle) * Vector3::Unit(up));
  BodyDescription body;
  body.element = "P1";
  body.mesh = dimension == 3 ? make_box({0.2, 0.2, 0.2}, {2, 2, 2}) : make_rectangle({0.2, 0.2}, {2, 2});
  body.material.constants = {{"youngs_modulus", 1e7}, {"poissons_ratio", 0.3}};
  body.translate = 0.5e-3 * Vector3::Unit(up);
  scene.bodies.push_back(body);
  ColliderDescription ground;
  ground.name = "ground";
  ground.shape.normal = Vector3::Unit(up);
  ground.friction = friction;
  scene.colliders.push_back(ground);
  return scene;
}

/// Lets it start where it rests, held by friction however small that is afterwards.
void start_at_rest(Description& scene) {
  Description rest = scene;
  rest.is_dynamic = false;
  rest.colliders[0].friction = 1;
  const Simulation simulation = converged_end_of(rest);
  const VectorX& x = simulation.state().positions;
  scene.bodies[0].initial_positions.assign(x.begin(), x.end());
}

Vector3 mean_velocity(const Simulation& simulation) {
  return simulation.frame().linear_momentum / simulation.world().bodies[0].mass;
}

void step_until(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    ASSERT_EQ(report.friction.unsettled_stages, 0) << report.friction.mismatch;
  }
}

double mean_acceleration(Simulation& simulation, double begin, double end) {
  step_until(simulation, begin);
  const Vector3 before = mean_velocity(simulation);
  step_until(simulation, end);
  return (mean_velocity(simulation) - before).x() / (end - begin);
}

double sliding_acceleration(double friction) {
  return g * (std::sin(slope_angle) - friction * std::cos(slope_angle));
}

TEST(ABlockOnASlope, SlidesAsCoulombSaysOnceTheSlopeIsSteeper) {
  for (const int dimension : {2, 3})
    for (const double friction : {0.3, 0.49}) {
      Description scene = block(dimension, slope_angle, friction);
      start_at_rest(scene);
      Simulation simulation(scene);
      const double expected = sliding_acceleration(friction);
      // Its vibrations at the start have died down by backward Euler.
      EXPECT_NEAR(mean_acceleration(simulation, 0.5, 1), expected, 1e-5 * expected) << dimension;
    }
}

/// tan(angle) = mu f1(v / eps_v): v = eps_v (1 - sqrt(1 - tan(angle) / mu))
TEST(ABlockOnASlope, CreepsBySoMuchAsFrictionNeedsWhereItSticks) {
  for (const int dimension : {2, 3})
    for (const double friction : {0.51, 0.6}) {
      Description scene = block(dimension, slope_angle, friction);
      start_at_rest(scene);
      Simulation simulation(scene);
      step_until(simulation, 1);
      const double speed = default_friction_speed(simulation.world());
      EXPECT_NEAR(speed, 2e-4, 1e-18);  // m/s
      const double expected = speed * (1 - std::sqrt(1 - 0.5 / friction));
      EXPECT_NEAR(mean_velocity(simulation).x(), expected, 1e-4 * expected) << dimension << " " << friction;
    }
}

TEST(ABlockOnASlope, SlidesStraightDownWhateverTheDirection) {
  Description scene = block(3, slope_angle, 0.3);
  const Vector3 down = Vector3(1, -2, 0).normalized();
  scene.gravity = g * (std::sin(slope_angle) * down - std::cos(slope_angle) * Vector3::UnitZ());
  start_at_rest(scene);
  Simulation simulation(scene);
  step_until(simulation, 0.5);
  const Vector3 v = mean_velocity(simulation);
  EXPECT_NEAR(v.dot(down), 0.5 * sliding_acceleration(0.3), 1e-3 * v.norm());
  EXPECT_LT(v.cross(down).norm(), 1e-3 * v.norm());  // the mesh has no symmetry about this direction
}

struct EveryIntegratorOnASlope : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryIntegratorOnASlope, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(EveryIntegratorOnASlope, SlidesOrSticks) {
  for (const double friction : {0.3, 0.49, 0.51, 0.6}) {
    Description scene = block(2, slope_angle, friction);
    scene.integrator = integrator;
    start_at_rest(scene);
    Simulation simulation(scene);
    const double x = simulation.state().positions[0];
    const double expected = std::max(0.0, sliding_acceleration(friction));
    const double acceleration = mean_acceleration(simulation, 0.5, 1);
    if (friction < 0.5) {
      EXPECT_NEAR(acceleration, expected, 0.01 * expected) << friction;
    } else {
      EXPECT_LT(std::abs(simulation.state().positions[0] - x), 1e-3) << friction;
    }
  }
}

TEST_P(EveryIntegratorOnASlope, GainsNoEnergyByFriction) {
  Description scene = small_bar(2, true);
  scene.integrator = integrator;
  scene.fixes.clear();
  scene.bodies[0].rotate = Rotation{.degrees = 10};
  scene.bodies[0].translate = {0, 0.02, 0};
  scene.bodies[0].velocity = {2, 0, 0};
  ColliderDescription ground;
  ground.shape.normal = Vector3::UnitY();
  ground.friction = 0.4;
  scene.colliders.push_back(ground);
  scene.end_time = 0.4;
  Simulation simulation(scene);
  const double start = simulation.frame().total_energy(), kinetic = simulation.frame().kinetic_energy;
  double last = start;
  while (!simulation.is_finished()) {
    simulation.step();
    const Frame& frame = simulation.frame();
    // The guard lets others rise by a small part of the kinetic energy; what rubs off is lost.
    EXPECT_LE(frame.total_energy(), start + 1e-3 * kinetic);
    if (integrator != "backward_euler") continue;
    const double with_heat = frame.total_energy() + frame.friction_work;
    EXPECT_LE(with_heat, last + 1e-6 * std::abs(kinetic));
    last = with_heat;
  }
  EXPECT_GT(simulation.frame().friction_work, 0.05 * kinetic);
  EXPECT_EQ(simulation.frame().friction_work, simulation.frame().dissipated_energy);
}

/// Rigid: v0 / (mu g) and v0^2 / (2 mu g).
TEST(ABlockThatSlides, StopsWhereCoulombSays) {
  for (const auto& [v0, friction] : {std::array{2.0, 0.3}, std::array{1.0, 0.5}}) {
    Description scene = block(2, 0, friction);
    start_at_rest(scene);
    scene.bodies[0].velocity = {v0, 0, 0};
    scene.time_step = 2e-3;
    const double time = v0 / (friction * g), distance = 0.5 * v0 * time;
    Simulation simulation(scene);
    const double energy = simulation.frame().kinetic_energy, x = simulation.state().positions.mean();
    step_until(simulation, 0.98 * time);
    EXPECT_GT(mean_velocity(simulation).x(), 0.015 * v0);
    step_until(simulation, 1.02 * time);
    EXPECT_LT(mean_velocity(simulation).x(), 0.001 * v0);
    // Means over both components.
    EXPECT_NEAR(2 * (simulation.state().positions.mean() - x), distance, 0.02 * distance);
    EXPECT_NEAR(simulation.frame().friction_work, energy, 0.02 * energy);
  }
}

/// Normal forces of a step's start alone would let the block slide through the step in which it lands: by
/// dt g sin(angle) faster, ever after.
TEST(ABlockThatLands, FeelsFrictionAtOnce) {
  Description scene = block(3, slope_angle, 0.5);
  scene.bodies[0].material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.4}};
  scene.bodies[0].translate.z() = 0.999e-3;
  const double lost = scene.time_step * g * std::sin(slope_angle);
  World world(scene);
  Simulation settled(world);
  step_until(settled, 1);
  // The rest is the fall through the activation distance, and a rebound.
  EXPECT_LT(mean_velocity(settled).x(), 0.4 * lost);
  world.friction_iterations = 0;
  Simulation lagged(world);
  const StepReport first = lagged.step();
  EXPECT_EQ(first.status, StepReport::Status::not_converged);
  EXPECT_NE(first.reason.find("friction did not converge"), std::string::npos) << first.reason;
  EXPECT_NEAR(first.friction.mismatch, 0.5, 0.05);  // the whole of friction, beside the weight's normal part
  while (!lagged.is_finished()) lagged.step();
  EXPECT_NEAR(mean_velocity(lagged).x(), lost, 0.05 * lost);
  EXPECT_GT(lagged.state().unsettled_steps, 0);
}

TEST(ABlockOnABelt, IsTakenAlongAndLeftBehind) {
  Description scene = block(2, 0, 0.3);
  start_at_rest(scene);
  scene.colliders[0].velocity = {0.5, 0, 0};
  scene.colliders[0].until = 0.6;
  Simulation simulation(scene);
  const double weight = g * simulation.world().bodies[0].mass;
  step_until(simulation, 0.1);
  EXPECT_NEAR(mean_velocity(simulation).x(), 0.1 * 0.3 * g, 1e-3 * 0.3 * g);
  EXPECT_NEAR(simulation.frame().reactions[0].second.x(), 0.3 * weight, 1e-3 * weight);
  step_until(simulation, 0.6);
  EXPECT_NEAR(mean_velocity(simulation).x(), 0.5, 1e-5);
  step_until(simulation, 0.7);
  EXPECT_NEAR(mean_velocity(simulation).x(), 0.5 - 0.1 * 0.3 * g, 1e-3 * 0.3 * g);
  step_until(simulation, 1);
  EXPECT_LT(std::abs(mean_velocity(simulation).x()), 1e-5);
  EXPECT_EQ(simulation.state().guarded_steps, 0);
}

/// The reaction is what changes the momentum, in each step of backward Euler.
TEST(TheReactionOfACollider, IncludesFriction) {
  Description scene = block(3, slope_angle, 0.3);
  Simulation simulation(scene);
  Vector3 momentum = Vector3::Zero();
  const double weight = g * simulation.world().bodies[0].mass;
  for (int i = 0; i < 20; ++i) {
    simulation.step();
    const Frame& frame = simulation.frame();
    const Vector3 change = (frame.linear_momentum - momentum) / scene.time_step;
    const Vector3 forces = frame.reactions[0].second + scene.gravity / g * weight;
    EXPECT_LT((change - forces).norm(), 1e-6 * weight) << "step " << i;
    momentum = frame.linear_momentum;
  }
  EXPECT_LT(simulation.frame().reactions[0].second.x(), -0.2 * weight);
}

/// Pulled by a spring once its weight is on the ground, it sticks up to mu N and then follows the spring.
TEST(AStaticBlock, SticksBelowAndSlipsAboveTheLimit) {
  std::vector<double> ends;
  for (const int load_steps : {5, 20}) {
    Description scene = block(2, 0, 0.4);
    scene.is_dynamic = false;
    scene.load_steps = load_steps;
    ColliderDescription press = scene.colliders[0];
    press.name = "lid";
    press.shape.point = {0, 0.2015, 0};
    press.shape.normal = {0, -1, 0};
    press.friction = 0;
    press.velocity = {0, -1e-3, 0};
    press.until = 0.5;
    scene.colliders.push_back(press);
    LoadDescription spring;
    spring.kind = "spring";
    spring.name = "spring";
    spring.where.kind = Where::Kind::plane;
    spring.stiffness = 2e5;
    spring.displacement = {10e-3, 0, 0};
    spring.time_function.form = TimeFunction::Ramp{.from = 0.5, .until = 1};
    scene.loads.push_back(spring);
    Simulation simulation(scene);
    double stuck = 0;
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step();
      ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
      ASSERT_EQ(report.friction.unsettled_stages, 0);
      const Vector3 force = simulation.frame().reactions[0].second;
      EXPECT_LE(std::abs(force.x()), 0.4 * force.y() * (1 + 1e-9));
      if (simulation.state().load <= 0.6 + 1e-9) stuck = simulation.state().positions[0];
    }
    const Vector3 force = simulation.frame().reactions[0].second;
    EXPECT_NEAR(-force.x(), 0.4 * force.y(), 1e-6 * force.y());
    EXPECT_LT(std::abs(stuck), 1e-3);
    EXPECT_GT(simulation.state().positions[0], 2e-3);
    EXPECT_GT(simulation.frame().friction_work, 0);
    ends.push_back(simulation.state().positions[0]);
  }
  EXPECT_NEAR(ends[0], ends[1], 1e-3 * ends[1]);
}

/// The block on a slab that is held from below.
Description block_on_slab(int dimension, double friction) {
  Description scene = block(dimension, slope_angle, 0);
  scene.colliders.clear();
  BodyDescription slab = scene.bodies[0];
  slab.name = "slab";
  slab.mesh = dimension == 3 ? make_box({0.5, 0.3, 0.1}, {5, 3, 1}) : make_rectangle({0.5, 0.1}, {5, 1});
  slab.translate = dimension == 3 ? Vector3(-0.03, -0.06, -0.1) : Vector3(-0.03, -0.1, 0);
  scene.bodies[0].name = "block";
  scene.bodies.push_back(slab);
  FixDescription foot;
  foot.name = "foot";
  foot.body = "slab";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = dimension - 1;
  foot.where.at = -0.1;
  scene.fixes.push_back(foot);
  scene.contact.friction = friction;
  scene.end_time = 0.4;
  return scene;
}

TEST(ABlockOnABody, SlidesOrSticksAsOnACollider) {
  for (const int dimension : {2, 3})
    for (const double friction : {0.3, 0.6}) {
      Simulation simulation(block_on_slab(dimension, friction));
      const Body& upper = simulation.world().bodies[0];
      const auto velocity = [&] {
        VectorX momentum;
        simulation.world().mass->multiply(simulation.state().velocities, momentum);
        return momentum.head(Eigen::Index{upper.num_nodes} * dimension)(Eigen::seq(0, Eigen::last, dimension))
                   .sum() /
               upper.mass;
      };
      step_until(simulation, 0.2);
      const double before = velocity();
      step_until(simulation, 0.4);
      ASSERT_EQ(simulation.frame().contacts.size(), 1U);
      const Vector3 force = simulation.frame().contacts[0].force;  // on the slab
      EXPECT_NEAR(-force.x() / force[dimension - 1], std::min(friction, 0.5), 1e-3);
      const double expected = std::max(0.0, sliding_acceleration(friction));
      EXPECT_NEAR((velocity() - before) / 0.2, expected, 0.01 * sliding_acceleration(0.3))
          << dimension << " " << friction;
      if (friction == 0.6) {
        EXPECT_NEAR(velocity(), 2e-4 * (1 - std::sqrt(1 - 0.5 / friction)), 2e-6);
      }
    }
}

TEST(Friction, HoldsAStaticBodySideways) {
  Description scene = block(3, 0, 0);
  scene.is_dynamic = false;
  EXPECT_NE(refusal_of(scene).find("3 of 6 rigid-body motions are free"), std::string::npos);
  scene.colliders[0].friction = 0.1;
  EXPECT_EQ(refusal_of(scene), "");
  scene.gravity = g * Vector3(0.2, 0, -1);  // slips
  Simulation simulation(scene);
  EXPECT_EQ(simulation.step().status, StepReport::Status::not_converged);
}

TEST(Friction, MovesInTheSameBitsForAnyNumberOfThreadsAndAfterARestart) {
  Description scene = block(3, slope_angle, 0.4);
  scene.end_time = 0.2;
  expect_same_bits_for_any_number_of_threads(scene);
  expect_same_bits_after_a_checkpoint(scene, 7);
}

TEST(Friction, IsRefusedWhereItIsNoCoefficientOrThereIsNoWayToFollow) {
  for (const double wrong : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_NE(refusal_of(block(2, 0, wrong)).find("collider.friction: expected a finite number >= 0, got"),
              std::string::npos)
        << wrong;
  const auto num_warned = [](const World& world) {
    return std::ranges::count_if(world.warnings, [](const std::string& line) {
      return line.find("collider.friction: a coefficient of 12") != std::string::npos;
    });
  };
  EXPECT_EQ(num_warned(World(block(2, 0, 1))), 0);
  EXPECT_EQ(num_warned(World(block(2, 0, 12))), 1);
  Description path = block(2, 0, 0.3);
  path.is_dynamic = false;
  path.load_control = LoadControlKind::arc_length;
  EXPECT_NE(refusal_of(path).find("expected \"load\" where there is friction"), std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
