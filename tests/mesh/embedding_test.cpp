#include "resilin/mesh/embedding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "element_mesh.hpp"
#include "every_element.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/mesh/cell_surface.hpp"

namespace resilin::testing {
namespace {

/// Points of the box from -margin to 1 + margin, in 2D of its plane.
std::vector<Vector3> sample_points(int dim, double margin, int count = 300) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-margin, 1 + margin);
  std::vector<Vector3> points;
  for (int i = 0; i < count; ++i) {
    Vector3 X(uniform(random), uniform(random), uniform(random));
    if (dim == 2) X.z() = 0;
    points.push_back(X);
  }
  return points;
}

using Map = std::function<Vector3(const Vector3&)>;

VectorX mapped_nodes(const ElementMesh& mesh, const Map& map) {
  VectorX x(mesh.X.size());
  for (Eigen::Index i = 0; i < x.size(); i += mesh.dim) {
    Vector3 X = Vector3::Zero();
    X.head(mesh.dim) = mesh.X.segment(i, mesh.dim);
    x.segment(i, mesh.dim) = map(X).head(mesh.dim);
  }
  return x;
}

/// The largest distance between where the embedding puts the points and where the map does.
double error_of(const Embedding& embedding, const ElementMesh& mesh, const std::vector<Vector3>& points,
                const Map& map) {
  std::vector<double> places(3 * points.size());
  embedding.apply(mapped_nodes(mesh, map), places);
  double error = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
    error = std::max(error, (Eigen::Map<const Vector3>(places.data() + 3 * p) - map(points[p])).norm());
  return error;
}

Matrix<3> sample_matrix(int dim) {
  Matrix<3> A;
  A << 1.3, 0.4, -0.2, -0.5, 0.8, 0.3, 0.1, -0.7, 1.6;
  if (dim == 2) A.col(2).setZero(), A.row(2).setZero();
  return A;
}

Map affine_map(int dim) {
  Vector3 b(3, -2, dim == 3 ? 0.5 : 0.0);
  return [A = sample_matrix(dim), b](const Vector3& X) -> Vector3 { return A * X + b; };
}

Map quadratic_map(int dim) {
  return [A = sample_matrix(dim), dim](const Vector3& X) -> Vector3 {
    const double x = X.x(), y = X.y(), z = dim == 3 ? X.z() : 0;
    Vector3 bent = A * X + Vector3(x * y - z * z, 0.5 * x * x + y * z, dim == 3 ? x * z + y * y : 0);
    return bent;
  };
}

struct EmbeddingInEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EmbeddingInEveryElement, ::testing::ValuesIn(elements()),
                         name_of_element);

TEST_P(EmbeddingInEveryElement, ReproducesAffineMapsInsideAndOutside) {
  for (const double curvature : {0.0, 0.1}) {
    const ElementMesh mesh(element, 3, curvature);
    const std::vector<Vector3> points = sample_points(mesh.dim, 0.8);
    for (const bool is_smooth : {false, true}) {
      const Embedding embedding(element, mesh.cells, mesh.X, points, is_smooth);
      // Weights reach about 10 a cell's width outside, and the inverse of a curved map has 1e-12 of a cell.
      EXPECT_LT(error_of(embedding, mesh, points, affine_map(mesh.dim)), 1e-11) << curvature;
      for (Index p = 0; p < embedding.num_points(); ++p) {
        double sum = 0;
        for (const double weight : embedding.weights(p)) sum += weight;
        ASSERT_NEAR(sum, 1, 1e-13);
      }
    }
  }
}

TEST(Embedding, InStraightQuadraticCellsReproducesQuadraticMaps) {
  for (const int dim : {2, 3}) {
    const ElementInfo& element = *find_element("P2", dim);
    const ElementMesh mesh(element, 3);
    const std::vector<Vector3> points = sample_points(dim, 0);
    const Embedding embedding(element, mesh.cells, mesh.X, points);
    EXPECT_LT(error_of(embedding, mesh, points, quadratic_map(dim)), 1e-13);
  }
}

TEST_P(EmbeddingInEveryElement, FollowsTheShapeFunctionsOfCurvedCells) {
  const ElementMesh mesh(element, 3, 0.1);
  const CellMap cells(element, mesh.cells, mesh.X);
  const VectorX moved = mesh.moved(0.05);
  const CellMap moved_cells(element, mesh.cells, moved);
  std::vector<Vector3> points, expected;
  for (Index cell = 0; cell < cells.num_cells(); ++cell) {
    const Vector3 xi = element.dim == 3 ? Vector3(0.2, 0.15, 0.4) : Vector3(0.2, 0.15, 0);
    points.push_back(cells.place(cell, xi));
    expected.push_back(moved_cells.place(cell, xi));
  }
  const Embedding embedding(element, mesh.cells, mesh.X, points);
  EXPECT_EQ(embedding.outside().count, 0);
  std::vector<double> places(3 * points.size());
  embedding.apply(moved, places);
  for (std::size_t p = 0; p < points.size(); ++p)
    ASSERT_LT((Eigen::Map<const Vector3>(places.data() + 3 * p) - expected[p]).norm(), 1e-11);
}

TEST(Embedding, ChoosesTheCellInWhichAPointIsDeepest) {
  const ElementInfo& element = *find_element("P1", 3);
  const ElementMesh mesh(element, 3);
  std::vector<Vector3> points = sample_points(3, 0, 100);
  points.emplace_back(mesh.X.head<3>());                                 // a corner of the body
  points.emplace_back(0.5 * (mesh.X.head<3>() + mesh.X.segment<3>(3)));  // the middle of an edge
  const CellMap cells(element, mesh.cells, mesh.X);
  const Embedding embedding(element, mesh.cells, mesh.X, points);
  for (Index p = 0; p < embedding.num_points(); ++p) {
    const Vector3& X = points[static_cast<std::size_t>(p)];
    double deepest = -1;
    for (Index cell = 0; cell < cells.num_cells(); ++cell)
      deepest = std::max(deepest, cells.depth(*cells.invert(cell, X)));
    EXPECT_GE(cells.depth(*cells.invert(embedding.cell(p), X)), deepest - 1e-12);
    EXPECT_GE(std::ranges::min(embedding.weights(p)), -1e-9);
  }
}

/// A sliver near the point has the larger smallest barycentric coordinate, though it is farther off.
TEST(Embedding, TakesOutsideTheCellThatIsNearestInSpace) {
  VectorX X(24);
  X << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1,           // a good cell ...
      -30, -30, 2, 30, -30, 2, 0, 40, 2, 0, 0, 100;  // ... and a huge one above it
  const std::vector<Index> cells = {0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<Vector3> points = {{0.1, 0.1, 1.3}, {0.1, 0.1, 1.7}, {-0.5, 0.2, 0.2}};
  const ElementInfo& element = *find_element("P1", 3);
  const Embedding embedding(element, cells, X, points);
  EXPECT_EQ(embedding.cell(0), 0);
  EXPECT_EQ(embedding.cell(1), 1);
  EXPECT_EQ(embedding.cell(2), 0);
  const CellMap map(element, cells, X);
  const auto depth = [&](Index cell) { return map.depth(*map.invert(cell, points[0])); };
  EXPECT_GT(depth(1), depth(0));  // therefore barycentric coordinates are no distance
  EXPECT_EQ(embedding.outside().count, 3);
  EXPECT_EQ(embedding.outside().point, 2);
  EXPECT_NEAR(embedding.outside().distance, 0.5, 1e-12);
  EXPECT_NEAR(embedding.outside().relative_to_edge, 0.5 / ((3 + 3 * std::sqrt(2.0)) / 6), 1e-12);
}

/// Places on a fine grid of every cell are no nearer.
TEST_P(EmbeddingInEveryElement, FindsTheNearestPlaceOfTheSurface) {
  const ElementMesh mesh(element, 2, 0.1);
  const CellMap cells(element, mesh.cells, mesh.X);
  std::vector<Vector3> on_cells;
  constexpr int n = 12;
  for (Index cell = 0; cell < cells.num_cells(); ++cell)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        for (int k = 0; k <= (element.dim == 3 ? n : 0); ++k) {
          const Vector3 xi = Vector3(i, j, k) / n;
          if (cells.depth(xi) >= -1e-12) on_cells.push_back(cells.place(cell, xi));
        }
  std::vector<Vector3> points;
  for (const Vector3& X : sample_points(element.dim, 1.5, 60))
    if (((X.head(element.dim).array() < -0.1) || (X.head(element.dim).array() > 1.1)).any())
      points.push_back(X);
  const CellSurface surface(cells);
  for (const Vector3& X : points) {
    const CellSurface::Nearest nearest = surface.nearest(X);
    EXPECT_NEAR((cells.place(nearest.cell, nearest.xi) - X).norm(), nearest.distance, 1e-14);
    EXPECT_GE(cells.depth(nearest.xi), -1e-12);
    double least = std::numeric_limits<double>::infinity();
    for (const Vector3& place : on_cells) least = std::min(least, (place - X).norm());
    EXPECT_LT(nearest.distance, least + 1e-12);
  }
  const Embedding embedding(element, mesh.cells, mesh.X, points);
  EXPECT_EQ(embedding.outside().count, embedding.num_points());
  EXPECT_EQ(embedding.cell(0), surface.nearest(points[0]).cell);
}

/// Around the inner nodes of a regular grid the cells are symmetric, so that F_a is exact for quadratic maps.
TEST(Embedding, SmoothReproducesQuadraticMapsWhereTheNodesGradientsAreExact) {
  for (const std::string name : {"P1", "Q1"})
    for (const int dim : {2, 3}) {
      const ElementInfo& element = *find_element(name, dim);
      ElementMesh mesh(element, 5);
      mesh.X = (5 * mesh.X.array()).round() / 5;  // without the random shifts
      std::vector<Vector3> points;
      for (const Vector3& X : sample_points(dim, 0))
        points.push_back((0.2 + 0.6 * X.array()).matrix());  // in cells without nodes on the boundary
      if (dim == 2)
        for (Vector3& X : points) X.z() = 0;
      const Map map = quadratic_map(dim);
      EXPECT_LT(error_of(Embedding(element, mesh.cells, mesh.X, points, true), mesh, points, map), 1e-14)
          << name << " in " << dim << "D";
      EXPECT_GT(error_of(Embedding(element, mesh.cells, mesh.X, points), mesh, points, map), 1e-3);
    }
}

TEST(Embedding, SmoothChangesNothingForQuadraticCells) {
  const ElementInfo& element = *find_element("P2", 3);
  const ElementMesh mesh(element, 2);
  const std::vector<Vector3> points = sample_points(3, 0.1);
  std::vector<double> smooth(3 * points.size()), plain(3 * points.size());
  const Embedding embedding(element, mesh.cells, mesh.X, points, true);
  EXPECT_FALSE(embedding.is_smooth());
  embedding.apply(mesh.moved(0.05), smooth);
  Embedding(element, mesh.cells, mesh.X, points).apply(mesh.moved(0.05), plain);
  EXPECT_EQ(smooth, plain);
}

TEST(Embedding, HasTheSameBitsOnAnyNumberOfThreads) {
  const ElementInfo& element = *find_element("P1", 3);
  const ElementMesh mesh(element, 4);
  const std::vector<Vector3> points = sample_points(3, 0.2, 5000);
  const VectorX x = mesh.moved(0.02);
  const int threads = num_threads();
  std::vector<std::vector<float>> results;
  for (const int count : {1, 2, 3}) {
    set_num_threads(count);
    results.emplace_back(3 * points.size());
    Embedding(element, mesh.cells, mesh.X, points, true).apply(x, results.back());
  }
  set_num_threads(threads);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Embedding, InFloatAgreesWithDoubleAndWritesNothingBesides) {
  const ElementInfo& element = *find_element("P1", 2);
  const ElementMesh mesh(element, 3);
  for (const int count : {1, 2, 299}) {
    const std::vector<Vector3> points = sample_points(2, 0.1, count);
    const Embedding embedding(element, mesh.cells, mesh.X, points);
    std::vector<float> floats(3 * points.size() + 1, 7);
    std::vector<double> doubles(3 * points.size());
    const VectorX x = mesh.moved(0.02);
    embedding.apply(x, std::span(floats).first(3 * points.size()));
    embedding.apply(x, doubles);
    for (std::size_t i = 0; i < doubles.size(); ++i) EXPECT_NEAR(floats[i], doubles[i], 1e-6);
    EXPECT_EQ(floats.back(), 7);
  }
}

TEST(Embedding, CarriesNumbersOfTheNodes) {
  const ElementInfo& element = *find_element("P1", 3);
  const ElementMesh mesh(element, 3);
  const std::vector<Vector3> points = sample_points(3, 0.1);
  std::vector<double> values;
  for (Eigen::Index i = 0; i < mesh.X.size(); i += 3) values.push_back(2 * mesh.X[i] - mesh.X[i + 2] + 1);
  std::vector<float> carried(points.size());
  Embedding(element, mesh.cells, mesh.X, points).interpolate(values, carried);
  for (std::size_t p = 0; p < points.size(); ++p)
    EXPECT_NEAR(carried[p], 2 * points[p].x() - points[p].z() + 1, 1e-6);
}

TEST(Embedding, RefusesPointsThatAreNowhere) {
  const ElementInfo& element = *find_element("P1", 3);
  const ElementMesh mesh(element, 2);
  const std::vector<Vector3> points = {{0, 0, 0}, {0, std::nan(""), 0}};
  EXPECT_THROW(Embedding(element, mesh.cells, mesh.X, points), InputError);
  EXPECT_THROW(Embedding(element, {}, mesh.X, std::vector<Vector3>(1, Vector3::Zero())), InputError);
  EXPECT_EQ(Embedding(element, mesh.cells, mesh.X, {}).num_points(), 0);
}

}  // namespace
}  // namespace resilin::testing
