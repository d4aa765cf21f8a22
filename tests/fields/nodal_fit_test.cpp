#include "resilin/fields/nodal_fit.hpp"

#include <gtest/gtest.h>

#include "every_element.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/facet.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// Bars of linear cells, their vertices moved.
std::vector<World> sample_worlds() {
  std::vector<World> worlds;
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    for (Vector3& X : scene.bodies[0].mesh.vertices)
      X.head(dim) +=
          0.01 * Vector3(std::sin(40 * X.y()), std::sin(30 * X.x()), std::cos(50 * X.x())).head(dim);
    scene.fixes[0].where.tolerance = 0.02;
    worlds.emplace_back(scene);
  }
  return worlds;
}

/// A linear function of the rest position.
double linear(const Vector3& X) { return 2 + X.x() - 3 * X.y() + 0.5 * X.z(); }

/// One cell of an element with straight sides, its corners moved.
Body one_cell(const ElementInfo& element, VectorX& X) {
  Body body;
  std::vector<Index> nodes;
  body.num_nodes = element.num_nodes;
  X.resize(Eigen::Index{element.num_nodes} * element.dim);
  for (Index a = 0; a < element.num_nodes; ++a) {
    const Vector3 xi = element.nodes[static_cast<std::size_t>(a)];
    Vector3 moved = xi + Vector3(0.1 * xi.y(), -0.2 * xi.x(), 0.1 * xi.y() * (element.dim - 2));
    if (!is_simplex(element.shape)) moved += 0.15 * xi.x() * xi.y() * Vector3(1, 1, 0);
    X.segment(Eigen::Index{a} * element.dim, element.dim) = moved.head(element.dim);
    nodes.push_back(a);
  }
  body.cells = std::move(nodes);
  const LawInfo& law = require_law("neo_hookean", "law");
  const auto constants = law.constants_from(hooke_from_young_poisson(1e5, 0.3));
  Domain domain;
  domain.cells = body.cells;
  domain.energy =
      std::make_shared<const ElasticEnergy>(element.dim, element.name, body.cells, X, law, constants);
  body.domains = Domains({std::move(domain)});
  return body;
}

/// Those whose values are not constant in each cell, of which more is said below.
std::vector<const ElementInfo*> elements_with_slopes() {
  std::vector<const ElementInfo*> all = elements();
  std::erase_if(all, [](const ElementInfo* e) { return e->quadrature("", "quadrature").points.size() == 1; });
  return all;
}

struct NodalFitOnEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, NodalFitOnEveryElement, ::testing::ValuesIn(elements_with_slopes()),
                         name_of_element);

TEST_P(NodalFitOnEveryElement, MeetsALinearField) {
  VectorX X;
  const Body body = one_cell(element, X);
  const auto n = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> values, N(n);
  for (const QuadraturePoint& point : body.domains.front().energy->quadrature().points) {
    element.shape_values(point.xi, N);
    Vector3 place = Vector3::Zero();
    for (std::size_t a = 0; a < n; ++a) place += N[a] * node_position(element.dim, static_cast<Index>(a), X);
    values.push_back(linear(place));
  }
  const std::vector<double> fitted = NodalFit(body).fit(values, 1);
  for (Index a = 0; a < body.num_nodes; ++a)
    EXPECT_NEAR(fitted[static_cast<std::size_t>(a)], linear(node_position(element.dim, a, X)),
                1e-11);  // solved to 1e-13
}

/// The projection by hand, with a dense matrix.
TEST(NodalFit, OfConstantCellsIsTheirProjection) {
  for (const World& world : sample_worlds()) {
    const Body& body = world.bodies[0];
    const auto n = static_cast<std::size_t>(num_nodes(body.cell_kind));
    const std::vector<double> volumes = body.domains.front().energy->rest_volumes();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(body.num_nodes, body.num_nodes);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(body.num_nodes, 4);
    std::vector<double> values;
    for (std::size_t cell = 0; cell < volumes.size(); ++cell) {
      for (int k = 0; k < 4; ++k) values.push_back(std::sin(static_cast<double>(cell) + k));
      for (std::size_t i = 0; i < n; ++i) {
        const Index row = body.cells[cell * n + i];
        for (int k = 0; k < 4; ++k)
          b(row, k) +=
              volumes[cell] / static_cast<double>(n) * values[4 * cell + static_cast<std::size_t>(k)];
        for (std::size_t j = 0; j < n; ++j)
          M(row, body.cells[cell * n + j]) +=
              volumes[cell] * (i == j ? 2 : 1) / static_cast<double>(n * (n + 1));
      }
    }
    const Eigen::MatrixXd expected = M.ldlt().solve(b);
    const std::vector<double> fitted = NodalFit(body).fit(values, 4);
    for (Index i = 0; i < body.num_nodes; ++i)
      for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(fitted[static_cast<std::size_t>(4 * i + k)], expected(i, k), 1e-11);  // solved to 1e-13
  }
}

TEST(NodalFit, OfSomethingThatIsNoNumberIsNone) {
  const World world = sample_worlds()[0];
  std::vector<double> values(static_cast<std::size_t>(world.bodies[0].num_cells()), 1.0);
  values[2] = std::numeric_limits<double>::infinity();
  for (const double value : NodalFit(world.bodies[0]).fit(values, 1)) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace resilin::testing
