// Properties that every element of the catalogue has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "every_element.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
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

/// The integral of x^p y^q z^r over the reference cell.
double monomial_integral(CellShape shape, int p, int q, int r) {
  if (!is_simplex(shape)) return 1.0 / ((p + 1) * (q + 1) * (r + 1));
  return std::tgamma(p + 1) * std::tgamma(q + 1) * std::tgamma(r + 1) /
         std::tgamma(p + q + r + dimension(shape) + 1);
}

struct EveryElement : OnEveryElement {
  const std::size_t num_nodes = static_cast<std::size_t>(element.num_nodes);
  const std::size_t dim = static_cast<std::size_t>(element.dim);
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElement, ::testing::ValuesIn(elements()), name_of_element);

TEST_P(EveryElement, IsFoundByItsNameAndDimension) {
  EXPECT_EQ(find_element(element.name, element.dim), &element);
  EXPECT_EQ(&require_element(element.name, element.dim, "test"), &element);
  EXPECT_FALSE(element.text.empty());
}

TEST_P(EveryElement, ShapeFunctionsSumToOneAndTheirGradientsAreTheirSlopes) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Vector3 xi = random_point(element.dim, random);
    double sum = 0;
    for (const double value : shape_values(element, xi)) sum += value;
    EXPECT_NEAR(sum, 1, 2e-15);
    std::vector<double> gradients(num_nodes * dim);
    element.shape_gradients(xi, gradients);
    for (std::size_t k = 0; k < dim; ++k) {
      const double step = 1e-6;
      Vector3 plus = xi, minus = xi;
      plus[static_cast<int>(k)] += step;
      minus[static_cast<int>(k)] -= step;
      const auto above = shape_values(element, plus), below = shape_values(element, minus);
      for (std::size_t a = 0; a < num_nodes; ++a)
        EXPECT_NEAR(gradients[a * dim + k], (above[a] - below[a]) / (2 * step), 1e-8);
    }
  }
}

TEST_P(EveryElement, ShapeFunctionsAreOneAtTheirNodeAndZeroAtTheOthers) {
  ASSERT_EQ(element.nodes.size(), num_nodes);
  for (std::size_t b = 0; b < num_nodes; ++b) {
    const auto values = shape_values(element, element.nodes[b]);
    for (std::size_t a = 0; a < num_nodes; ++a) EXPECT_NEAR(values[a], a == b, 1e-15) << "node " << b;
  }
}

TEST_P(EveryElement, ReproducesPolynomialsOfItsDegree) {
  std::mt19937 random(2);
  const auto polynomial = [this](const Vector3& xi) {
    return std::pow(0.3 + 0.7 * xi[0] - 0.4 * xi[1] + 0.9 * xi[2], element.degree);
  };
  for (int trial = 0; trial < 10; ++trial) {
    const Vector3 xi = random_point(element.dim, random);
    const auto values = shape_values(element, xi);
    double sum = 0;
    for (std::size_t a = 0; a < num_nodes; ++a) sum += values[a] * polynomial(element.nodes[a]);
    EXPECT_NEAR(sum, polynomial(xi), 2e-15);
  }
}

TEST_P(EveryElement, GradientsReproduceAffineFieldsAndVolumesOnADistortedCell) {
  Matrix<3> A;
  A << 1.2, 0.3, -0.1, 0.2, 0.8, 0.4, -0.3, 0.1, 1.1;
  if (dim == 2) A.row(2) = A.col(2).transpose() = Vector3::UnitZ();
  std::vector<double> positions;
  for (const Vector3& xi : element.nodes) {
    const Vector3 X = A * xi;
    positions.insert(positions.end(), X.data(), X.data() + dim);
  }
  for (const std::string& rule : element.quadrature_names()) {
    double volume = 0;
    for (const QuadraturePoint& point : element.quadrature(rule, "quadrature").points) {
      const PointGeometry geometry = point_geometry(element, point, positions);
      volume += geometry.weight;
      for (std::size_t i = 0; i < dim; ++i)
        for (std::size_t k = 0; k < dim; ++k) {  // sum_a X_a dN_a/dX = I
          double sum = 0;
          for (std::size_t a = 0; a < num_nodes; ++a)
            sum += positions[a * dim + i] * geometry.gradients[a * dim + k];
          EXPECT_NEAR(sum, i == k, 3e-14) << rule;
        }
    }
    EXPECT_NEAR(volume, A.determinant() * size(element.shape), 1e-14) << rule;
  }
}

/// A rule of a catalogue and the shape that it is for.
struct RuleOfShape {
  CellShape shape;
  const QuadratureRule* rule;
};

std::vector<RuleOfShape> all_rules() {
  std::vector<RuleOfShape> rules;
  for (const CellShape shape :
       {CellShape::triangle, CellShape::quadrilateral, CellShape::tetrahedron, CellShape::hexahedron})
    for (const QuadratureRule& rule : quadrature_rules(shape)) rules.push_back({shape, &rule});
  return rules;
}

std::string name_of_rule(const ::testing::TestParamInfo<RuleOfShape>& entry) {
  std::string name = std::string(is_simplex(entry.param.shape) ? "simplex_" : "cube_") +
                     std::to_string(dimension(entry.param.shape)) + "d_" +
                     std::string(entry.param.rule->name);
  std::ranges::replace(name, '-', '_');
  return name;
}

struct EveryQuadratureRule : ::testing::TestWithParam<RuleOfShape> {};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryQuadratureRule, ::testing::ValuesIn(all_rules()), name_of_rule);

TEST_P(EveryQuadratureRule, IsExactToItsDegreeAndNoFurther) {
  const auto& [shape, rule] = GetParam();
  const auto error = [&](int p, int q, int r) {
    double sum = 0;
    for (const QuadraturePoint& point : rule->points)
      sum += point.weight * std::pow(point.xi[0], p) * std::pow(point.xi[1], q) * std::pow(point.xi[2], r);
    return std::abs(sum - monomial_integral(shape, p, q, r));
  };
  double worst = 0;
  for (int p = 0; p <= rule->degree; ++p)
    for (int q = 0; q <= rule->degree; ++q)
      for (int r = 0; r <= (dimension(shape) == 3 ? rule->degree : 0); ++r)
        if (!is_simplex(shape) || p + q + r <= rule->degree) worst = std::max(worst, error(p, q, r));
  EXPECT_LT(worst, 4e-15);
  EXPECT_GT(error(rule->degree + 1, 0, 0), 1e-12);
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
    std::vector<std::string> names;
    for (const ElementInfo* element : elements())
      if (element->dim == 3) names.emplace_back(element->name);
    EXPECT_EQ(std::string(error.what()), "body.element: expected one of " + join(names) + ", got \"P7\"");
  }
}

}  // namespace
}  // namespace resilin
