// Changes that must not change a result: restarts, numbering, the place in space, the units.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "resilin/material/law.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

TEST(SameBits, AfterARestartFromACheckpoint) {
  for (const bool is_dynamic : {false, true}) {
    Description scene = small_bar(3, is_dynamic);
    scene.load_steps = 10;
    expect_same_bits_after_a_checkpoint(scene, 4);
  }
}

/// Two converged answers differ by what the stopping rule leaves: 1e-12 of the load moves the tip by less
/// than 1e-10.
Description tight(Description scene) {
  scene.newton.tolerance = 1e-12;
  return scene;
}

TEST(Result, DoesNotDependOnTheNumberingOfVerticesAndCells) {
  for (const int dimension : {2, 3}) {
    for (const bool is_dynamic : {false, true}) {
      const Description scene = tight(small_bar(dimension, is_dynamic));
      Description shuffled = scene;
      Mesh& mesh = shuffled.bodies[0].mesh;
      std::mt19937 generator(7);
      std::vector<Index> new_number(mesh.vertices.size());
      std::iota(new_number.begin(), new_number.end(), 0);
      std::shuffle(new_number.begin(), new_number.end(), generator);
      const Mesh original = mesh;
      for (std::size_t v = 0; v < new_number.size(); ++v) {
        mesh.vertices[static_cast<std::size_t>(new_number[v])] = original.vertices[v];
      }
      mesh.groups.clear();
      for (CellBlock& block : mesh.blocks) {
        for (Index& node : block.nodes) node = new_number[static_cast<std::size_t>(node)];
      }
      const Simulation expected = run_all(scene);
      const Simulation got = run_all(shuffled);
      ASSERT_TRUE(expected.is_finished());
      ASSERT_TRUE(got.is_finished());
      for (std::size_t v = 0; v < new_number.size(); ++v) {
        const auto i = static_cast<Eigen::Index>(v) * dimension;
        const Eigen::Index j = Eigen::Index{new_number[v]} * dimension;
        EXPECT_LT(
            (expected.state().positions.segment(i, dimension) - got.state().positions.segment(j, dimension))
                .norm(),
            1e-10);
      }
    }
  }
}

TEST(Result, MovesWithTheWholeScene) {
  const Description scene = tight(small_bar(3, false));
  const Eigen::AngleAxisd rotation(0.7, Vector3(1, 2, 3).normalized());
  const Vector3 shift(3, -2, 5);
  Description moved = scene;
  for (Vector3& X : moved.bodies[0].mesh.vertices) X = rotation * X + shift;
  moved.gravity = rotation * scene.gravity;
  moved.fixes[0].where = {};
  moved.fixes[0].where.kind = Where::Kind::vertices;
  for (std::size_t v = 0; v < scene.bodies[0].mesh.vertices.size(); ++v) {
    if (scene.bodies[0].mesh.vertices[v].x() == 0)
      moved.fixes[0].where.vertices.push_back(static_cast<Index>(v));
  }
  const Simulation expected = run_all(scene);
  const Simulation got = run_all(moved);
  ASSERT_TRUE(got.is_finished());
  for (Index v = 0; v < expected.world().num_nodes(); ++v) {
    const Vector3 x = expected.state().positions.segment<3>(3 * v);
    EXPECT_LT((rotation * x + shift - got.state().positions.segment<3>(3 * v)).norm(), 1e-10);
  }
}

bool is_in_pascals(const LawInfo& law, const std::string& constant) {
  const auto found = std::ranges::find(law.constants, constant, &ConstantText::name);
  return found != law.constants.end() ? found->unit == "Pa" : constant == "youngs_modulus";
}

TEST(Result, IsTheSameInMillimetresTonnesAndMegapascals) {
  for (const LawInfo* law : laws()) {
    for (const bool is_dynamic : {false, true}) {
      SCOPED_TRACE(std::string(law->name) + (is_dynamic ? " in motion" : " at rest"));
      Description metres = small_bar(3, is_dynamic);
      metres.bodies[0].material = material_of(*law);
      metres.gravity *= 0.3;
      Description millimetres = metres;
      for (Vector3& X : millimetres.bodies[0].mesh.vertices) X *= 1000;
      millimetres.gravity *= 1000;
      for (auto& [constant, value] : millimetres.bodies[0].material.constants)
        if (is_in_pascals(*law, constant)) value *= 1e-6;
      millimetres.bodies[0].material.density *= 1e-12;
      const Simulation a = run_all(metres);
      const Simulation b = run_all(millimetres);
      EXPECT_TRUE(a.is_finished() && b.is_finished());
      EXPECT_EQ(a.frame().newton_iterations, b.frame().newton_iterations);
      EXPECT_LT((1000 * a.state().positions - b.state().positions).norm(), 1e-9 * b.state().positions.norm());
    }
  }
}

TEST(AnInterruptedStep, LeavesStateAndFrameAsTheyWere) {
  for (const bool is_dynamic : {false, true}) {
    Simulation simulation(small_bar(3, is_dynamic));
    if (is_dynamic) simulation.step();
    const VectorX before = simulation.state().positions;
    const Frame frame = simulation.frame();
    const StepReport report = simulation.step([](const auto&) { return false; });
    EXPECT_EQ(report.status, StepReport::Status::interrupted);
    EXPECT_EQ(simulation.state().positions, before);
    EXPECT_EQ(simulation.frame().newton_iterations, frame.newton_iterations);
    EXPECT_EQ(simulation.frame().residual, frame.residual);
    EXPECT_EQ(simulation.frame().converged, frame.converged);
  }
}

TEST(Motion, WithoutForcesKeepsItsMomentum) {
  for (const LawInfo* law : laws()) {
    for (const int dimension : {2, 3}) {
      Description scene = small_bar(dimension, true);
      scene.fixes.clear();
      scene.gravity.setZero();
      scene.newton.tolerance = 1e-12;
      scene.bodies[0].material = material_of(*law);
      scene.bodies[0].velocity = {0.3, -0.2, dimension == 3 ? 0.1 : 0.0};
      scene.bodies[0].velocity_gradient(0, 1) = 0.5;
      Simulation simulation(scene);
      const Vector3 start = simulation.frame().linear_momentum;
      while (!simulation.is_finished()) {
        ASSERT_EQ(simulation.step().status, StepReport::Status::converged) << law->name;
        EXPECT_LT((simulation.frame().linear_momentum - start).norm(), 1e-9 * start.norm()) << law->name;
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
