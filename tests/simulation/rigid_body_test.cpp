// Rigid bodies against Euler's equations, closed forms and themselves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "every_integrator.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A rigid box about the origin, without gravity.
Description rigid_box(const Vector3& size, double density, int dimension = 3) {
  Description scene;
  scene.dimension = dimension;
  scene.is_dynamic = true;
  BodyDescription body;
  body.name = "box";
  body.mesh = dimension == 3 ? make_box(size, {2, 2, 2}) : make_rectangle({size.x(), size.y()}, {2, 2});
  body.mesh_name = "box";
  for (Vector3& X : body.mesh.vertices) X.head(dimension) -= 0.5 * size.head(dimension);
  body.rigid = RigidDescription{.density = density};
  scene.bodies.push_back(std::move(body));
  return scene;
}

Eigen::Matrix3d cross_of(const Vector3& w) {
  Eigen::Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

/// F of the first body.
Eigen::Matrix3d gradient_of(const Simulation& simulation) {
  const World& world = simulation.world();
  const int dim = world.dimension;
  const auto edges = [&](const VectorX& x) {
    Eigen::Matrix3d E = Eigen::Matrix3d::Identity();
    for (int k = 0; k < dim; ++k) E.col(k).head(dim) = x.segment((k + 1) * dim, dim) - x.head(dim);
    return E;
  };
  return edges(simulation.state().positions) * edges(world.rest_positions).inverse();
}

double stretch_of(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F);
  return (svd.singularValues() - Vector3::Ones()).cwiseAbs().maxCoeff();
}

Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

/// Euler's equations of a free body by Runge and Kutta's method.
Eigen::Matrix3d turned_by_euler(const Vector3& inertia, Vector3 w, double time) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const int steps = static_cast<int>(std::ceil(time / 2e-5));
  const double h = time / steps;
  const auto slope = [&](const Vector3& rate) {
    return Vector3((inertia.cwiseProduct(rate)).cross(rate).cwiseQuotient(inertia));
  };
  for (int i = 0; i < steps; ++i) {
    const Vector3 k1 = slope(w), w2 = w + h / 2 * k1, k2 = slope(w2), w3 = w + h / 2 * k2, k3 = slope(w3),
                  w4 = w + h * k3, k4 = slope(w4);
    const Eigen::Matrix3d r1 = R * cross_of(w), r2 = (R + h / 2 * r1) * cross_of(w2),
                          r3 = (R + h / 2 * r2) * cross_of(w3), r4 = (R + h * r3) * cross_of(w4);
    w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    R += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
  }
  return R;
}

TEST(ARigidBody, HasTheMassAndTheInertiaOfItsShape) {
  for (const int dim : {2, 3}) {
    Description scene = rigid_box({0.3, 0.2, 0.1}, 1000, dim);
    scene.bodies[0].rotate = Rotation{.axis = {0, 0, 1}, .degrees = 30};
    scene.bodies[0].translate = {1, 2, 0};
    const World world(scene);
    const RigidShape& shape = *world.bodies[0].rigid;
    const double mass = dim == 3 ? 6 : 60;
    EXPECT_TRUE(shape.is_lumped());
    EXPECT_NEAR(world.bodies[0].mass, mass, 1e-12 * mass);
    EXPECT_NEAR(world.mass->total(), mass, 1e-12 * mass);
    Vector3 first = Vector3::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    const Vector3 centre(1, 2, 0);
    for (Index a = 0; a <= dim; ++a) {
      const Vector3 X = shape.control_nodes[static_cast<std::size_t>(a)];
      first += world.mass->nodal[a] * X;
      second += world.mass->nodal[a] * (X - centre) * (X - centre).transpose();
    }
    EXPECT_LT((first - mass * centre).norm(), 1e-12 * mass);
    const double c = std::cos(std::numbers::pi / 6), s = 0.5;
    Eigen::Matrix3d R;
    R << c, -s, 0, s, c, 0, 0, 0, 1;
    const Eigen::Matrix3d expected =
        mass / 12 * R * Vector3(0.09, 0.04, dim == 3 ? 0.01 : 0).asDiagonal() * R.transpose();
    EXPECT_LT((second - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(AFreeTop, FlipsAsEulersEquationsSay) {
  Description scene = rigid_box({0.3, 0.2, 0.1}, 1000);
  const Vector3 inertia(0.025, 0.05, 0.065), w(0.01, 10, 0.02);
  scene.bodies[0].velocity_gradient = cross_of(w);
  scene.integrator = "newmark";
  scene.end_time = 2;
  const Eigen::Matrix3d expected = turned_by_euler(inertia, w, scene.end_time);
  std::vector<double> errors;
  for (const double time_step : {2e-3, 1e-3}) {
    scene.time_step = time_step;
    const Simulation end = converged_end_of(scene);
    const Eigen::Matrix3d F = gradient_of(end);
    EXPECT_LT(stretch_of(F), 1e-6);
    errors.push_back((rotation_of(F) - expected).norm());
    EXPECT_NEAR(end.frame().kinetic_energy, 0.5 * w.dot(inertia.cwiseProduct(w)), 1e-3);
    EXPECT_LT((end.frame().angular_momentum - inertia.cwiseProduct(w)).norm(), 1e-4);
  }
  EXPECT_LT(errors[1], 5e-3);
  EXPECT_LT(errors[1], 0.3 * errors[0]);
}

TEST(ARigidBody, FallsFreely) {
  for (const std::string& integrator : integrator_names())
    for (const int dim : {2, 3}) {
      Description scene = rigid_box({0.3, 0.2, 0.1}, 1000, dim);
      scene.integrator = integrator;
      scene.gravity = {0, -10, 0};
      scene.end_time = 0.1;
      const Simulation end = converged_end_of(scene);
      EXPECT_LT(stretch_of(gradient_of(end)), 1e-12) << integrator;
      EXPECT_NEAR(end.state().velocities[1], -1, 1e-9) << integrator;
    }
}

TEST(ARigidBody, TurnsFastWithEveryScheme) {
  for (const std::string& integrator : integrator_names()) {
    Description scene = rigid_box({0.3, 0.2, 0.1}, 1000);
    scene.bodies[0].velocity_gradient = cross_of({3, 10, -5});
    scene.integrator = integrator;
    scene.end_time = 0.1;
    EXPECT_LT(stretch_of(gradient_of(converged_end_of(scene))), 1e-3) << integrator;
  }
}

/// A box that hangs from a hinge along z in the middle of its top.
Description pendulum(double amplitude) {
  Description scene = rigid_box({0.1, 0.5, 0.1}, 1000);
  scene.gravity = {9.81 * std::sin(amplitude), -9.81 * std::cos(amplitude), 0};
  FixDescription hinge;
  hinge.name = "hinge";
  hinge.where.kind = Where::Kind::box;
  hinge.where.min = {-1e-3, 0.249, -1};
  hinge.where.max = {1e-3, 0.251, 1};
  scene.fixes.push_back(hinge);
  return scene;
}

TEST(ALargePendulum, SwingsWithThePeriodOfTheEllipticIntegral) {
  // 4 K(sin(amplitude/2)) sqrt(I / (m g l)) for 2 rad: docs/validation.md.
  constexpr double quarter = 1.5468178693358496 / 4;
  Description scene = pendulum(2);
  scene.integrator = "tr_bdf2";
  scene.end_time = quarter;
  scene.time_step = quarter / 400;
  const Simulation end = converged_end_of(scene);
  const Eigen::Matrix3d R = rotation_of(gradient_of(end));
  EXPECT_NEAR(std::abs(std::atan2(R(1, 0), R(0, 0))), 2, 1e-4);
  const Vector3 momentum = end.frame().linear_momentum;
  EXPECT_NEAR(momentum.norm(), 5 * 0.25 * 9.084553466315302, 1e-3);
  const Vector3 force = end.frame().reactions[0].second;
  EXPECT_NEAR(force.norm(), 152.21138960292674, 0.05);
}

TEST(ABodyHeldInItsCentre, HasAFullMassMatrix) {
  Description scene = rigid_box({0.3, 0.2, 0.1}, 1000);
  const Vector3 inertia(0.025, 0.05, 0.065), w(0.01, 10, 0.02);
  scene.bodies[0].velocity_gradient = cross_of(w);
  FixDescription pin;
  pin.where.kind = Where::Kind::sphere;
  pin.where.radius = 1e-3;
  scene.fixes.push_back(pin);
  scene.integrator = "newmark";
  scene.time_step = 1e-3;
  scene.end_time = 1;
  const World world(scene);
  EXPECT_FALSE(world.bodies[0].rigid->is_lumped());
  EXPECT_NEAR(world.mass->total(), 6, 1e-10);
  const Simulation end = converged_end_of(scene);
  EXPECT_LT((rotation_of(gradient_of(end)) - turned_by_euler(inertia, w, 1)).norm(), 1e-3);
}

TEST(ARigidBody, OnASpringAndUnderAForceIsInBalance) {
  Description scene = rigid_box({0.4, 0.2, 0.2}, 1000);
  scene.is_dynamic = false;
  scene.gravity = {0, 0, -10};
  LoadDescription springs;
  springs.kind = "spring";
  springs.where.kind = Where::Kind::plane;
  springs.where.axis = 2;
  springs.where.at = -0.1;
  springs.stiffness = 1000;  // 9 vertices
  LoadDescription force;
  force.kind = "force";
  force.where.kind = Where::Kind::plane;
  force.where.at = 0.2;
  force.value = {90, 0, 0};
  scene.loads = {springs, force};
  const Simulation end = converged_end_of(scene);
  Vector3 lowest = Vector3::Zero();
  const World& world = end.world();
  const VectorX moved = end.state().positions - world.rest_positions;
  const VectorX weights = world.bodies[0].rigid->weights({0, 0, -0.1});
  for (Index a = 0; a < 4; ++a) lowest += weights[a] * moved.segment<3>(3 * Eigen::Index{a});
  EXPECT_NEAR(lowest.x(), 90.0 / 9000, 1e-7);
  EXPECT_NEAR(lowest.z(), -160.0 / 9000, 1e-7);
  EXPECT_LT(stretch_of(gradient_of(end)), 1e-5);
}

TEST(ARigidBody, HeldByAFaceMovesAsPrescribedAndReportsItsWeight) {
  Description scene = rigid_box({0.4, 0.2, 0.2}, 1000);
  scene.is_dynamic = false;
  scene.gravity = {0, 0, -10};
  FixDescription face;
  face.name = "face";
  face.where.kind = Where::Kind::plane;
  face.where.at = -0.2;
  face.rotate = Rotation{.axis = {1, 0, 0}, .degrees = 90};
  scene.fixes = {face};
  const Simulation end = converged_end_of(scene);
  Eigen::Matrix3d turned;
  turned << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  EXPECT_LT((gradient_of(end) - turned).norm(), 1e-12);
  EXPECT_NEAR(end.frame().reactions[0].second.z(), 160, 1e-9);
}

TEST(ARigidBody, UnderPressureHasTheForceOfTheTurnedFace) {
  Description scene = rigid_box({0.4, 0.2, 0.2}, 1000);
  scene.is_dynamic = false;
  FixDescription face;
  face.where.kind = Where::Kind::plane;
  face.where.at = -0.2;
  face.rotate = Rotation{.axis = {0, 0, 1}, .degrees = 90};
  scene.fixes = {face};
  LoadDescription pressure;
  pressure.kind = "pressure";
  pressure.where.kind = Where::Kind::plane;
  pressure.where.at = 0.2;
  pressure.pressure = 100;
  scene.loads = {pressure};
  const Simulation end = converged_end_of(scene);
  EXPECT_LT((end.frame().reactions[0].second - Vector3(0, 4, 0)).norm(), 1e-9);
}

/// A block of 0.2 x 0.3 m on a floor; gravity is tilted in place of it.
Simulation block_on_slope(double degrees, double friction) {
  Description scene = rigid_box({0.2, 0.3, 0}, 1000, 2);
  const double slope = degrees * std::numbers::pi / 180;
  scene.gravity = 9.81 * Vector3(std::sin(slope), -std::cos(slope), 0);
  scene.time_step = 0.005;
  scene.end_time = 0.4;
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = {0, -0.15005, 0};
  floor.activation_distance = 1e-4;  // a drop of half of it hardly tips a block
  floor.shape.normal = {0, 1, 0};
  floor.friction = friction;
  scene.colliders = {floor};
  return converged_end_of(scene);
}

TEST(ARigidBlock, SlidesAndTipsBeyondItsThresholds) {
  const auto speed = [](const Simulation& end) { return end.frame().linear_momentum.x() / 60; };
  const auto turn = [](const Simulation& end) {
    const Eigen::Matrix3d F = gradient_of(end);
    return std::atan2(F(1, 0), F(0, 0));
  };
  const Simulation rests = block_on_slope(15, 0.3), slides = block_on_slope(20, 0.3),
                   stands = block_on_slope(31, 1.5), tips = block_on_slope(36, 1.5);
  EXPECT_LT(speed(rests), 0.01);
  EXPECT_NEAR(speed(slides), 0.4 * 0.5897022230518818, 0.02);
  EXPECT_LT(std::abs(turn(stands)), 0.01);
  EXPECT_GT(std::abs(turn(tips)), 0.05);
}

TEST(TermsOfARigidBody, HaveTheDerivativesOfTheirEnergy) {
  for (const char* kind : {"pressure", "spring", "traction", "body_force", "nodal_force"})
    for (const int dim : {2, 3}) {
      Description scene = rigid_box({0.4, 0.3, 0.2}, 1000, dim);
      LoadDescription load;
      load.kind = kind;
      load.value = {1, 2, dim == 3 ? 3.0 : 0.0};
      load.pressure = 5;
      load.stiffness = 7;
      load.where.kind = Where::Kind::all;
      scene.loads = {load};
      const World world(scene);
      const Energy& term = *world.terms[world.term_of_load(0)];
      const Eigen::Index n = world.rest_positions.size();
      VectorX x = world.rest_positions;
      for (Eigen::Index i = 0; i < n; ++i) x[i] += 0.05 * std::sin(3.0 * static_cast<double>(i + 1));
      VectorX gradient = VectorX::Zero(n);
      term.add_gradient(x, {}, gradient);
      BlockMatrix hessian(dim, world.pattern);
      term.add_hessian(x, {}, Projection::none, hessian);
      for (Eigen::Index i = 0; i < n; ++i) {
        constexpr double h = 1e-5;
        const VectorX e = VectorX::Unit(n, i);
        EXPECT_NEAR(term.difference(x - h * e, x + h * e, {}) / (2 * h), gradient[i], 1e-7) << kind << dim;
        VectorX before = VectorX::Zero(n), after = before, column;
        term.add_gradient(x - h * e, {}, before);
        term.add_gradient(x + h * e, {}, after);
        multiply(hessian, e, column);
        EXPECT_LT((column - (after - before) / (2 * h)).norm(), 1e-6) << kind << dim;
      }
    }
}

TEST(ARigidCube, RestsOnASoftBlockWithItsWeight) {
  Description scene = rigid_box({0.1, 0.1, 0.1}, 2000);
  scene.gravity = {0, 0, -10};
  scene.time_step = 0.02;
  scene.end_time = 1;
  scene.bodies[0].translate = {0, 0, 0.051};
  BodyDescription soft;
  soft.name = "soft";
  soft.place = "soft";
  soft.element = "P1";
  soft.mesh = make_box({0.2, 0.2, 0.1}, {4, 4, 2});
  soft.translate = {-0.1, -0.1, -0.1};
  scene.bodies.push_back(soft);
  FixDescription ground;
  ground.body = "soft";
  ground.where.kind = Where::Kind::plane;
  ground.where.axis = 2;
  ground.where.at = -0.1;
  scene.fixes = {ground};
  const Simulation end = converged_end_of(scene);
  EXPECT_LT(stretch_of(gradient_of(end)), 1e-5);
  ASSERT_EQ(end.frame().contacts.size(), 1U);
  EXPECT_NEAR(end.frame().contacts[0].force.norm(), 20, 0.2);
}

TEST(RigidCubes, StayInAStack) {
  Description scene = rigid_box({0.1, 0.1, 0.1}, 1000);
  scene.gravity = {0, 0, -10};
  scene.time_step = 0.01;
  scene.end_time = 0.3;
  scene.contact.friction = 0.5;
  for (int i = 1; i < 3; ++i) {
    scene.bodies.push_back(scene.bodies[0]);
    scene.bodies.back().name = std::to_string(i);
    scene.bodies.back().translate.z() = 0.1005 * i;
  }
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = {0, 0, -0.0505};
  floor.shape.normal = {0, 0, 1};
  floor.friction = 0.5;
  scene.colliders = {floor};
  const Simulation end = converged_end_of(scene);
  EXPECT_LT((end.state().positions - end.world().start_positions).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT(end.state().velocities.cwiseAbs().maxCoeff(), 0.02);
}

TEST(ARigidBody, IsRefusedWithoutWhatItNeeds) {
  Description scene = rigid_box({1, 1, 1}, 1000);
  scene.bodies[0].rigid->density.reset();
  EXPECT_THAT(refusal_of(scene),
              HasSubstr("density: expected a density for a rigid body with weight or inertia"));
  scene = rigid_box({1, 1, 1}, 1000);
  scene.bodies[0].velocity_gradient = Eigen::Matrix3d::Identity();
  EXPECT_THAT(refusal_of(scene), HasSubstr("velocity_gradient: expected a spin"));
  scene = rigid_box({1, 1, 1}, 1000);
  scene.bodies[0].damping.stiffness = 1;
  EXPECT_THAT(refusal_of(scene), HasSubstr("damping"));
  scene = pendulum(1);
  FixDescription corner = scene.fixes[0];
  corner.where.min = {-0.06, -0.26, -0.06};
  corner.where.max = {-0.04, -0.24, -0.04};
  scene.fixes.push_back(corner);
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("the same point or line"), HasSubstr("one [[fix]]")));
}

TEST(ARigidBody, GoesOnFromACheckpointWithTheSameBits) {
  Description scene = pendulum(1);
  scene.end_time = 0.1;
  expect_same_bits_after_a_checkpoint(scene, 4);
}

}  // namespace
}  // namespace resilin::testing
