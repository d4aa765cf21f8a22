// Properties that every load and the inertia must have, and one closed form for each.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>

#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/inertia.hpp"
#include "resilin/energy/pressure.hpp"

namespace resilin {
namespace {

/// Surface of a tetrahedron (3D) or a triangle (2D), outward: closed, so that a pressure has a potential.
struct Shape {
  int dim;
  VectorX rest;
  std::vector<LoadedFacet> facets;
};

Shape simplex(int dim) {
  if (dim == 2) {
    VectorX rest(6);
    rest << 0, 0, 1, 0.1, 0.2, 0.9;
    return {2, rest, {{{0, 1, -1}}, {{1, 2, -1}}, {{2, 0, -1}}}};
  }
  VectorX rest(12);
  rest << 0, 0, 0, 1, 0.1, 0, 0.2, 0.9, -0.1, 0.1, 0.2, 1.1;
  return {3, rest, {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}}};
}

VectorX moved(const VectorX& rest, double amount) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  VectorX x = rest;
  for (double& value : x) value += uniform(generator);
  return x;
}

MassMatrix unit_masses(int dim) {
  MassMatrix mass;
  mass.dim = dim;
  mass.nodal = VectorX::LinSpaced(dim + 1, 1, 2);
  return mass;
}

std::vector<std::shared_ptr<Energy>> all_loads(const Shape& shape, const MassMatrix& mass) {
  VectorX forces = moved(VectorX::Zero(shape.rest.size()), 1);
  const HandleSpring::Motion motion{.displacement = {0.5, 0.2, 0.1}, .velocity = {0, 0.3, 0}, .start = 0};
  return {
      std::make_shared<DeadLoad>("dead", forces, shape.rest),
      std::make_shared<Pressure>("pressure", shape.dim, shape.facets, 3.0, shape.rest),
      std::make_shared<HandleSpring>("spring", shape.dim, std::vector<Index>{0, 2}, 7.0, motion, shape.rest),
      std::make_shared<Inertia>(mass, moved(shape.rest, 0.3), 0.04)};
}

const Conditions conditions{.time = 0.5, .load = 0.75};

BlockMatrix empty_matrix(const Shape& shape) {
  BlockPatternBuilder builder(static_cast<Index>(shape.dim + 1));
  std::vector<Index> nodes;
  for (Index i = 0; i <= shape.dim; ++i) nodes.push_back(i);
  builder.add_cells(nodes, shape.dim + 1);
  return {shape.dim, std::make_shared<BlockPattern>(builder.build())};
}

TEST(EveryLoad, GradientIsTheSlopeOfTheEnergyAndTheHessianThatOfTheGradient) {
  for (const int dim : {2, 3}) {
    const Shape shape = simplex(dim);
    const MassMatrix mass = unit_masses(dim);
    for (const auto& load : all_loads(shape, mass)) {
      SCOPED_TRACE(std::string(load->name()) + " in " + std::to_string(dim) + "D");
      const VectorX x = moved(shape.rest, 0.2);
      const VectorX p = moved(VectorX::Zero(x.size()), 1);
      VectorX gradient = VectorX::Zero(x.size());
      load->add_gradient(x, conditions, gradient);
      BlockMatrix hessian = empty_matrix(shape);
      load->add_hessian(x, conditions, Projection::none, hessian);
      VectorX product;
      multiply(hessian, p, product);
      const double h = 1e-5;  // central differences: error h^2, round-off eps / h
      const double slope = load->difference(x - h * p, x + h * p, conditions) / (2 * h);
      EXPECT_NEAR(slope, gradient.dot(p), 1e-8 * (gradient.norm() * p.norm() + 1));
      VectorX before = VectorX::Zero(x.size());
      VectorX after = VectorX::Zero(x.size());
      load->add_gradient(x - h * p, conditions, before);
      load->add_gradient(x + h * p, conditions, after);
      EXPECT_LT(((after - before) / (2 * h) - product).norm(), 1e-7 * (product.norm() + 1));
    }
  }
}

TEST(EveryLoad, DifferenceEqualsTheDifferenceOfValues) {
  for (const int dim : {2, 3}) {
    const Shape shape = simplex(dim);
    const MassMatrix mass = unit_masses(dim);
    for (const auto& load : all_loads(shape, mass)) {
      const VectorX from = moved(shape.rest, 0.1);
      const VectorX to = moved(shape.rest, 0.3);
      const double expected = load->value(to, conditions) - load->value(from, conditions);
      EXPECT_NEAR(load->difference(from, to, conditions), expected, 1e-12 * (1 + std::abs(expected)))
          << load->name();
    }
  }
}

TEST(EveryLoad, KeepsItsGradientBelowItsMagnitude) {
  for (const int dim : {2, 3}) {
    const Shape shape = simplex(dim);
    const MassMatrix mass = unit_masses(dim);
    for (const auto& load : all_loads(shape, mass)) {
      const VectorX x = moved(shape.rest, 0.2);
      VectorX gradient = VectorX::Zero(x.size());
      VectorX magnitude = VectorX::Zero(x.size());
      load->add_gradient(x, conditions, gradient);
      load->add_gradient_magnitude(x, conditions, magnitude);
      EXPECT_TRUE((gradient.cwiseAbs().array() <= magnitude.array() * (1 + 1e-12)).all()) << load->name();
      EXPECT_GT(magnitude.norm(), 0) << load->name();
    }
  }
}

TEST(Pressure, EnergyIsPressureTimesVolumeChange) {
  const Shape shape = simplex(3);
  const Pressure pressure("p", 3, shape.facets, 3.0, shape.rest);
  const VectorX doubled = 2 * shape.rest;  // eight times the volume
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = shape.rest.segment(3 * (k + 1), 3) - shape.rest.head(3);
  const double volume = edges.determinant() / 6;
  EXPECT_NEAR(pressure.value(doubled, {}), 3.0 * 7 * volume, 1e-12);
}

TEST(Pressure, OnAClosedSurfaceHasNoResultant) {
  const Shape shape = simplex(3);
  const Pressure pressure("p", 3, shape.facets, 3.0, shape.rest);
  VectorX gradient = VectorX::Zero(12);
  pressure.add_gradient(moved(shape.rest, 0.2), {}, gradient);
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < 4; ++i) sum += gradient.segment<3>(3 * i);
  EXPECT_LT(sum.norm(), 1e-14);
}

TEST(Traction, SharesForceTimesAreaAmongTheFacetsNodes) {
  VectorX rest(9);
  rest << 0, 0, 0, 2, 0, 0, 0, 3, 0;  // area 3
  VectorX forces = VectorX::Zero(9);
  const std::vector<LoadedFacet> facets = {{{0, 1, 2}}};
  add_traction(3, facets, rest, {0, 0, -5}, forces);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(forces[3 * i + 2], -5, 1e-14);
}

TEST(DeadLoad, ActsOnlyInItsTime) {
  const DeadLoad load("f", VectorX::Ones(3), VectorX::Zero(3), {.from = 0.1, .until = 0.2});
  const auto acts = [&](double time) { return load.value(VectorX::Ones(3), {.time = time, .load = 1}) != 0; };
  EXPECT_FALSE(acts(0.1));
  EXPECT_TRUE(acts(0.15));
  EXPECT_TRUE(acts(0.2));
  EXPECT_FALSE(acts(0.21));
}

}  // namespace
}  // namespace resilin
