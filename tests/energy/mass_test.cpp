// Masses and body forces of every element, against closed forms of the unit cell.

#include "resilin/energy/mass.hpp"

#include <gtest/gtest.h>

#include <random>

#include "every_element.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/dead_load.hpp"

namespace resilin {
namespace {

/// One cell; straight: the reference cell sheared and stretched, else with its nodes moved about.
struct Cell {
  const ElementInfo& element;
  std::vector<Index> nodes;
  VectorX X;
};

Cell cell_of(const ElementInfo& element, double distortion) {
  Cell cell{element, {}, VectorX(element.num_nodes * element.dim)};
  Eigen::Matrix3d A;
  A << 2, 0.3, 0.1, 0, 1.5, 0.2, 0, 0, 0.8;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-distortion, distortion);
  for (int a = 0; a < element.num_nodes; ++a) {
    cell.nodes.push_back(a);
    Vector3 X = A * element.nodes[static_cast<std::size_t>(a)];
    for (double& value : X) value += uniform(generator);
    cell.X.segment(a * element.dim, element.dim) = X.head(element.dim);
  }
  return cell;
}

MassMatrix mass_of(const Cell& cell, double density, bool is_consistent) {
  MassMatrix mass;
  mass.dim = cell.element.dim;
  mass.nodal = VectorX::Zero(cell.element.num_nodes);
  if (is_consistent) {
    BlockPatternBuilder builder(cell.element.num_nodes);
    builder.add_cells(cell.nodes, cell.element.num_nodes);
    mass.pattern = std::make_shared<const BlockPattern>(builder.build());
    mass.slots.assign(static_cast<std::size_t>(mass.pattern->num_slots()), 0.0);
  }
  add_cell_masses(mass, cell.element, cell.nodes, cell.X, density, is_consistent);
  return mass;
}

double volume_of(const Cell& cell) {
  VectorX forces = VectorX::Zero(cell.X.size());
  add_body_force(cell.element, cell.nodes, cell.X, Vector3::UnitX(), forces);
  return forces.sum();
}

struct MassOfEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, MassOfEveryElement, ::testing::ValuesIn(elements()), name_of_element);

/// Kinetic energy of v = c + G X, for which lumped masses of degree 1 need not be exact, consistent ones are.
TEST_P(MassOfEveryElement, IfConsistentKnowsTheEnergyOfALinearVelocity) {
  for (const double distortion : {0.0, 0.08}) {
    const Cell cell = cell_of(element, distortion);
    const MassMatrix mass = mass_of(cell, 3, true);
    // integral X^2 dV by a rule of much higher degree
    double expected = 0;
    for (const QuadraturePoint& point : rule_of_degree(element.shape, 11).points) {
      std::vector<double> values(static_cast<std::size_t>(element.num_nodes));
      element.shape_values(point.xi, values);
      double X = 0;
      for (int a = 0; a < element.num_nodes; ++a)
        X += values[static_cast<std::size_t>(a)] * cell.X[a * element.dim];
      expected +=
          3 * X * X *
          point_geometry(element, point, std::span(cell.X.data(), static_cast<std::size_t>(cell.X.size())))
              .weight;
    }
    VectorX velocity = VectorX::Zero(cell.X.size()), momentum;
    for (int a = 0; a < element.num_nodes; ++a) velocity[a * element.dim] = cell.X[a * element.dim];
    mass.multiply(velocity, momentum);
    EXPECT_NEAR(velocity.dot(momentum), expected, 1e-13 * expected) << distortion;
  }
}

/// Consistent masses have negative entries: what rounding may do to a sum of them is told by their sizes.
TEST_P(MassOfEveryElement, HasASizeThatNoSumOfItsEntriesExceeds) {
  for (const bool is_consistent : {false, true}) {
    const Cell cell = cell_of(element, 0.08);
    const MassMatrix mass = mass_of(cell, 3, is_consistent);
    VectorX signs = VectorX::Ones(cell.X.size()), momentum, largest;
    mass.multiply_magnitude(signs, largest);
    for (unsigned seed = 0; seed < 8; ++seed) {
      for (Eigen::Index i = 0; i < signs.size(); ++i) signs[i] = std::sin(i * i + seed) > 0 ? 1 : -1;
      mass.multiply(signs, momentum);
      EXPECT_LE((momentum.cwiseAbs() - largest).maxCoeff(), 1e-15 * mass.total());
    }
    EXPECT_GE(largest.minCoeff(), is_consistent ? mass.nodal.minCoeff() / 100 : mass.nodal.minCoeff());
  }
}

TEST_P(MassOfEveryElement, IfLumpedIsPositiveAndSumsToTheMass) {
  for (const double distortion : {0.0, 0.08}) {
    const Cell cell = cell_of(element, distortion);
    const MassMatrix lumped = mass_of(cell, 3, false), consistent = mass_of(cell, 3, true);
    EXPECT_GT(lumped.nodal.minCoeff(), 0);
    EXPECT_NEAR(lumped.total(), 3 * volume_of(cell), 1e-13 * lumped.total());
    EXPECT_EQ(lumped.nodal, consistent.nodal);
  }
}

/// m_ab of the unit cells; Hinton, Rock & Zienkiewicz's shares of the quadratic ones (corner, edge): triangle
/// 1/19 (3/57), 16/57; tetrahedron 1/36, 4/27.
TEST(LumpedMass, IsTheScaledDiagonal) {
  const auto shares = [](const char* name, int dim) {
    const Cell cell = cell_of(*find_element(name, dim), 0);
    const MassMatrix mass = mass_of(cell, 1, false);
    return VectorX(mass.nodal / mass.total());
  };
  for (int a = 0; a < 6; ++a) EXPECT_NEAR(shares("P2", 2)[a], a < 3 ? 3.0 / 57 : 16.0 / 57, 1e-14);
  for (int a = 0; a < 10; ++a) EXPECT_NEAR(shares("P2", 3)[a], a < 4 ? 1.0 / 36 : 4.0 / 27, 1e-14);
  for (int a = 0; a < 4; ++a) EXPECT_NEAR(shares("P1", 3)[a], 0.25, 1e-15);
  for (int a = 0; a < 8; ++a) EXPECT_NEAR(shares("Q1", 3)[a], 0.125, 1e-15);
}

TEST(BodyForce, OfQuadraticCellsPushesCornersTheOtherWay) {
  const auto shares = [](int dim) {
    const Cell cell = cell_of(*find_element("P2", dim), 0);
    VectorX forces = VectorX::Zero(cell.X.size());
    add_body_force(cell.element, cell.nodes, cell.X, 5 * Vector3::UnitY(), forces);
    VectorX per_node(cell.element.num_nodes);
    for (int a = 0; a < cell.element.num_nodes; ++a) per_node[a] = forces[a * dim + 1];
    return VectorX(per_node / per_node.sum());
  };
  for (int a = 0; a < 6; ++a) EXPECT_NEAR(shares(2)[a], a < 3 ? 0 : 1.0 / 3, 1e-14);
  for (int a = 0; a < 10; ++a) EXPECT_NEAR(shares(3)[a], a < 4 ? -0.05 : 0.2, 1e-14);
}

}  // namespace
}  // namespace resilin
