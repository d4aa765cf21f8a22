// The estimate by a step into a richer space, beside the error itself and exact solutions.

#include "resilin/simulation/space_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "resilin/element/catalog.hpp"
#include "resilin/fields/discretisation_error.hpp"
#include "resilin/simulation/richer_space.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// The relative gain of a step into the richer space from the equilibrium of a scene of one body.
struct Told {
  double gain, share, energy;
};
Told told_by(const Description& scene) {
  Simulation simulation(scene);
  while (!simulation.is_finished()) EXPECT_EQ(simulation.step().status, StepReport::Status::converged);
  const std::optional<SpaceError> error = space_error(simulation);
  const std::optional<double> norm =
      squared_solution_norm(simulation.world().bodies[0], simulation.state().positions);
  const double gain = error.value().changes.at(0).value().total() / norm.value();
  return {gain, share_missing(gain, error->is_driven_by_displacements), simulation.frame().elastic_energy};
}

/// Told within a factor of two.
void expect_told(const Description& coarse, const Description& fine) {
  const Told told = told_by(coarse);
  const double exact = run_all(fine).frame().elastic_energy;
  const double off = 1 - std::min(told.energy, exact) / std::max(told.energy, exact);
  EXPECT_GT(told.share, off / 2) << "off by " << off;
  EXPECT_LT(told.share, 2 * off) << "off by " << off;
}

/// A bar of 1 m along x, `cells` along its axes.
Description bar(const std::string& element, std::array<int, 3> cells, double thickness, double poissons_ratio,
                const std::string& law = "linear_elastic") {
  const int dim = cells[2] == 0 ? 2 : 3;
  const bool has_simplices = element[0] == 'P';
  Description scene = small_bar(dim, false);
  scene.gravity.setZero();
  scene.probes.clear();
  BodyDescription& body = scene.bodies[0];
  const Vector3 size(1, thickness, thickness);
  if (dim == 3)
    body.mesh = has_simplices ? make_box(size, cells) : make_hexahedron_box(size, cells);
  else
    body.mesh = has_simplices ? make_rectangle({1, thickness}, {cells[0], cells[1]})
                              : make_quadrilateral_rectangle({1, thickness}, {cells[0], cells[1]});
  body.element = element;
  body.material.law = law;
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", poissons_ratio}};
  return scene;
}

Where plane_at(double x) {
  Where where;
  where.kind = Where::Kind::plane;
  where.at = x;
  return where;
}

/// A second support, at the far end of the bar.
FixDescription& end_support(Description& scene) {
  FixDescription support = scene.fixes[0];
  support.name = "end";
  support.where = plane_at(1);
  scene.fixes.push_back(support);
  return scene.fixes.back();
}

TEST(SpaceError, SeesTheWarpingOfATwistedBarOneCellAcross) {
  const auto twisted = [](const std::string& element, std::array<int, 3> cells) {
    Description scene = bar(element, cells, 0.2, 0.3, "neo_hookean");
    end_support(scene).rotate = Rotation{.axis = Vector3::UnitX(), .center = {0, 0.1, 0.1}, .degrees = 20};
    return scene;
  };
  for (const std::string element : {"P2", "Q1"})
    expect_told(twisted(element, {10, 1, 1}), twisted("P2", {15, 3, 3}));
}

/// Every node is held: no degree of freedom of the element is left.
TEST(SpaceError, SeesTheBulgeOfAPadOfOneLayer) {
  const auto pressed = [](const std::string& element, std::array<int, 3> cells) {
    Description scene = bar(element, cells, 1, 0.45, "neo_hookean");
    end_support(scene).displacement = Vector3(-0.05, 0, 0);
    return scene;
  };
  expect_told(pressed("Q1", {1, 3, 3}), pressed("P2P0", {6, 6, 6}));
}

/// One cell across, linear pressures through the thickness are missing: strips of P2P0 are too soft, pads of
/// Q1P0 that cannot bulge many times too stiff.
TEST(SpaceError, SeesWhatOnePressurePerCellMisses) {
  for (const int dim : {2, 3})
    for (const std::string element : {"P2P0", "Q1P0"})
      for (const int layers : {1, 2})
        for (const bool is_pressed : {false, true}) {
          if (dim == 3 && layers == 2) continue;
          // Cubes that hang are too stiff by their functions and too soft by their pressures: that cancels.
          if (dim == 3 && element == "Q1P0" && !is_pressed) continue;
          SCOPED_TRACE(element + (dim == 2 ? " 2D " : " 3D ") + std::to_string(layers) +
                       (is_pressed ? " pressed" : " hanging"));
          const auto scene = [&](const std::string& name, int n) {
            const int along = is_pressed ? n : 3 * n;
            Description made =
                bar(name, {along, n, dim == 3 ? n : 0}, is_pressed ? 1 : 1.0 / 3, 0.49, "neo_hookean");
            if (is_pressed)
              end_support(made).displacement = Vector3(-0.002, 0, 0);
            else
              made.gravity = Vector3(0, -0.01, 0);
            return made;
          };
          expect_told(scene(element, layers), scene("P2P0", (dim == 3 ? 4 : 6) * layers));
        }
}

TEST(SpaceError, TellsAPartOfErrorsThatCancel) {
  EXPECT_DOUBLE_EQ((SpaceError::Change{3, -1}.total()), 2);
  EXPECT_DOUBLE_EQ((SpaceError::Change{1, -3}.total()), -2);
  EXPECT_DOUBLE_EQ((SpaceError::Change{4, -3.9}.total()), 0.2 * 7.9);
  EXPECT_DOUBLE_EQ((SpaceError::Change{4, -4.1}.total()), -0.2 * 8.1);
}

TEST(SpaceError, IsToldForBendingByEveryElement) {
  for (const std::string element : {"P1", "P2", "Q1"})
    for (const int layers : {1, 2})
      for (const int slenderness : {4, 10}) {
        SCOPED_TRACE(element + " " + std::to_string(layers) + " " + std::to_string(slenderness));
        const auto hanging = [&](const std::string& name, int n) {
          Description scene = bar(name, {n * slenderness, n, 0}, 1.0 / slenderness, 0.3);
          scene.gravity = Vector3(0, -0.01, 0);
          return scene;
        };
        expect_told(hanging(element, layers), hanging("P2", 4 * layers));
      }
}

/// The integral of x^a y^b z^c over the reference tetrahedron is a! b! c! / (a + b + c + 3)!.
TEST(SpaceError, HasARuleOfDegreeFiveOnTetrahedra) {
  const RicherSpace space(require_element("P2", 3, "element"));
  ASSERT_EQ(space.rule().points.size(), 14U);
  const std::array<double, 9> factorial = {1, 1, 2, 6, 24, 120, 720, 5040, 40320};
  for (std::size_t a = 0; a <= 5; ++a)
    for (std::size_t b = 0; a + b <= 5; ++b)
      for (std::size_t c = 0; a + b + c <= 5; ++c) {
        double sum = 0;
        for (const QuadraturePoint& point : space.rule().points)
          sum += point.weight * std::pow(point.xi.x(), a) * std::pow(point.xi.y(), b) *
                 std::pow(point.xi.z(), c);
        EXPECT_NEAR(sum, factorial[a] * factorial[b] * factorial[c] / factorial[a + b + c + 3], 1e-16);
      }
}

/// Pulled by a traction, pressed by a pressure and hanging under its weight: what each element has exactly.
TEST(SpaceError, IsZeroWhereTheElementHoldsTheSolution) {
  for (const std::string element : {"P1", "P2", "Q1"})
    for (const int depth : {0, 2})
      for (const std::string kind : {"traction", "pressure", "body_force"}) {
        if (kind == "body_force" && element != "P2") continue;
        SCOPED_TRACE(element + " " + kind + (depth == 0 ? " in 2D" : " in 3D"));
        Description scene = bar(element, {3, 2, depth}, 0.4, 0);
        LoadDescription load;
        load.kind = kind;
        if (kind != "body_force") load.where = plane_at(1);
        load.value = Vector3(10, 0, 0);
        load.pressure = 10;
        scene.loads.push_back(load);
        EXPECT_LT(told_by(scene).gain, kind == "pressure" ? 1e-9 : 1e-12);
      }
}

}  // namespace
}  // namespace resilin::testing
