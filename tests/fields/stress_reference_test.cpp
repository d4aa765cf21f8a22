// Stress in the middle of an inflated thick shell against its semi-analytic solution (tests/reference).

#include <gtest/gtest.h>

#include "reference_case.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin::testing {
namespace {

/// Mean radial and hoop Cauchy stress where edges of cells cross R = 1.5, from the smoothed stress.
std::array<double, 2> middle_stress(const Simulation& simulation) {
  const World& world = simulation.world();
  const std::vector<double> stress =
      FieldEvaluator(world)
          .evaluate(simulation.state(), std::vector<std::string>{"nodal_cauchy_stress"})[0]
          .values;
  const auto radius = [&](Index i) { return node_position(3, i, world.rest_positions).norm(); };
  const CellBlock block{.kind = world.bodies[0].cell_kind, .nodes = world.bodies[0].cells};
  double radial = 0, hoop = 0;
  int count = 0;
  for (const auto& [i, j] : edges(block)) {
    const double t = (1.5 - radius(i)) / (radius(j) - radius(i));
    if (!(t > 0 && t < 1)) continue;
    const auto between = [t](const auto& a, const auto& b) { return ((1 - t) * a + t * b).eval(); };
    const auto position = [&](Index k) { return node_position(3, k, simulation.state().positions); };
    const auto tensor = [&](Index k) { return Eigen::Map<const Matrix<3>>(stress.data() + 9 * k); };
    const Vector3 n = between(position(i), position(j)).normalized();
    const Matrix<3> sigma = between(tensor(i), tensor(j));
    radial += n.dot(sigma * n);
    hoop += 0.5 * (sigma.trace() - n.dot(sigma * n));
    ++count;
  }
  return {radial / count, hoop / count};
}

TEST(StressReference, InTheMiddleOfAShellComesNearerWithTheMesh) {
  const nlohmann::json reference = read_reference("sphere_inflation_3d");
  const nlohmann::json& exact = reference["semi_analytic"]["sphere_nh_log_ri1.5"];
  const double hoop = exact["mid_cauchy_hoop"], radial = exact["mid_cauchy_rr"];
  std::vector<double> errors;
  for (const std::string mesh : {"meshes/shell_coarse.msh", "meshes/shell_fine.msh"}) {
    Description description =
        one_body(3, reference_mesh(mesh),
                 reference_law("nh_log", reference["material"]["mu"], reference["material"]["lam"]));
    description.newton.tolerance = 1e-8;
    for (int axis = 0; axis < 3; ++axis) {
      FixDescription symmetry = fix("plane " + std::to_string(axis), plane(axis, 0));
      symmetry.components = {axis == 0, axis == 1, axis == 2};
      description.fixes.push_back(symmetry);
    }
    FixDescription inner = fix("inner", group("inner"));
    inner.gradient = 0.5 * Matrix<3>::Identity();
    description.fixes.push_back(inner);
    Simulation simulation(description);
    run_to_end(simulation);
    const auto [radial_found, hoop_found] = middle_stress(simulation);
    errors.push_back(std::hypot(radial_found - radial, hoop_found - hoop) / hoop);
  }
  EXPECT_LT(errors[1], 0.6 * errors[0]);  // cells of half the size
  EXPECT_LT(errors[1], 0.05);
}

}  // namespace
}  // namespace resilin::testing
