// Properties of whole simulations for every law of the catalogue, without reference data.

#include <gtest/gtest.h>

#include <random>

#include "resilin/material/derive.hpp"
#include "resilin/mesh/facet.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

bool is_inside(const Vector3& X, int dimension) {
  for (int k = 0; k < dimension; ++k) {
    if (X[k] <= 0 || X[k] >= 1) return false;
  }
  return true;
}

/// A unit square or cube whose inner vertices are displaced at random, so that no cell is like another.
Mesh distorted_mesh(int dimension) {
  Mesh mesh = dimension == 3 ? make_box({1, 1, 1}, {3, 3, 3}) : make_rectangle({1, 1}, {4, 4});
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-0.04, 0.04);
  for (Vector3& X : mesh.vertices) {
    if (!is_inside(X, dimension)) continue;
    for (int k = 0; k < dimension; ++k) X[k] += uniform(generator);
  }
  return mesh;
}

Description patch(int dimension, const LawInfo& law, const Eigen::Matrix3d& gradient) {
  Description scene;
  scene.dimension = dimension;
  scene.newton.tolerance = 1e-13;
  BodyDescription body;
  body.mesh = distorted_mesh(dimension);
  body.material = material_of(law);
  FixDescription sides;
  sides.where.kind = Where::Kind::vertices;
  sides.gradient = gradient;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v) {
    if (!is_inside(body.mesh.vertices[v], dimension)) sides.where.vertices.push_back(static_cast<Index>(v));
  }
  scene.bodies.push_back(std::move(body));
  scene.fixes.push_back(sides);
  return scene;
}

TEST(EveryLaw, PassesThePatchTestOnADistortedMesh) {
  Eigen::Matrix3d gradient;
  gradient << 0.15, 0.2, 0.05, -0.1, -0.05, 0.1, 0.05, -0.1, 0.1;
  for (const LawInfo* law : laws()) {
    for (const int dimension : {2, 3}) {
      SCOPED_TRACE(std::string(law->name) + " in " + std::to_string(dimension) + "D");
      const Simulation simulation = run_all(patch(dimension, *law, gradient));
      ASSERT_TRUE(simulation.is_finished());
      const World& world = simulation.world();
      double largest_error = 0;
      for (Index i = 0; i < world.num_nodes(); ++i) {
        const Vector3 X = node_position(dimension, i, world.rest_positions);
        Vector3 expected = X + gradient * X;
        if (dimension == 2) expected.z() = 0;
        largest_error = std::max(
            largest_error, (node_position(dimension, i, simulation.state().positions) - expected).norm());
      }
      EXPECT_LT(largest_error, 1e-12);  // lengths are about 1
      // The energy is that of one material point, for the volume is 1.
      const Material material = world.bodies[0].domains.front().energy->material(0);
      const double density =
          dimension == 3
              ? from_displacement_gradient::energy_density<3>(material, gradient)
              : from_displacement_gradient::energy_density<2>(material, gradient.topLeftCorner<2, 2>());
      EXPECT_NEAR(simulation.frame().elastic_energy, density, 1e-12 * density);
    }
  }
}

/// Whether a cell that is turned inside out along an axis is pushed back all the way.
bool pushes_back(const LawInfo& law) {
  const Material material{&law, law.constants_from(hooke_from_young_poisson(1e5, 0.3)), {}};
  for (const double stretch : {-1.2, -0.6, -0.1, 0.3, 0.8}) {
    const Matrix<3> F = Vector3(stretch, 0.95, 1.05).asDiagonal();
    if (!(first_piola_kirchhoff_stress<3>(material, F)(0, 0) < 0)) return false;
  }
  return true;
}

/// Laws that push inverted cells back bring a body back whose cells were turned inside out. (A body torn far
/// about can be wound around itself: such a start may end in another minimum, with all cells upright.)
TEST(EveryLawThatPushesBack, BringsAScrambledBodyBackToRest) {
  EXPECT_TRUE(pushes_back(*find_law("stable_neo_hookean")));
  EXPECT_FALSE(pushes_back(*find_law("saint_venant_kirchhoff")));
  for (const LawInfo* law : laws()) {
    if (!pushes_back(*law)) continue;
    for (const int dimension : {2, 3}) {
      for (unsigned seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE(std::string(law->name) + " in " + std::to_string(dimension) + "D, seed " +
                     std::to_string(seed));
        Description scene = small_bar(dimension, false);
        scene.gravity.setZero();
        BodyDescription& body = scene.bodies[0];
        body.material = material_of(*law);
        std::mt19937 generator(seed);
        std::uniform_real_distribution<double> uniform(-0.12, 0.12);  // cells are 0.125 m wide
        for (const Vector3& X : body.mesh.vertices) {
          for (int k = 0; k < dimension; ++k)
            body.initial_positions.push_back(X.x() == 0 ? X[k] : X[k] + uniform(generator));
        }
        Simulation simulation(scene);
        ASSERT_LT(simulation.frame().min_volume_ratio, -0.1);
        const StepReport report = simulation.step();
        EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
        const VectorX distance = simulation.state().positions - simulation.world().rest_positions;
        EXPECT_LT(distance.cwiseAbs().maxCoeff(), 1e-6);
      }
    }
  }
}

/// Backward Euler without loads: kinetic plus elastic energy never grows, for any law that is stable where it
/// moves.
TEST(EveryLaw, LosesEnergyInFreeMotion) {
  for (const LawInfo* law : laws()) {
    Description scene = small_bar(3, true);
    scene.gravity.setZero();
    scene.bodies[0].material = material_of(*law);
    scene.bodies[0].velocity_gradient(2, 0) = 1;
    Simulation simulation(scene);
    double energy = simulation.frame().total_energy();
    while (!simulation.is_finished()) {
      ASSERT_EQ(simulation.step().status, StepReport::Status::converged) << law->name;
      EXPECT_LE(simulation.frame().total_energy(), energy * (1 + 1e-9)) << law->name;
      energy = simulation.frame().total_energy();
    }
  }
}

}  // namespace
}  // namespace resilin::testing
