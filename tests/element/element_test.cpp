// Properties that every element of the catalogue has.
#include <gtest/gtest.h>

#include <random>

#include "resilin/core/error.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

/// A point inside the reference simplex.
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
        EXPECT_NEAR(gradients[a * dim + k], (above[a] - below[a]) / (2 * step), 1e-8) << element->name;
    }
  }
}

TEST(EveryElement, QuadratureWeightsSumToTheReferenceCell) {
  for (const ElementInfo* element : elements()) {
    double sum = 0;
    for (const QuadraturePoint& point : element->points) sum += point.weight;
    EXPECT_NEAR(sum, element->dim == 2 ? 0.5 : 1.0 / 6, 1e-16) << element->name;
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
    for (std::size_t a = 0; a < n; ++a) {  // reference corners: the origin and the unit vectors
      const Vector3 xi = a == 0 ? Vector3(0, 0, 0) : Vector3(Vector3::Unit(static_cast<int>(a) - 1));
      const Vector3 X = A * xi;
      positions.insert(positions.end(), X.data(), X.data() + dim);
    }
    const PointGeometry geometry = point_geometry(*element, element->points[0], positions);
    EXPECT_NEAR(geometry.weight, A.determinant() / (dim == 2 ? 2 : 6), 1e-15);
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) {  // sum_a X_a dN_a/dX = I
        double sum = 0;
        for (std::size_t a = 0; a < n; ++a)
          sum += positions[a * static_cast<std::size_t>(dim) + static_cast<std::size_t>(i)] *
                 geometry.gradients[a * static_cast<std::size_t>(dim) + static_cast<std::size_t>(k)];
        EXPECT_NEAR(sum, i == k, 1e-14) << element->name;
      }
  }
}

TEST(ElementCatalogue, UnknownElementIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(find_element("P7", 3), nullptr);
  try {
    require_element("P7", 3, "body.element");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "body.element: expected one of P1, got \"P7\"");
  }
}

}  // namespace
}  // namespace resilin
