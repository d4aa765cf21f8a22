// Bodies that nothing acts on: whatever moves them is rounding, and the verdict knows it.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <sstream>

#include "every_integrator.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/world/cell_material.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// Random numbers: evenly spread, or their logarithms.
class Dice {
 public:
  explicit Dice(int seed) : random_(static_cast<unsigned>(seed)) {}
  double even(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  double of_any_size(double low, double high) { return std::exp(even(std::log(low), std::log(high))); }
  Vector3 direction() { return Vector3(even(-1, 1), even(-1, 1), even(-1, 1) + 1e-3).normalized(); }
  template <class List>
  const auto& one_of(const List& list) {
    return list[static_cast<std::size_t>(even(0, static_cast<double>(list.size())))];
  }

 private:
  std::mt19937 random_;
};

/// A body of uneven cells, of any size, stiffness and place, in steps of any length.
Description lonely_body(Dice& dice) {
  const ElementInfo& element = *dice.one_of(elements());
  const int dim = element.dim;
  Description scene = small_bar(dim, true);
  scene.fixes.clear();
  scene.probes.clear();
  scene.gravity.setZero();
  scene.integrator = dice.one_of(integrator_names());
  scene.time_step = dice.of_any_size(1e-9, 1e3);
  scene.end_time = 100 * scene.time_step;
  BodyDescription& body = scene.bodies[0];
  body.element = element.name;
  body.mass = dice.even(0, 1) < 0.7 ? MassKind::lumped : MassKind::consistent;
  const bool simplices = is_simplex(element.shape);
  body.mesh =
      dim == 3
          ? (simplices ? make_box({1, 0.5, 0.5}, {3, 2, 1}) : make_hexahedron_box({1, 0.5, 0.5}, {3, 2, 1}))
          : (simplices ? make_rectangle({1, 0.5}, {3, 2}) : make_quadrilateral_rectangle({1, 0.5}, {3, 2}));
  for (Vector3& x : body.mesh.vertices) x += 0.1 * x.x() * x.x() * Vector3(1, 0.5, dim == 3 ? 0.3 : 0);
  body.scale = dice.of_any_size(1e-6, 1e6);
  body.rotate =
      Rotation{.axis = dim == 3 ? dice.direction() : Vector3::UnitZ(), .degrees = dice.even(0, 360)};
  body.translate = body.scale * dice.of_any_size(1e-2, 80) * dice.direction();
  if (dim == 2) body.translate.z() = 0;
  body.material.constants = {{"youngs_modulus", dice.of_any_size(1e-3, 1e13)},
                             {"poissons_ratio", dice.even(0.1, 0.45)}};
  body.material.density = dice.of_any_size(1, 1e4);
  return scene;
}

std::string text_of(const Description& scene) {
  const BodyDescription& body = scene.bodies[0];
  std::ostringstream text;
  text << ": " << body.material.law << ", " << body.element << " in " << scene.dimension << "D, "
       << spelling(body.mass) << ", " << scene.integrator << ", steps of " << scene.time_step << " s, size "
       << body.scale << " m, " << body.translate.norm() << " m away, "
       << body.material.constants.at("youngs_modulus") << " Pa, " << body.material.density << " kg/m^3";
  return text.str();
}

struct LonelyBody : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Anywhere, LonelyBody, ::testing::Range(0, 80), ::testing::PrintToStringParamName());

void expect_convergence(Simulation& simulation, const Description& scene, int steps) {
  for (int step = 0; step < steps && !simulation.is_finished(); ++step) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged)
        << "step " << step << ": " << report.reason << text_of(scene);
  }
}

TEST_P(LonelyBody, RestsInPlace) {
  Dice dice(GetParam());
  const Description scene = lonely_body(dice);
  Simulation simulation(scene);
  const VectorX start = simulation.state().positions;
  expect_convergence(simulation, scene, 20);
  EXPECT_EQ(simulation.state().positions, start) << text_of(scene);
}

/// Its strains are rounding, and so are the forces, the accelerations at the start and all that follows.
TEST_P(LonelyBody, RestsWhenItHasBeenTurned) {
  Dice dice(GetParam());
  Description scene = lonely_body(dice);
  BodyDescription& body = scene.bodies[0];
  const Eigen::AngleAxisd turn(dice.even(0, 3), scene.dimension == 3 ? dice.direction() : Vector3::UnitZ());
  const Eigen::Matrix3d placed = turn.toRotationMatrix() * rotation_matrix(body.rotate);
  for (const Vector3& X : body.mesh.vertices) {
    const Vector3 x = placed * (body.scale * X) + body.translate;
    for (int i = 0; i < scene.dimension; ++i) body.initial_positions.push_back(x[i]);
  }
  Simulation simulation(scene);
  expect_convergence(simulation, scene, 20);
}

/// An equilibrium without strain, whose energy is zero up to rounding that goes by the turn.
TEST_P(LonelyBody, FollowsTheTurnOfOneEnd) {
  Dice dice(1000 + GetParam());
  Description scene = lonely_body(dice);
  scene.is_dynamic = false;
  BodyDescription& body = scene.bodies[0];
  const bool has_pressure = require_element(body.element, scene.dimension, body.place).has_mean_volume;
  const LawInfo* law = nullptr;
  do law = dice.one_of(laws());
  while (law->max_fibres > 0 || law->is_quadratic || !std::isnan(law->only_poissons_ratio) ||
         (has_pressure && !law->has_volume_energy));
  body.material.law = law->name;
  for (const ConstantText& constant : law->constants)
    if (constant.is_free && std::isnan(constant.fallback))
      body.material.constants[std::string(constant.name)] =
          constant.unit.empty() ? 1 : 0.1 * body.material.constants["youngs_modulus"];
  FixDescription end;
  end.where.kind = Where::Kind::vertices;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v)
    if (body.mesh.vertices[v].x() == 0) end.where.vertices.push_back(static_cast<Index>(v));
  end.rotate = Rotation{.axis = scene.dimension == 3 ? dice.direction() : Vector3::UnitZ(),
                        .center = body.translate,
                        .degrees = dice.even(-170, 170)};
  scene.fixes.push_back(end);
  Simulation simulation(scene);
  expect_convergence(simulation, scene, 1000);
  const Eigen::Matrix3d turn = rotation_matrix(end.rotate);
  const VectorX& X = simulation.world().rest_positions;
  double largest = 0;
  for (Index node = 0; node < simulation.world().num_nodes(); ++node)
    largest =
        std::max(largest, (simulation.world().place_of(node, simulation.state().positions) - body.translate -
                           turn * (simulation.world().place_of(node, X) - body.translate))
                              .norm());
  EXPECT_LT(largest, 1e-9 * (body.scale + body.translate.norm())) << text_of(scene);
}

}  // namespace
}  // namespace resilin::testing
