// Steps whose search newton.max_iterations cuts short: what they keep.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "every_integrator.hpp"
#include "resilin/simulation/rigid_fit.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A cube of 0.2 m that is torn about while it flies: strains of the order of one within a few steps.
Description torn_cube(int dimension, const std::string& integrator, double rate) {
  Description scene;
  scene.dimension = dimension;
  scene.is_dynamic = true;
  scene.integrator = integrator;
  scene.solver.kind = "cholesky";  // iterative solvers leave a part of the forces
  BodyDescription body;
  body.element = "P1";
  body.mesh = dimension == 3 ? make_box({0.2, 0.2, 0.2}, {2, 2, 2}) : make_rectangle({0.2, 0.2}, {4, 4});
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e4}, {"poissons_ratio", 0.4}};
  body.velocity = {1, 0.5, dimension == 3 ? 0.2 : 0.0};
  Eigen::Matrix3d gradient{{0.3, -1, 0.4}, {0.8, -0.5, 0.2}, {-0.9, 0.7, 0.6}};
  if (dimension == 2) gradient.row(2) = gradient.col(2).transpose() = Vector3::Zero().transpose();
  body.velocity_gradient = rate * gradient;
  scene.bodies.push_back(body);
  return scene;
}

struct TruncationOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, TruncationOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

struct Lost {
  double linear_momentum = 0, angular_momentum = 0;  ///< at most, relative
  double gain = 0;                                   ///< gain of the total energy, relative
};

Lost lost_by(const Description& scene) {
  Simulation simulation(scene);
  const Frame start = simulation.frame();
  Lost lost;
  const auto change = [](const Vector3& now, const Vector3& before) {
    return (now - before).norm() / before.norm();
  };
  while (!simulation.is_finished()) {
    simulation.step();
    const Frame& frame = simulation.frame();
    lost.linear_momentum =
        std::max(lost.linear_momentum, change(frame.linear_momentum, start.linear_momentum));
    lost.angular_momentum =
        std::max(lost.angular_momentum, change(frame.angular_momentum, start.angular_momentum));
    lost.gain = std::max(lost.gain, frame.total_energy() / start.total_energy() - 1);
  }
  EXPECT_TRUE(simulation.state().positions.allFinite());
  return lost;
}

/// However strongly bodies deform, however long the steps and however early their searches end.
TEST_P(TruncationOfEveryIntegrator, KeepsTheMomentaOfFreeBodies) {
  for (const int dimension : {2, 3})
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent})
      for (const double rate : {10.0, 30.0, 80.0})
        for (const double time_step : {1.0 / 60, 1.0 / 240}) {
          Description scene = torn_cube(dimension, integrator, rate);
          scene.bodies[0].mass = mass;
          scene.time_step = time_step;
          scene.end_time = 20 * time_step;
          const Lost whole = lost_by(scene);
          for (const int max_iterations : {1, 2, 3}) {
            scene.newton.max_iterations = max_iterations;
            SCOPED_TRACE(::testing::Message() << dimension << "D, " << spelling(mass) << ", " << rate
                                              << " 1/s, dt " << time_step << ", " << max_iterations);
            const Lost lost = lost_by(scene);
            EXPECT_LT(lost.linear_momentum, 1e-11);  // rounding
            // For a turn that the step resolves, about what the scheme itself loses, and what is left of the
            // forces; longer steps are often taken by backward Euler, which loses more.
            if (rate * time_step < 0.4) {
              EXPECT_LE(lost.angular_momentum, 1.1 * whole.angular_momentum + 1e-6);
            }
            EXPECT_LE(lost.gain, 1e-3);
          }
        }
}

/// A body that touches nothing flies on, whatever happens to another.
TEST_P(TruncationOfEveryIntegrator, KeepsTheMomentumOfABodyBesideOneThatLands) {
  Description scene = torn_cube(3, integrator, 30);
  scene.bodies[0].name = "flying";
  scene.bodies[0].translate = {0, 0, 2};
  BodyDescription landing = scene.bodies[0];
  landing.name = "landing";
  landing.translate = {1, 0, 0.05};
  landing.velocity = {0, 0, -5};
  landing.velocity_gradient.setZero();
  scene.bodies.push_back(landing);
  ColliderDescription ground;
  ground.name = "ground";
  ground.shape.normal = Vector3::UnitZ();
  scene.colliders.push_back(ground);
  scene.time_step = 1.0 / 120;
  scene.end_time = 0.15;
  scene.newton.max_iterations = 1;
  Simulation simulation(scene);
  const auto momentum = [&] {
    const Body& body = simulation.world().bodies[0];
    VectorX of_nodes;
    simulation.world().mass->multiply(simulation.state().velocities, of_nodes);
    const auto own = of_nodes.segment(3 * body.first_node, 3 * body.num_nodes);
    return Vector3(own.reshaped(3, body.num_nodes).rowwise().sum());
  };
  const Vector3 start = momentum();
  while (!simulation.is_finished()) simulation.step();
  EXPECT_LT((momentum() - start).norm(), 0.01 * start.norm());
}

/// Among all rigid motions no other is nearer, and a shape that was only moved is found again.
TEST(ARigidFit, IsTheNearestPlaceOfAShape) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int dim : {2, 3}) {
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
      Description scene = torn_cube(dim, "backward_euler", 0);
      scene.bodies[0].mass = mass;
      scene.time_step = scene.end_time = 1;
      const World world(scene);
      const auto moved = [&](const VectorX& x, double angle, double shift) {
        const Eigen::Matrix3d R =
            Eigen::AngleAxisd(angle, dim == 2 ? Vector3::UnitZ().eval() : Vector3(1, 2, 2) / 3)
                .toRotationMatrix();
        VectorX y = x;
        for (Index i = 0; i < world.num_nodes(); ++i)
          y.segment(dim * i, dim) =
              R.topLeftCorner(dim, dim) * x.segment(dim * i, dim) + VectorX::Constant(dim, shift);
        return y;
      };
      const auto distance = [&](const VectorX& x, const VectorX& y) {
        VectorX Md;
        world.mass->multiply(x - y, Md);
        return Md.dot(x - y);
      };
      const VectorX& rest = world.rest_positions;
      for (const double angle : {0.3, 1.5, 3.0}) {
        const VectorX target = moved(rest, angle, 7);
        EXPECT_LT((rigidly_fitted(world, world.is_fixed, rest, target, rest) - target).norm(),
                  1e-13 * target.norm());
        VectorX shape = target;
        for (double& x : shape) x += 0.05 * uniform(random);
        const VectorX fitted = rigidly_fitted(world, world.is_fixed, rest, shape, rest);
        for (const double turn : {-1e-3, 0.0, 1e-3})
          for (const double shift : {-1e-4, 1e-4})
            EXPECT_LT(distance(fitted, shape), distance(moved(fitted, turn, shift), shape));
      }
    }
  }
}

/// Where a search found its way from where bodies fly, no other scheme has to take its place.
TEST_P(TruncationOfEveryIntegrator, LeavesStepsNearContactToTheirScheme) {
  int cut_short = 0, replaced = 0;
  for (const double youngs_modulus : {1e4, 1e6}) {
    Description scene = torn_cube(3, integrator, 0);
    scene.bodies[0].material.constants["youngs_modulus"] = youngs_modulus;
    scene.bodies[0].translate = {0, 0, 0.02};
    scene.bodies[0].velocity = {0, 0, -1};
    scene.gravity = {0, 0, -9.81};
    ColliderDescription ground;
    ground.name = "ground";
    ground.shape.normal = Vector3::UnitZ();
    scene.colliders.push_back(ground);
    scene.time_step = 1e-3;
    scene.end_time = 0.1;
    scene.newton.max_iterations = 1;
    Simulation simulation(scene);
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step();
      cut_short += report.status == StepReport::Status::not_converged ? 1 : 0;
      replaced += report.by_backward_euler ? 1 : 0;
    }
  }
  EXPECT_GT(cut_short, 50);
  EXPECT_LT(replaced, cut_short / 2) << cut_short;
}

}  // namespace
}  // namespace resilin::testing
