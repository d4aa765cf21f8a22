#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "every_instruction_set.hpp"
#include "resilin/core/types.hpp"

namespace resilin::testing {
namespace {

using Rows3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Rows2 = Eigen::Matrix<double, 2, 2, Eigen::RowMajor>;

Matrix<3> random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// U diag(s) V^T with rotations by chance.
Matrix<3> matrix_with(const Vector3& s, std::mt19937& random) {
  return random_rotation(random) * s.asDiagonal() * random_rotation(random).transpose();
}

/// F by chance with given singular values: usual ones, equal ones, none at all, negative ones, and pairs that
/// differ by a factor of up to 1e6, in sizes from 1e-3 to 1e3.
std::vector<Matrix<3>> sample_matrices() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Matrix<3>> samples = {Matrix<3>::Zero(),
                                    Matrix<3>::Identity(),
                                    -Matrix<3>::Identity(),
                                    Vector3(0, 0, 1).asDiagonal(),
                                    Vector3(1, 0, 0).asDiagonal(),
                                    Vector3(1, 1, -1).asDiagonal(),
                                    Vector3(2, 2, 2).asDiagonal(),
                                    Matrix<3>::Constant(1)};
  for (const Vector3& s :
       {Vector3(1, 1, 1), Vector3(2, 2, 1), Vector3(2, 1, 1), Vector3(3, 2, 1), Vector3(1, 1, 0),
        Vector3(1, 0, 0), Vector3(3, 2, -1), Vector3(1, 1, -1), Vector3(1, 1e-6, 1e-6), Vector3(1, 1, 1e-6),
        Vector3(1e3, 1, 1e-3), Vector3(1, 1e-6, -1e-6), Vector3(1, 1 - 1e-9, 1 - 2e-9)})
    for (const double size : {1e-3, 1.0, 1e3})
      for (int k = 0; k < 8; ++k) samples.push_back(matrix_with(size * s, random));
  for (int k = 0; k < 4000; ++k) {
    Matrix<3> F;
    for (double& entry : F.reshaped()) entry = uniform(random);
    samples.push_back(F);
  }
  return samples;
}

template <int dim>
void expect_rotation(const Matrix<dim>& R, const char* what) {
  EXPECT_LT((R.transpose() * R - Matrix<dim>::Identity()).norm(), 5e-15) << what << "\n" << R;
  EXPECT_NEAR(R.determinant(), 1, 5e-15) << what;
}

struct SimdSvd : EveryInstructionSet {
  std::vector<SvdNumbers> decompose(const std::vector<Matrix<3>>& H, bool keeps_strain) const {
    std::vector<double> rows;
    for (const Matrix<3>& h : H)
      for (int i = 0; i < 9; ++i) rows.push_back(h(i / 3, i % 3));
    std::vector<SvdNumbers> out(H.size());
    probe.svd(H.size(), keeps_strain, rows.data(), out.data());
    return out;
  }
};

TEST_P(SimdSvd, RebuildsTheMatrixFromProperRotationsAndSortedSignedValues) {
  const std::vector<Matrix<3>> F = sample_matrices();
  ASSERT_EQ(F.size() % 8, 0U);
  std::vector<Matrix<3>> H = F;
  for (Matrix<3>& h : H) h -= Matrix<3>::Identity();
  for (const bool keeps_strain : {false, true}) {
    const std::vector<SvdNumbers> results = decompose(H, keeps_strain);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const Matrix<3> U = Eigen::Map<const Matrix<3>>(results[i].U),
                      V = Eigen::Map<const Matrix<3>>(results[i].V);
      const Vector3 s = Eigen::Map<const Vector3>(results[i].s);
      const double size = std::max(F[i].norm(), 1e-3);  // H has lost the digits below those of 1
      SCOPED_TRACE(::testing::Message() << "matrix " << i << "\n" << F[i] << "\nvalues " << s.transpose());
      expect_rotation<3>(U, "U");
      expect_rotation<3>(V, "V");
      // As core/simd_svd.hpp says: squashed in all directions, and where a second stretch is small.
      const double squashed = s[0] < 0.1 ? 5e-13 : 0;
      const double lost = squashed + (keeps_strain ? std::min(1e-15 / s[1], 3 * s[1]) : 0);
      EXPECT_LT((U * s.asDiagonal() * V.transpose() - F[i]).norm(), 5e-15 * std::max(size, 1.0) + lost);
      EXPECT_GE(s[0], s[1] - 1e-15 * size - lost);
      EXPECT_GE(s[1], std::abs(s[2]) - 2e-15 * size - lost);
      EXPECT_GE(s[1], 0);
      const double det = F[i].determinant();
      if (std::abs(det) > 1e-12 * size * size * size) {
        EXPECT_EQ(s[2] < 0, det < 0);
      }
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST_P(SimdSvd, HasTheSingularValuesOfAnotherMethod) {
  const std::vector<Matrix<3>> F = sample_matrices();
  std::vector<Matrix<3>> H = F;
  for (Matrix<3>& h : H) h -= Matrix<3>::Identity();
  const std::vector<SvdNumbers> results = decompose(H, false);
  for (std::size_t i = 0; i < F.size(); ++i) {
    const VectorX expected = Eigen::JacobiSVD<Eigen::MatrixXd>(F[i]).singularValues();
    const Vector3 s = Eigen::Map<const Vector3>(results[i].s).cwiseAbs();
    EXPECT_LT((s - expected).norm(), 4e-15 * std::max(expected[0], 1.0)) << F[i];
  }
}

/// Stretches 1 + e with e known: e_i of a symmetric H = R diag(e) R^T are its eigenvalues.
TEST_P(SimdSvd, KeepsTheDigitsOfSmallStrains) {
  std::mt19937 random(5);
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12}) {
    std::vector<Matrix<3>> H;
    for (int k = 0; k < 64; ++k) {
      const Matrix<3> R = random_rotation(random);
      Matrix<3> h = size * R * Vector3(0.7, -0.2, -0.9).asDiagonal() * R.transpose();
      H.push_back(0.5 * (h + h.transpose()));
    }
    for (const SvdNumbers& result : decompose(H, true)) {
      const Vector3 e = Eigen::Map<const Vector3>(result.e);
      EXPECT_LT((e - size * Vector3(0.7, -0.2, -0.9)).norm(), 4e-15 * size) << "size " << size;
    }
  }
}

TEST_P(SimdSvd, InThePlaneRebuildsTheMatrixAndKeepsTheDigitsOfSmallStrains) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Rows2> F = {Rows2::Zero(),
                          Rows2::Identity(),
                          -Rows2::Identity(),
                          Rows2::Constant(1),
                          Rows2(Vector<2>(1, -1).asDiagonal()),
                          Rows2(Vector<2>(0, 1).asDiagonal()),
                          Rows2(Vector<2>(1, 0).asDiagonal()),
                          Rows2(Vector<2>(2, 2).asDiagonal())};
  for (const double size : {1e-6, 1.0, 1e6})
    for (int k = 0; k < 2000; ++k) {
      F.emplace_back();
      for (double& entry : F.back().reshaped()) entry = size * uniform(random);
    }
  std::vector<Rows2> H = F;
  for (Rows2& h : H) h -= Rows2::Identity();
  std::vector<Svd2Numbers> results(H.size());
  probe.svd2(H.size(), H.data()->data(), results.data());
  for (std::size_t i = 0; i < F.size(); ++i) {
    const Matrix<2> U = Eigen::Map<const Matrix<2>>(results[i].U),
                    V = Eigen::Map<const Matrix<2>>(results[i].V);
    const Vector<2> s = Eigen::Map<const Vector<2>>(results[i].s);
    const double size = std::max(F[i].norm(), 1.0);
    expect_rotation<2>(U, "U");
    expect_rotation<2>(V, "V");
    const double lost = std::min(1e-15 / s[0], 3 * s[0]);
    EXPECT_LT((U * s.asDiagonal() * V.transpose() - F[i]).norm(), 4e-15 * size + lost) << F[i];
    EXPECT_GE(s[0], std::abs(s[1]) - 2e-15 * size - lost);
  }
  for (const double size : {1e-3, 1e-9, 1e-12}) {
    const Matrix<2> R = Eigen::Rotation2Dd(0.3).toRotationMatrix();
    const Matrix<2> h = size * R * Vector<2>(0.7, -0.2).asDiagonal() * R.transpose();
    const std::vector<Rows2> same(8, Rows2(0.5 * (h + h.transpose())));
    probe.svd2(8, same.data()->data(), results.data());
    EXPECT_NEAR(results[0].e[0], 0.7 * size, 4e-15 * size);
    EXPECT_NEAR(results[0].e[1], -0.2 * size, 4e-15 * size);
  }
}

template <int n>
using Square = Eigen::Matrix<double, n, n, Eigen::RowMajor>;

/// Symmetric matrices by chance of sizes from 1e-6 to 1e6, some with eigenvalues that are equal or zero.
template <int n>
std::vector<Square<n>> symmetric_matrices() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Square<n>> samples = {Square<n>::Zero(), Square<n>::Identity(), Square<n>::Constant(1),
                                    -2 * Square<n>::Identity()};
  for (const double size : {1e-6, 1.0, 1e6})
    for (int k = 0; k < 200; ++k) {
      Square<n> A;
      for (double& entry : A.reshaped()) entry = uniform(random);
      if (k % 2 == 0) A.template rightCols<2>() = A.template leftCols<2>();
      samples.push_back(size * (k % 2 == 0 ? Square<n>(A.transpose() * A) : Square<n>(A + A.transpose())));
    }
  while (samples.size() % 8 != 0) samples.push_back(samples.back());
  return samples;
}

template <int n, class Diagonalize>
void expect_eigenvectors(const Diagonalize& diagonalize) {
  const std::vector<Square<n>> samples = symmetric_matrices<n>();
  std::vector<Square<n>> A = samples, V(samples.size());
  diagonalize(A.size(), A.data()->data(), V.data()->data());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double size = samples[i].norm();
    EXPECT_LT((V[i].transpose() * V[i] - Square<n>::Identity()).norm(), 1e-14);
    const Square<n> rebuilt = V[i] * A[i].diagonal().asDiagonal() * V[i].transpose();
    EXPECT_LT((rebuilt - samples[i]).norm(), 1e-14 * size + 1e-300) << samples[i];
  }
}

TEST_P(SimdSvd, DiagonalizesSymmetricMatricesOfThreeAndSixToRoundOff) {
  expect_eigenvectors<3>(
      [&](std::size_t count, double* A, double* V) { probe.diagonalize3(count, 0, A, V); });
  expect_eigenvectors<6>(probe.diagonalize6);
}

TEST_P(SimdSvd, FourSweepsDiagonalizeAMatrixOfThree) {
  expect_eigenvectors<3>(
      [&](std::size_t count, double* A, double* V) { probe.diagonalize3(count, 4, A, V); });
}

INSTANTIATE_TEST_SUITE_P(Lanes, SimdSvd, ::testing::ValuesIn(available_instruction_sets()), name_of_set);

}  // namespace
}  // namespace resilin::testing
