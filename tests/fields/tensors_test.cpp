#include "resilin/fields/tensors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resilin::testing {
namespace {

Matrix<3> rotation() { return Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()).toRotationMatrix(); }

TEST(Strain, OfAStretchThenATurnIsTheOneOfTheStretch) {
  const Vector3 stretches(1.5, 0.8, 1.1);
  const Matrix<3> R = rotation(), H = R * stretches.asDiagonal().toDenseMatrix() - Matrix<3>::Identity();
  const Matrix<3> E = 0.5 * (stretches.array().square() - 1).matrix().asDiagonal().toDenseMatrix();
  const Matrix<3> ln_V = R * stretches.array().log().matrix().asDiagonal() * R.transpose();
  EXPECT_LT((green_strain(H) - E).norm(), 1e-14);           // numbers near 1: a few round-offs
  EXPECT_LT((logarithmic_strain(H) - ln_V).norm(), 1e-14);  // the same
}

TEST(Strain, KeepsItsDigitsWhenItIsSmall) {
  Matrix<3> e;
  e << 1e-9, 2e-9, 0, 2e-9, -3e-9, 1e-9, 0, 1e-9, 5e-10;
  // The strains differ from e by its square.
  EXPECT_LT((green_strain(e) - e).norm(), 1e-8 * e.norm());
  EXPECT_LT((logarithmic_strain(e) - e).norm(), 1e-8 * e.norm());
}

TEST(PrincipalValues, RebuildTheTensorFromTheLargestToTheSmallest) {
  const Matrix<3> Q = rotation();
  const Matrix<3> tensor = Q * Vector3(-2, 5, 1).asDiagonal() * Q.transpose();
  const Principal found = principal(tensor);
  EXPECT_NEAR(found.values[0], 5, 1e-14);
  EXPECT_NEAR(found.values[1], 1, 1e-14);
  EXPECT_NEAR(found.values[2], -2, 1e-14);
  const Matrix<3> rebuilt = found.directions *
                            Vector3(found.values[0], found.values[1], found.values[2]).asDiagonal() *
                            found.directions.transpose();
  EXPECT_LT((rebuilt - tensor).norm(), 1e-13);
  EXPECT_NEAR(std::abs(found.directions.col(0).dot(Q.col(1))), 1, 1e-14);
  for (int i = 0; i < 3; ++i)
    EXPECT_GT(found.directions.col(i).maxCoeff(), -found.directions.col(i).minCoeff());
}

TEST(PrincipalValues, OfATensorThatIsNoNumberAreNone) {
  Matrix<3> tensor = Matrix<3>::Zero();
  tensor(1, 1) = NAN;
  EXPECT_TRUE(std::isnan(principal(tensor).values[0]));
  EXPECT_TRUE(logarithmic_strain(tensor).array().isNaN().all());
}

}  // namespace
}  // namespace resilin::testing
