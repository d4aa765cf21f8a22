// Signorini's problem: an elastic body pressed on what it must not enter.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double start_gap = 5e-4;  // m, within the activation distance of 1e-3 m

enum class Opposite { half_space, box, block };

/// A block of 1 m whose lower side is curved, pressed by its upper side on a plane, on a box of facets, or on
/// a flat block with another mesh.
Description pressed_on(int dim, Opposite opposite, double depth, double gap = start_gap) {
  const int up = dim - 1;
  const auto block = [&](int n) {
    return dim == 3 ? make_box({1, 1, 1}, {n, n, n}, {-0.5, -0.5, 0})
                    : make_rectangle({1, 1}, {2 * n, n}, {-0.5, 0});
  };
  Description scene;
  scene.dimension = dim;
  scene.newton.tolerance = 1e-12;
  scene.contact.activation_distance = 1e-3;
  BodyDescription body;
  body.name = "upper";
  body.element = "P1";
  body.mesh = block(4);
  for (Vector3& x : body.mesh.vertices) {
    const Vector3 across = x - x[up] * Vector3::Unit(up);
    x[up] += gap + 0.1 * (1 - x[up]) * across.squaredNorm();
  }
  body.material.law = "neo_hookean";
  scene.bodies.push_back(body);
  FixDescription press;
  press.name = "press";
  press.body = "upper";
  press.where.kind = Where::Kind::plane;
  press.where.axis = up;
  press.where.at = 1 + gap;
  press.displacement = -depth * Vector3::Unit(up);
  scene.fixes.push_back(press);
  if (opposite == Opposite::block) {
    body.name = "lower";
    body.mesh = block(3);
    body.translate = -Vector3::Unit(up);
    scene.bodies.push_back(body);
    FixDescription foot;
    foot.name = "foot";
    foot.body = "lower";
    foot.where = press.where;
    foot.where.at = -1;
    scene.fixes.push_back(foot);
  } else {
    ColliderDescription table;
    table.name = "table";
    table.activation_distance = 1e-3;
    if (opposite == Opposite::box) {
      table.kind = "box";
      table.shape.center = -0.5 * Vector3::Unit(up);
      table.shape.size = {4, dim == 3 ? 4.0 : 1.0, 1};
      if (dim == 3)  // no edge of the block is parallel to the diagonal of its upper side
        table.rotate = ColliderTurn{.axis = Vector3::UnitZ(), .degrees = 20};
    }
    table.shape.normal = Vector3::Unit(up);
    scene.colliders.push_back(table);
  }
  return scene;
}

/// Relative residuals of Newton's iterations, those of the search that ended well.
std::vector<double> residuals_of(Simulation& simulation, StepReport& report) {
  std::vector<double> residuals;
  int last = 0;
  report = simulation.step([&](const NewtonReport& so_far) {
    if (so_far.iterations <= last) residuals.clear();
    last = so_far.iterations;
    residuals.push_back(so_far.relative_residual());
    return true;
  });
  return residuals;
}

std::string in_a_row(const std::vector<double>& numbers) {
  std::ostringstream text;
  for (const double number : numbers) text << number << " ";
  return text.str();
}

/// The order p of r_(k+1) ~ r_k^p over the last three residuals that rounding leaves alone; 0 where there are
/// not so many.
double order_of_tail(const std::vector<double>& residuals) {
  constexpr double rounding = 3e-12;
  const auto is_clear = [](double r) { return r > rounding; };
  const auto end = std::ranges::find_if_not(residuals, is_clear);
  if (end - residuals.begin() < 3) return 0;
  return std::log(end[-1] / end[-2]) / std::log(end[-2] / end[-3]);
}

class Signorini : public ::testing::TestWithParam<std::tuple<int, Opposite, double>> {};
INSTANTIATE_TEST_SUITE_P(Family, Signorini,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values(Opposite::half_space, Opposite::box,
                                                              Opposite::block),
                                            ::testing::Values(0.002, 0.01, 0.05)));

/// The barrier is smooth where something touches, so that the last iterations double the digits: the order is
/// 2 in the end, a little off where three residuals are not yet the end.
TEST_P(Signorini, ConvergesQuadraticallyNearTheSolution) {
  const auto [dim, opposite, depth] = GetParam();
  Simulation simulation(pressed_on(dim, opposite, depth));
  StepReport report;
  const std::vector<double> residuals = residuals_of(simulation, report);
  RecordProperty("residuals", in_a_row(residuals));
  ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  EXPECT_GT(order_of_tail(residuals), 1.8) << in_a_row(residuals);
  EXPECT_LE(residuals.size(), 60U);
}

/// Load steps that are far too long at the first touch are cut, and grow again; the end is that of small
/// ones.
TEST_P(Signorini, IsReachedThroughTheFirstTouchByStepsThatAdapt) {
  const auto [dim, opposite, depth] = GetParam();
  const double gap = 0.02;
  const auto run = [&](int load_steps, int max_iterations, int& failed) {
    Description scene = pressed_on(dim, opposite, gap + depth, gap);
    scene.newton.tolerance = 1e-9;
    scene.load_steps = load_steps;
    scene.newton.max_iterations = max_iterations;
    Simulation simulation(scene);
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step();
      failed += report.failed_attempts;
      EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
      if (report.status != StepReport::Status::converged) break;
    }
    return simulation;
  };
  int failed = 0, none = 0;
  const Simulation hurried = run(1, 6, failed), patient = run(20, 100, none);
  EXPECT_GT(hurried.frame().contact_energy, 0);
  EXPECT_LT((hurried.state().positions - patient.state().positions).cwiseAbs().maxCoeff(), 1e-7);
  RecordProperty("failed_attempts", failed);
  EXPECT_GT(failed, 0);
}

}  // namespace
}  // namespace resilin::testing
