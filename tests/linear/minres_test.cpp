#include "resilin/linear/minres.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace resilin::testing {
namespace {

/// [A G^T; G -C]: a spring chain under constraints of small compliance.
Eigen::MatrixXd saddle(Eigen::Index n, Eigen::Index constraints) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + constraints, n + constraints);
  for (Eigen::Index i = 0; i < n; ++i) {
    K(i, i) = 2 + 0.1 * static_cast<double>(i);
    if (i > 0) K(i, i - 1) = K(i - 1, i) = -1;
  }
  for (Eigen::Index c = 0; c < constraints; ++c) {
    K(n + c, c) = K(c, n + c) = 1;
    K(n + c, c + 3) = K(c + 3, n + c) = -2;
    K(n + c, n + c) = -1e-6;
  }
  return K;
}

TEST(Minres, SolvesASaddlePoint) {
  const Eigen::MatrixXd K = saddle(20, 5);
  const VectorX b = VectorX::LinSpaced(25, -1, 2);
  const auto apply = [&](const VectorX& v, VectorX& image) {
    image = K * v;
    return true;
  };
  const auto precondition = [&](const VectorX& v, VectorX& image) {
    image = v.cwiseQuotient(K.diagonal().cwiseAbs().cwiseMax(1));
  };
  VectorX x;
  ASSERT_TRUE(minres(apply, precondition, b, {.max_iterations = 60, .tolerance = 1e-10}, x));
  EXPECT_LT((K * x - b).norm(), 1e-8 * b.norm());
  EXPECT_FALSE(minres(apply, precondition, b, {.max_iterations = 3, .tolerance = 1e-10}, x));
}

TEST(Minres, StopsWhereTheProductFails) {
  VectorX x;
  EXPECT_FALSE(minres([](const VectorX&, VectorX&) { return false; },
                      [](const VectorX& v, VectorX& image) { image = v; }, VectorX::Ones(3), {}, x));
}

TEST(Minres, HasZeroForZero) {
  VectorX x;
  EXPECT_TRUE(minres([](const VectorX&, VectorX&) { return false; },
                     [](const VectorX& v, VectorX& image) { image = v; }, VectorX::Zero(3), {}, x));
  EXPECT_EQ(x, VectorX(VectorX::Zero(3)));
}

}  // namespace
}  // namespace resilin::testing
