// The estimate of the error by the size of the cells, beside the error itself.

#include "resilin/fields/discretisation_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/element/catalog.hpp"
#include "resilin/mesh/facet.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

double estimate_of(const Simulation& simulation) {
  return discretisation_error(simulation.world(), simulation.world().bodies[0], simulation.state().positions)
      .value();
}

/// A body on these cells, and on ones so fine that they count as exact. Energies are in the ratio of the
/// displacements under loads, and of the forces where displacements are prescribed.
struct Judged {
  double error, estimate;
};
Judged judge(const Description& coarse, const Description& fine) {
  const Simulation there = run_all(coarse);
  const double energy = there.frame().elastic_energy, exact = run_all(fine).frame().elastic_energy;
  return {1 - std::min(energy, exact) / std::max(energy, exact), estimate_of(there)};
}

/// Told to a factor of 3 where it matters, and never taken for small or large when it is not.
void expect_told(const Judged& judged) {
  SCOPED_TRACE("off by " + std::to_string(judged.error) + ", told " + std::to_string(judged.estimate));
  if (judged.error > 0.03) {
    EXPECT_LT(judged.estimate, 3 * judged.error);
    EXPECT_GT(judged.estimate, judged.error / 3);
  }
  if (judged.error > 0.05) {
    EXPECT_GT(judged.estimate, large_discretisation_error);
  }
  if (judged.error < 0.01) {
    EXPECT_LT(judged.estimate, 0.05);
  }
}

/// A cantilever of length 1 m under its weight, of Hooke's law, with `layers` cells across.
Description cantilever(int dim, int slenderness, int layers, const std::string& element) {
  Description scene = small_bar(dim, false);
  const double height = 1.0 / slenderness;
  const int along = slenderness * layers;
  const bool has_simplices = element[0] == 'P';
  BodyDescription& body = scene.bodies[0];
  if (dim == 2)
    body.mesh = has_simplices ? make_rectangle({1, height}, {along, layers})
                              : make_quadrilateral_rectangle({1, height}, {along, layers});
  else
    body.mesh = has_simplices ? make_box({1, height, height}, {along, layers, layers})
                              : make_hexahedron_box({1, height, height}, {along, layers, layers});
  body.element = element;
  body.material.law = "linear_elastic";
  body.material.constants = {{"youngs_modulus", 1e7}, {"poissons_ratio", 0.3}};
  scene.probes.clear();
  return scene;
}

TEST(DiscretisationError, IsToldForCantileversOfEverySlendernessAndElementInThePlane) {
  for (const int slenderness : {5, 10, 20, 40}) {
    const Description fine = cantilever(2, slenderness, 6, "P2");
    for (const std::string element : {"P1", "P2", "Q1"})
      for (const int layers : {1, 2, 4}) {
        SCOPED_TRACE(element + ", slenderness " + std::to_string(slenderness) + ", " +
                     std::to_string(layers) + " cells across");
        expect_told(judge(cantilever(2, slenderness, layers, element), fine));
      }
  }
}

TEST(DiscretisationError, IsToldForCantileversInSpace) {
  for (const int slenderness : {5, 20}) {
    const Description fine = cantilever(3, slenderness, 3, "P2");
    for (const std::string element : {"P1", "P2", "Q1"})
      for (const int layers : {1, 2}) {
        SCOPED_TRACE(element + ", slenderness " + std::to_string(slenderness) + ", " +
                     std::to_string(layers) + " cells across");
        expect_told(judge(cantilever(3, slenderness, layers, element), fine));
      }
  }
}

/// A cube of 0.1 m between plates that hold its faces, one of which comes nearer.
Description pressed_block(int n, const std::string& element, double poissons_ratio) {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  BodyDescription& body = scene.bodies[0];
  body.mesh = make_box({0.1, 0.1, 0.1}, {n, n, n});
  body.element = element;
  body.material.law = "neo_hookean_simo";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", poissons_ratio}};
  FixDescription plate = scene.fixes[0];
  plate.name = "plate";
  plate.where.at = 0.1;
  plate.displacement = Vector3(-0.01, 0, 0);
  scene.fixes.push_back(plate);
  scene.probes.clear();
  return scene;
}

TEST(DiscretisationError, IsToldForCompressibleAndNearlyIncompressibleBlocks) {
  for (const double poissons_ratio : {0.3, 0.49}) {
    const Description fine = pressed_block(6, "P2P0", poissons_ratio);
    for (const std::string element : {"P1", "P2", "P2P0"})
      for (const int n : {2, 3}) {
        SCOPED_TRACE(element + ", nu " + std::to_string(poissons_ratio) + ", " + std::to_string(n));
        expect_told(judge(pressed_block(n, element, poissons_ratio), fine));
      }
  }
}

/// The bar of a World stretched, sheared and turned by the same F everywhere, or curved by u = c (x y, x^2).
double estimate_under(const World& world, const Matrix<3>& F, double curvature = 0) {
  VectorX x = world.rest_positions;
  for (Index i = 0; i < world.num_nodes(); ++i) {
    const Vector3 X = node_position(world.dimension, i, world.rest_positions);
    const Vector3 u = curvature * Vector3(-X.x() * X.y(), 0.5 * X.x() * X.x(), 0);
    x.segment(Eigen::Index{i} * world.dimension, world.dimension) = (F * (X + u)).head(world.dimension);
  }
  return discretisation_error(world, world.bodies[0], x).value();
}

TEST(DiscretisationError, IsZeroForStressThatTheElementHas) {
  Matrix<3> F;
  F << 0, -1.3, 0, 1.1, 0.2, 0, 0, 0, 1;  // a quarter of a turn, and strain
  for (const int dim : {2, 3})
    for (const ElementInfo* element : elements()) {
      if (element->dim != dim) continue;
      Description scene = cantilever(dim, 5, 2, std::string(element->name));
      scene.bodies[0].material.law = "neo_hookean_simo";
      EXPECT_LT(estimate_under(World(scene), F), 1e-20) << element->name << " in " << dim << " dimensions";
    }
  // A turn that varies from cell to cell is no strain. Bent by small angles, P2 has all but terms of higher
  // order; P1 has a third.
  Description scene = cantilever(2, 5, 1, "P2");
  scene.bodies[0].material.law = "neo_hookean_simo";
  EXPECT_LT(estimate_under(World(scene), Matrix<3>::Identity(), 1e-4), 1e-6);
  scene.bodies[0].element = "P1";
  EXPECT_GT(estimate_under(World(scene), Matrix<3>::Identity(), 1e-4), 0.3);
}

TEST(DiscretisationError, IsFreeOfUnits) {
  const Description scene = cantilever(2, 10, 2, "P1");
  const double expected = estimate_of(run_all(scene));
  for (const double length : {1e-6, 1e6})
    for (const double stress : {1e-3, 1e13}) {
      Description scaled = scene;
      scaled.bodies[0].scale = length;
      scaled.bodies[0].material.constants["youngs_modulus"] = stress;
      scaled.bodies[0].material.density = 1e-6 * stress / length;
      scaled.gravity = Vector3(0, -1, 0);
      EXPECT_NEAR(estimate_of(run_all(scaled)), expected, 1e-6 * expected)
          << length << " m, " << stress << " Pa";
    }
}

TEST(DiscretisationError, IsToldInOneLineWithACure) {
  Description scene = cantilever(3, 5, 2, "P1");
  scene.bodies[0].name = "arm";
  const auto line_of = [&scene] {
    const Simulation simulation = run_all(scene);
    const std::vector<std::string> lines = coarseness_texts(
        simulation.world(), discretisation_errors(simulation.world(), simulation.state().positions));
    return lines.empty() ? "" : lines[0];
  };
  EXPECT_THAT(line_of(), ::testing::AllOf(HasSubstr("\"arm\" has an estimated discretisation error of"),
                                          HasSubstr("element = \"P2\" or finer cells")));
  scene.bodies[0].material.constants["poissons_ratio"] = 0.49;
  scene.bodies[0].material.law = "neo_hookean_simo";
  scene.gravity *= 1e-3;
  EXPECT_THAT(line_of(), HasSubstr("element = \"P2P0\""));
  scene = cantilever(3, 5, 2, "Q1");
  EXPECT_THAT(line_of(), HasSubstr("finer cells or tetrahedra"));
  scene.bodies[0] = cantilever(3, 5, 2, "P2").bodies[0];
  EXPECT_EQ(line_of(), "");
  scene.bodies[0] = cantilever(3, 5, 1, "P2").bodies[0];
  EXPECT_THAT(line_of(), HasSubstr("\"body\" is one cell across"));
}

/// A small number by recovered stress alone would be a wrong promise of mixed elements.
TEST(DiscretisationError, OfMixedElementsInStaticsTellsThatRecoveredStressIsWeak) {
  Description scene = cantilever(2, 5, 2, "P2P0");
  scene.bodies[0].material.constants["poissons_ratio"] = 0.49;
  scene.bodies[0].material.law = "neo_hookean_simo";
  const World still(scene);
  const auto lines = [](const World& world, ErrorEstimate estimate) {
    return coarseness_texts(world, {DiscretisationError{.share = 0.002, .estimate = estimate}});
  };
  EXPECT_THAT(lines(still, ErrorEstimate::recovered_stress),
              ::testing::ElementsAre(::testing::AllOf(HasSubstr("0.2 % by recovered stress alone"),
                                                      HasSubstr("too little of P2P0"))));
  EXPECT_TRUE(lines(still, ErrorEstimate::richer_space).empty());
  scene.is_dynamic = true;
  scene.time_step = 0.01;
  scene.end_time = 1;
  EXPECT_TRUE(lines(World(scene), ErrorEstimate::recovered_stress).empty());
  const World simple(cantilever(2, 5, 2, "P2"));
  EXPECT_TRUE(lines(simple, ErrorEstimate::recovered_stress).empty());
}

TEST(DiscretisationError, KnowsBodiesThatAreOneCellAcross) {
  for (const int dim : {2, 3})
    for (const std::string element : {"P1", "P2", "Q1"})
      for (const int layers : {1, 2, 3}) {
        const World world(cantilever(dim, 6, layers, element));
        EXPECT_EQ(is_one_cell_across(world.bodies[0]), layers == 1) << dim << " " << element << " " << layers;
        // At rest there is nothing to tell.
        EXPECT_FALSE(error_by_recovered_stress(world, world.bodies[0], world.rest_positions).has_value());
      }
  EXPECT_EQ(share_text(cannot_tell), "unknown: one cell across");
}

TEST(DiscretisationError, OfBodiesAtRestIsNotKnown) {
  const World world(small_bar(3, false));
  EXPECT_FALSE(discretisation_error(world, world.bodies[0], world.rest_positions).has_value());
}

}  // namespace
}  // namespace resilin::testing
