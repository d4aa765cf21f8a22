// Forces of bodies in contact beside exact ones: balance, even pressure, quadratic convergence.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "resilin/contact/half_space.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/simulation/simulation.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double block_modulus = 1e5;  // Pa

BodyDescription elastic_block(const std::string& name, const Mesh& mesh, double poissons_ratio) {
  BodyDescription body;
  body.name = name;
  body.mesh = mesh;
  body.element = "P1";
  body.material.constants = {{"youngs_modulus", block_modulus}, {"poissons_ratio", poissons_ratio}};
  return body;
}

FixDescription held_face(const std::string& body, int axis, double at) {
  FixDescription fix;
  fix.name = body + " " + std::to_string(axis);
  fix.body = body;
  fix.where.kind = Where::Kind::plane;
  fix.where.axis = axis;
  fix.where.at = at;
  fix.components = {axis == 0, axis == 1, axis == 2};
  return fix;
}

/// A block upon another one, their cells in the measure 4 to 3, pressed from above and free to
/// become wider.
Description pressed_blocks(int dim, double pressure) {
  Description scene;
  scene.dimension = dim;
  scene.load_steps = 1;
  const double clearance = 0.5 * 0.005;
  const int up = dim - 1;
  for (const bool is_upper : {false, true}) {
    const int n = is_upper ? 3 : 4;
    const Vector3 low = is_upper ? Vector3((1 + clearance) * Vector3::Unit(up)) : Vector3::Zero();
    const Mesh mesh =
        dim == 3 ? make_box({1, 1, 1}, {n, n, n}, low) : make_rectangle({1, 1}, {n, n}, low.head<2>());
    scene.bodies.push_back(elastic_block(is_upper ? "upper" : "lower", mesh, 0.3));
    for (int axis = 0; axis < up; ++axis) scene.fixes.push_back(held_face(scene.bodies.back().name, axis, 0));
  }
  scene.fixes.push_back(held_face("lower", up, 0));
  LoadDescription press;
  press.kind = "traction";
  press.body = "upper";
  press.where.kind = Where::Kind::plane;
  press.where.axis = up;
  press.where.at = 2 + clearance;
  press.value = -pressure * Vector3::Unit(up);
  scene.loads.push_back(press);
  return scene;
}

/// Deformation gradients of all cells of a world of simplices.
template <int dim>
std::vector<Matrix<dim>> deformation_gradients(const Simulation& simulation) {
  const World& world = simulation.world();
  std::vector<Matrix<dim>> gradients;
  for (const Body& body : world.bodies)
    for (std::size_t k = 0; k < body.cells.size(); k += dim + 1) {
      const auto edges = [&](const VectorX& x) {
        Matrix<dim> D;
        const auto place = [&](std::size_t i) -> Vector<dim> {
          return x.segment<dim>(Eigen::Index{body.cells[k + i]} * dim);
        };
        for (int i = 0; i < dim; ++i) D.col(i) = place(static_cast<std::size_t>(i) + 1) - place(0);
        return D;
      };
      gradients.push_back(edges(simulation.state().positions) * edges(world.rest_positions).inverse());
    }
  return gradients;
}

/// The largest difference of a cell's strain from the even one, as a share of it.
template <int dim>
double unevenness(const Simulation& simulation) {
  const std::vector<Matrix<dim>> F = deformation_gradients<dim>(simulation);
  Matrix<dim> mean = Matrix<dim>::Zero();
  for (const Matrix<dim>& each : F) mean += each / static_cast<double>(F.size());
  double largest = 0;
  for (const Matrix<dim>& each : F) largest = std::max(largest, (each - mean).norm());
  return largest / (mean - Matrix<dim>::Identity()).norm();
}

/// The patch test of contact. The points of a face bear by their own areas, which the triangles of the other
/// one do not know of: cells beside the faces feel that.
TEST(BlocksUnderEvenPressure, AreStrainedEvenlyBesideWhereTheyTouch) {
  for (const double pressure : {500.0, 5000.0}) {
    EXPECT_LT(unevenness<2>(converged_end_of(pressed_blocks(2, pressure))), 0.1) << pressure;
    EXPECT_LT(unevenness<3>(converged_end_of(pressed_blocks(3, pressure))), 0.18) << pressure;
  }
}

/// Two cubes of 0.4 m, one upon the other upon the ground, of n cells along an edge.
Description stacked_cubes(int n) {
  Description scene;
  scene.gravity = {0, 0, -9.81};
  scene.load_steps = 1;
  scene.newton.tolerance = 1e-12;
  for (const bool is_upper : {false, true}) {
    const Mesh mesh =
        make_box({0.4, 0.4, 0.4}, {n, n, n}, {0, 0, is_upper ? 0.402 : 0.001}, TetPattern::five);
    scene.bodies.push_back(elastic_block(is_upper ? "upper" : "lower", mesh, 0.4));
    const double low = is_upper ? 0.402 : 0.001;
    for (const int which : {0, 1}) {  // the middle of the lower face stays where it is, and does not turn
      FixDescription fix;
      fix.name = scene.bodies.back().name + " " + std::to_string(which);
      fix.body = scene.bodies.back().name;
      fix.where.kind = Where::Kind::sphere;
      fix.where.center = {which == 0 ? 0.2 : 0.4, 0.2, low};
      fix.where.radius = 1e-6;
      fix.components = {which == 0, true, false};
      scene.fixes.push_back(fix);
    }
  }
  ColliderDescription ground;
  ground.name = "ground";
  ground.shape.normal = {0, 0, 1};
  scene.colliders.push_back(ground);
  scene.contact.stiffness = 1e4;  // value of the other program
  return scene;
}

/// Each layer carries what is above it, the ground all of it.
TEST(StackedCubes, AreInBalance) {
  const Simulation simulation = converged_end_of(stacked_cubes(4));
  const double weight = 9.81 * 64;
  const auto& reactions = simulation.frame().reactions;
  const auto ground = std::ranges::find_if(reactions, [](const auto& r) { return r.first == "ground"; });
  ASSERT_NE(ground, reactions.end());
  EXPECT_NEAR(ground->second.z(), 2 * weight, 1e-9 * weight);
  const SurfaceContact& contact = *simulation.world().contact;
  VectorX gradient = VectorX::Zero(simulation.state().positions.size());
  contact.add_gradient(simulation.state().positions, {}, gradient);
  double force = 0;
  const Body& upper = simulation.world().bodies[1];
  for (Index node = upper.first_node; node < upper.first_node + upper.num_nodes; ++node)
    force -= gradient[3 * node + 2];
  EXPECT_NEAR(force, weight, 1e-9 * weight);
  // Another program has 0.616 of the activation distance, with its own rule for areas.
  const double gap = contact.smallest_gap(simulation.state().positions).distance;
  EXPECT_NEAR(gap / contact.activation_distance(), 0.6, 0.03);
}

/// Vertices upon vertices, where distances have kinks: once these are past, an iteration takes more digits at
/// a time than linear convergence could.
TEST(StackedCubes, ConvergeQuadratically) {
  Simulation simulation(stacked_cubes(4));
  std::vector<double> residuals;
  const StepReport report = simulation.step([&](const NewtonReport& so_far) {
    residuals.push_back(so_far.relative_residual());
    return true;
  });
  ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  double least_ratio = 1;
  for (std::size_t k = 1; k < residuals.size(); ++k)
    least_ratio = std::min(least_ratio, residuals[k] / residuals[k - 1]);
  EXPECT_LE(least_ratio, 1e-3);
  EXPECT_LE(residuals.size(), 30U);
}

}  // namespace
}  // namespace resilin::testing
