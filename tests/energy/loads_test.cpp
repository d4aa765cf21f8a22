// Properties that every load and the inertia must have, and one closed form for each.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>

#include "resilin/element/catalog.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/inertia.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/energy/spread_force.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

/// Surface of a tetrahedron (3D) or a triangle (2D), outward: closed, so that a pressure has a potential.
struct Shape {
  int dim;
  VectorX rest;
  CellBlock facets;
};

Shape simplex(int dim) {
  if (dim == 2) {
    VectorX rest(6);
    rest << 0, 0, 1, 0.1, 0.2, 0.9;
    return {2, rest, {CellKind::line, {0, 1, 1, 2, 2, 0}}};
  }
  VectorX rest(12);
  rest << 0, 0, 0, 1, 0.1, 0, 0.2, 0.9, -0.1, 0.1, 0.2, 1.1;
  return {3, rest, {CellKind::triangle, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}}};
}

VectorX moved(const VectorX& rest, double amount) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  VectorX x = rest;
  for (double& value : x) value += uniform(generator);
  return x;
}

/// Surface of one distorted cell of each element, so of every kind of facet.
std::vector<Shape> surfaces() {
  std::vector<Shape> shapes;
  for (const ElementInfo* element : elements()) {
    if (element->has_mean_volume) continue;
    CellBlock cell{cell_kind(*element), {}};
    VectorX rest(element->num_nodes * element->dim);
    for (int a = 0; a < element->num_nodes; ++a) {
      cell.nodes.push_back(a);
      rest.segment(a * element->dim, element->dim) =
          element->nodes[static_cast<std::size_t>(a)].head(element->dim);
    }
    shapes.push_back({element->dim, moved(rest, 0.1), boundary(cell).facets});
  }
  return shapes;
}

Index num_nodes(const Shape& shape) { return static_cast<Index>(shape.rest.size() / shape.dim); }

MassMatrix unit_masses(const Shape& shape) {
  MassMatrix mass;
  mass.dim = shape.dim;
  mass.nodal = VectorX::LinSpaced(num_nodes(shape), 1, 2);
  return mass;
}

std::vector<std::shared_ptr<Energy>> all_loads(const Shape& shape, const MassMatrix& mass) {
  VectorX forces = moved(VectorX::Zero(shape.rest.size()), 1);
  const HandleSpring::Motion motion{.displacement = {0.5, 0.2, 0.1}, .velocity = {0, 0.3, 0}, .start = 0};
  return {
      std::make_shared<DeadLoad>("dead", forces, shape.rest),
      std::make_shared<Pressure>("pressure", shape.dim, shape.facets, 3.0, shape.rest),
      std::make_shared<HandleSpring>("spring", shape.dim, std::vector<Index>{0, 2}, 7.0, motion, shape.rest),
      std::make_shared<MassDistance>(EnergyCategory::inertia, mass, moved(shape.rest, 0.3), 0.04)};
}

const Conditions conditions{.time = 0.5, .load = 0.75};

BlockMatrix empty_matrix(const Shape& shape) {
  BlockPatternBuilder builder(num_nodes(shape));
  std::vector<Index> nodes;
  for (Index i = 0; i < num_nodes(shape); ++i) nodes.push_back(i);
  builder.add_cells(nodes, static_cast<int>(num_nodes(shape)));
  return {shape.dim, std::make_shared<BlockPattern>(builder.build())};
}

TEST(EveryLoad, GradientIsTheSlopeOfTheEnergyAndTheHessianThatOfTheGradient) {
  for (const Shape& shape : surfaces()) {
    const MassMatrix mass = unit_masses(shape);
    for (const auto& load : all_loads(shape, mass)) {
      SCOPED_TRACE(std::string(load->name()) + " on " + std::string(name(shape.facets.kind)));
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
  for (const Shape& shape : surfaces()) {
    const MassMatrix mass = unit_masses(shape);
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
  for (const Shape& shape : surfaces()) {
    const MassMatrix mass = unit_masses(shape);
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
  for (const Shape& shape : surfaces()) {
    const Pressure pressure("p", shape.dim, shape.facets, 3.0, shape.rest);
    VectorX gradient = VectorX::Zero(shape.rest.size());
    pressure.add_gradient(moved(shape.rest, 0.2), {}, gradient);
    VectorX sum = VectorX::Zero(shape.dim);
    for (Index i = 0; i < num_nodes(shape); ++i) sum += gradient.segment(i * shape.dim, shape.dim);
    EXPECT_LT(sum.norm(), 1e-13 * gradient.norm()) << name(shape.facets.kind);
  }
}

/// Also where the force of one facet has no potential: the work is that of the path, to the order of the
/// differences.
TEST(Pressure, HessianOfOneFacetIsTheSymmetricPartOfTheTangent) {
  for (Shape shape : surfaces()) {
    shape.facets.nodes.resize(static_cast<std::size_t>(resilin::num_nodes(shape.facets.kind)));
    const Pressure pressure("p", shape.dim, shape.facets, 3.0, shape.rest);
    BlockMatrix hessian = empty_matrix(shape);
    pressure.add_hessian(shape.rest, {}, Projection::none, hessian);
    const Eigen::Index n = shape.rest.size();
    Eigen::MatrixXd tangent(n, n), symmetric(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double h = 1e-5;
      VectorX below = VectorX::Zero(n), above = VectorX::Zero(n), column;
      pressure.add_gradient(shape.rest - h * VectorX::Unit(n, i), {}, below);
      pressure.add_gradient(shape.rest + h * VectorX::Unit(n, i), {}, above);
      tangent.col(i) = (above - below) / (2 * h);
      multiply(hessian, VectorX::Unit(n, i), column);
      symmetric.col(i) = column;
    }
    EXPECT_LT((0.5 * (tangent + tangent.transpose()) - symmetric).norm(), 1e-9 * tangent.norm())
        << name(shape.facets.kind);
  }
}

/// Flat facets of any kind: the resultant is force times area, its moment that of the centroid.
TEST(Traction, HasTheResultantAndTheMomentOfItsSurface) {
  for (const ElementInfo* element : elements()) {
    if (element->has_mean_volume) continue;
    const int dim = element->dim;
    CellBlock cell{cell_kind(*element), {}};
    VectorX rest(element->num_nodes * dim);
    for (int a = 0; a < element->num_nodes; ++a) {
      cell.nodes.push_back(a);
      rest.segment(a * dim, dim) = 2 * element->nodes[static_cast<std::size_t>(a)].head(dim);
    }
    CellBlock facet = boundary(cell).facets;
    facet.nodes.resize(static_cast<std::size_t>(resilin::num_nodes(facet.kind)));
    VectorX forces = VectorX::Zero(rest.size());
    const Vector3 traction(1, -2, dim == 3 ? 3 : 0);
    LoadedFacets(dim, facet).add_forces(traction, rest, forces);
    Vector3 sum = Vector3::Zero(), centroid = Vector3::Zero();
    Vector3 moment = Vector3::Zero();
    const auto num_corners = static_cast<std::size_t>(resilin::num_corners(facet.kind));
    for (const Index i : std::span(facet.nodes).first(num_corners))
      centroid += node_position(dim, i, rest) / static_cast<double>(num_corners);
    for (const Index i : facet.nodes) {
      sum += node_position(dim, i, forces);
      moment += node_position(dim, i, rest).cross(node_position(dim, i, forces));
    }
    const double area = area_vector(dim, facet.kind, facet.nodes, rest).norm();
    EXPECT_LT((sum - area * traction).norm(), 1e-13 * sum.norm()) << name(facet.kind);
    EXPECT_LT((moment - centroid.cross(sum)).norm(), 1e-13 * sum.norm()) << name(facet.kind);
  }
}

TEST(Traction, OnASecondOrderTriangleIsCarriedByTheMiddlesOfItsEdges) {
  VectorX rest(18);
  rest << 0, 0, 0, 2, 0, 0, 0, 3, 0, 1, 0, 0, 1, 1.5, 0, 0, 1.5, 0;  // area 3
  VectorX forces = VectorX::Zero(18);
  LoadedFacets(3, {CellKind::triangle6, {0, 1, 2, 3, 4, 5}}).add_forces({0, 0, -5}, rest, forces);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(forces[3 * i + 2], i < 3 ? 0 : -5, 1e-14);
}

/// A part of each surface: one facet, and all but one of them.
std::vector<Shape> parts_of_surfaces() {
  std::vector<Shape> parts;
  for (const Shape& shape : surfaces())
    for (const bool is_one : {true, false}) {
      Shape part = shape;
      const auto n = static_cast<std::size_t>(resilin::num_nodes(shape.facets.kind));
      part.facets.nodes.resize(is_one ? n : part.facets.nodes.size() - n);
      parts.push_back(part);
    }
  return parts;
}

/// A force at the centroid, one that attacks elsewhere, and a moment.
std::vector<SpreadForce> spread_forces(const Shape& on) {
  using Kind = SpreadForce::Kind;
  const Vector3 point(0.7, -0.4, on.dim == 3 ? 1.9 : 0);
  return {{Kind::force, on.dim, on.facets},
          {Kind::force, on.dim, on.facets, point},
          {Kind::moment, on.dim, on.facets}};
}

TEST(SpreadForce, IsStaticallyEquivalentToTheForceAndTheMoment) {
  for (const Shape& shape : parts_of_surfaces()) {
    SCOPED_TRACE(name(shape.facets.kind));
    const std::vector<SpreadForce> loads = spread_forces(shape);
    const Vector3 F(1, -2, shape.dim == 3 ? 3 : 0), M(shape.dim == 3 ? 2 : 0, 0, -1);
    const Vector3 center = loads[0].traction(F, shape.rest).center,
                  point(0.7, -0.4, shape.dim == 3 ? 1.9 : 0);
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const Vector3& value = i == 2 ? M : F;
      VectorX forces = VectorX::Zero(shape.rest.size());
      loads[i].add_forces(value, shape.rest, forces);
      Vector3 sum = Vector3::Zero(), moment = Vector3::Zero();
      for (Index node = 0; node < num_nodes(shape); ++node) {
        sum += node_position(shape.dim, node, forces);
        moment += (node_position(shape.dim, node, shape.rest) - center)
                      .cross(node_position(shape.dim, node, forces));
      }
      const Vector3 expected = i == 0   ? Vector3(Vector3::Zero())
                               : i == 1 ? Vector3((point - center).cross(F))
                                        : M;
      EXPECT_LT((sum - (i == 2 ? Vector3(Vector3::Zero()) : F)).norm(), 1e-11) << i;
      EXPECT_LT((moment - expected).norm(), 1e-11) << i;
    }
  }
}

TEST(SpreadForce, WithoutAPointIsTheTractionOfTheForceOverTheArea) {
  for (const Shape& shape : parts_of_surfaces()) {
    VectorX spread = VectorX::Zero(shape.rest.size()), uniform = spread;
    const SpreadForce load(SpreadForce::Kind::force, shape.dim, shape.facets);
    load.add_forces({1, -2, 0}, shape.rest, spread);
    LoadedFacets(shape.dim, shape.facets)
        .add_forces(load.traction({1, -2, 0}, shape.rest).uniform, shape.rest, uniform);
    const double rounding = 1e-12, quadrature = 0.02;  // other points on curved facets
    const CellKind kind = shape.facets.kind;
    const bool is_flat = kind == CellKind::line || kind == CellKind::triangle;
    EXPECT_LT((spread - uniform).norm(), (is_flat ? rounding : quadrature) * uniform.norm()) << name(kind);
  }
}

TEST(SpreadForce, ChangesWithTheRestShapeAsItsDifferences) {
  for (const Shape& shape : parts_of_surfaces())
    for (const SpreadForce& load : spread_forces(shape)) {
      SCOPED_TRACE(name(shape.facets.kind));
      const Vector3 value(0.3, -1, shape.dim == 3 ? 2 : -0.7);
      const VectorX p = moved(VectorX::Zero(shape.rest.size()), 1), w = moved(p, 0.5);
      const double h = 1e-6;
      VectorX before = VectorX::Zero(p.size()), after = before, change = before, slopes = before;
      load.add_forces(value, shape.rest - h * p, before);
      load.add_forces(value, shape.rest + h * p, after);
      load.add_force_change(value, shape.rest, p, change);
      EXPECT_LT(((after - before) / (2 * h) - change).norm(), 1e-7 * (1 + change.norm()));
      load.add_rest_slopes(value, shape.rest, w, slopes);
      EXPECT_NEAR(slopes.dot(p), change.dot(w), 1e-11 * (1 + slopes.norm() * p.norm()));
    }
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
