// Properties that every element of the catalogue has.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

/// A point inside the reference cell.
Vector3 random_point(int dim, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1.0 / dim);
  Vector3 xi = Vector3::Zero();
  for (int i = 0; i < dim; ++i) xi[i] = uniform(random);
  return xi;
}

std::vector<double> shape_values(const ElementInfo& element, const Vector3& xi) {
  std::vector<double> values(static_cast<std::size_t>(element.num_nodes));
  element.shape_values(xi, values);
  return values;
}

std::string described(const ElementInfo& element) {
  return std::string(element.name) + " in " + std::to_string(element.dim) + "D";
}

/// The integral of x^p y^q z^r over the reference cell.
double monomial_integral(CellShape shape, int p, int q, int r) {
  if (!is_simplex(shape)) return 1.0 / ((p + 1) * (q + 1) * (r + 1));
  return std::tgamma(p + 1) * std::tgamma(q + 1) * std::tgamma(r + 1) /
         std::tgamma(p + q + r + dimension(shape) + 1);
}

TEST(EveryElement, ShapeFunctionsSumToOneAndTheirGradientsAreTheirSlopes) {
  std::mt19937 random(1);
  for (const ElementInfo* element : elements()) {
    const auto n = static_cast<std::size_t>(element->num_nodes), dim = static_cast<std::size_t>(element->dim);
    const Vector3 xi = random_point(element->dim, random);
    double sum = 0;
    for (const double value : shape_values(*element, xi)) sum += value;
    EXPECT_NEAR(sum, 1, 1e-15);
    std::vector<double> gradients(n * dim);
    element->shape_gradients(xi, gradients);
    for (std::size_t k = 0; k < dim; ++k) {
      const double step = 1e-6;
      Vector3 plus = xi, minus = xi;
      plus[static_cast<int>(k)] += step;
      minus[static_cast<int>(k)] -= step;
      const auto above = shape_values(*element, plus), below = shape_values(*element, minus);
      for (std::size_t a = 0; a < n; ++a)
        EXPECT_NEAR(gradients[a * dim + k], (above[a] - below[a]) / (2 * step), 1e-8) << described(*element);
    }
  }
}

TEST(EveryElement, ShapeFunctionsAreOneAtTheirNodeAndZeroAtTheOthers) {
  for (const ElementInfo* element : elements()) {
    ASSERT_EQ(element->nodes.size(), static_cast<std::size_t>(element->num_nodes));
    for (std::size_t b = 0; b < element->nodes.size(); ++b) {
      const auto values = shape_values(*element, element->nodes[b]);
      for (std::size_t a = 0; a < values.size(); ++a)
        EXPECT_NEAR(values[a], a == b, 1e-15) << described(*element) << ", node " << b;
    }
  }
}

TEST(EveryElement, ReproducesPolynomialsOfItsDegree) {
  std::mt19937 random(2);
  const auto polynomial = [](int degree, const Vector3& xi) {
    const double line = 0.3 + 0.7 * xi[0] - 0.4 * xi[1] + 0.9 * xi[2];
    return std::pow(line, degree);
  };
  for (const ElementInfo* element : elements()) {
    const Vector3 xi = random_point(element->dim, random);
    const auto values = shape_values(*element, xi);
    double sum = 0;
    for (std::size_t a = 0; a < values.size(); ++a)
      sum += values[a] * polynomial(element->degree, element->nodes[a]);
    EXPECT_NEAR(sum, polynomial(element->degree, xi), 1e-15) << described(*element);
  }
}

TEST(EveryElement, GradientsReproduceAffineFieldsAndVolumesOnADistortedCell) {
  for (const ElementInfo* element : elements()) {
    const int dim = element->dim;
    const auto n = static_cast<std::size_t>(element->num_nodes);
    Matrix<3> A;
    A << 1.2, 0.3, -0.1, 0.2, 0.8, 0.4, -0.3, 0.1, 1.1;
    if (dim == 2) A.row(2) = A.col(2).transpose() = Vector3::UnitZ();
    std::vector<double> positions;
    for (const Vector3& xi : element->nodes) {
      const Vector3 X = A * xi;
      positions.insert(positions.end(), X.data(), X.data() + dim);
    }
    double volume = 0;
    for (const QuadraturePoint& point : element->quadrature("", "quadrature").points) {
      const PointGeometry geometry = point_geometry(*element, point, positions);
      volume += geometry.weight;
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) {  // sum_a X_a dN_a/dX = I
          double sum = 0;
          for (std::size_t a = 0; a < n; ++a)
            sum += positions[a * static_cast<std::size_t>(dim) + static_cast<std::size_t>(i)] *
                   geometry.gradients[a * static_cast<std::size_t>(dim) + static_cast<std::size_t>(k)];
          EXPECT_NEAR(sum, i == k, 1e-14) << described(*element);
        }
    }
    EXPECT_NEAR(volume, A.determinant() * size(element->shape), 1e-15);
  }
}

TEST(QuadratureRules, AreExactToTheirDegreeAndNoFurther) {
  for (const CellShape shape :
       {CellShape::triangle, CellShape::quadrilateral, CellShape::tetrahedron, CellShape::hexahedron}) {
    const int dim = dimension(shape);
    for (const QuadratureRule& rule : quadrature_rules(shape)) {
      const auto error = [&](int p, int q, int r) {
        double sum = 0;
        for (const QuadraturePoint& point : rule.points)
          sum +=
              point.weight * std::pow(point.xi[0], p) * std::pow(point.xi[1], q) * std::pow(point.xi[2], r);
        return std::abs(sum - monomial_integral(shape, p, q, r));
      };
      double worst = 0;
      for (int p = 0; p <= rule.degree; ++p)
        for (int q = 0; q <= rule.degree; ++q)
          for (int r = 0; r <= (dim == 3 ? rule.degree : 0); ++r)
            if (!is_simplex(shape) || p + q + r <= rule.degree) worst = std::max(worst, error(p, q, r));
      EXPECT_LT(worst, 4e-15) << rule.name << " in " << dim << "D";
      EXPECT_GT(error(rule.degree + 1, 0, 0), 1e-12) << rule.name << " in " << dim << "D";
    }
  }
}

TEST(QuadratureRules, WithTooFewPointsAreRefusedByName) {
  const ElementInfo& element = require_element("P2", 3, "element");
  EXPECT_EQ(element.quadrature("exact", "body.quadrature").points.size(), 216u);
  try {
    element.quadrature("1-point", "body.quadrature");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "body.quadrature: expected one of 4-point, 8-point, 27-point, exact for P2, got \"1-point\"");
  }
}

TEST(ElementCatalogue, UnknownElementIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(find_element("P7", 3), nullptr);
  try {
    require_element("P7", 3, "body.element");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "body.element: expected one of P1, P2, P2P0, Q1, Q1P0, got \"P7\"");
  }
}

}  // namespace
}  // namespace resilin
