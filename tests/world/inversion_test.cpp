// Where linear elasticity first turns a cell inside out: at the most negative real eigenvalue of the
// displacement gradient.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A world of one small block, whose cells all have the gradient that is asked for.
struct Block {
  explicit Block(int dimension) : world(description(dimension)) {}

  static Description description(int dimension) {
    Description scene = small_bar(dimension, false);
    scene.bodies[0].mesh = dimension == 3 ? make_box({1, 1, 1}, {1, 1, 1}) : make_rectangle({1, 1}, {1, 1});
    return scene;
  }

  /// The load factor at which a cell is turned inside out when the displacements at load factor 1 are G X;
  /// infinite when none is at any.
  double load_of_inversion(const Matrix<3>& G) const {
    const int dim = world.dimension;
    VectorX x = world.rest_positions;
    for (Eigen::Index node = 0; node < x.size(); node += dim)
      x.segment(node, dim) += G.topLeftCorner(dim, dim) * world.rest_positions.segment(node, dim);
    const std::optional<Inversion> inversion = first_inversion(world, x, 1);
    return inversion ? inversion->load : std::numeric_limits<double>::infinity();
  }

  World world;
};

Matrix<3> random_matrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix<3> A;
  for (double& entry : A.reshaped()) entry = normal(random);
  return A;
}

/// A matrix that does not amplify rounding by much.
Matrix<3> random_basis(std::mt19937& random) {
  return 3 * Matrix<3>::Identity() + random_matrix(random).cwiseMax(-1).cwiseMin(1);
}

struct KnownRoots {
  const char* what;
  Matrix<3> matrix;  ///< in some basis
  double least;      ///< its most negative real eigenvalue, 0 when it has none
  double
      tolerance;  ///< tolerance of that, relative: the root of the rounding by how many eigenvalues are equal
};

std::vector<KnownRoots> known_roots() {
  const auto diagonal = [](double a, double b, double c) { return Matrix<3>(Vector3(a, b, c).asDiagonal()); };
  /// An eigenvalue, and a pair re +- i im.
  const auto with_pair = [](double eigenvalue, double re, double im) {
    Matrix<3> A;
    A << eigenvalue, 0, 0, 0, re, -im, 0, im, re;
    return A;
  };
  Matrix<3> chain = diagonal(-0.5, -0.5, 0.3), triple_chain = -0.5 * Matrix<3>::Identity();
  chain(0, 1) = triple_chain(0, 1) = triple_chain(1, 2) = 0.4;
  return {
      {"three of either sign", diagonal(-0.5, -0.2, 0.3), -0.5, 1e-12},
      {"three negative ones", diagonal(-0.5, -0.2, -0.1), -0.5, 1e-12},
      {"three positive ones", diagonal(0.5, 0.2, 0.1), 0, 0},
      {"one among two positive ones", diagonal(0.5, 0.2, -1e-3), -1e-3, 1e-11},
      {"equal at the lower end", diagonal(-0.5, -0.5, 0.3), -0.5, 1e-6},
      {"equal at the upper end", diagonal(-0.5, 0.3, 0.3), -0.5, 1e-6},
      {"equal ones with one eigenvector", chain, -0.5, 1e-6},
      {"three equal ones", diagonal(-0.5, -0.5, -0.5), -0.5, 1e-4},
      {"three equal ones with one eigenvector", triple_chain, -0.5, 1e-4},
      {"one right of a pair", with_pair(-0.25, -0.9, 0.4), -0.25, 1e-12},
      {"one left of a pair", with_pair(-0.9, -0.1, 0.4), -0.9, 1e-12},
      {"a positive one right of a pair", with_pair(0.25, -0.9, 0.4), 0, 0},
      {"a stretch along one axis", diagonal(0.4, 0, 0), 0, 0},
      {"a shortening along one axis", diagonal(-0.4, 0, 0), -0.4, 1e-6},
  };
}

TEST(Inversion, IsAtTheMostNegativeRealEigenvalue) {
  const Block block(3);
  std::mt19937 random(2);
  for (const KnownRoots& known : known_roots()) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix<3> basis = trial == 0 ? Matrix<3>(Matrix<3>::Identity()) : random_basis(random);
      const double load = block.load_of_inversion(basis * known.matrix * basis.inverse());
      // A root at zero may come out as one of the size of its rounding, at a load that nobody asks for.
      if (known.least == 0) {
        EXPECT_GT(load, 1e4) << known.what;
      } else {
        EXPECT_NEAR(load * -known.least, 1, known.tolerance) << known.what;
      }
    }
  }
}

TEST(Inversion, IsNowhereWhenNothingMovesOrAllTurns) {
  const Block block(3);
  EXPECT_TRUE(std::isinf(block.load_of_inversion(Matrix<3>::Zero())));
  Matrix<3> turn = Matrix<3>::Zero();
  turn(0, 1) = -0.3;
  turn(1, 0) = 0.3;
  EXPECT_GT(block.load_of_inversion(turn), 1e4);
}

/// J(t) = det(I + t G) is positive up to that load and zero there.
TEST(Inversion, IsTheFirstZeroOfTheVolumeRatio) {
  for (const int dimension : {2, 3}) {
    const Block block(dimension);
    std::mt19937 random(3);
    int num_inverted = 0;
    for (int trial = 0; trial < 300; ++trial) {
      Matrix<3> G = 0.3 * random_matrix(random);
      if (dimension == 2) G.row(2).setZero(), G.col(2).setZero();
      const auto volume_ratio = [&](double t) { return (Matrix<3>::Identity() + t * G).determinant(); };
      const double load = block.load_of_inversion(G), last = std::min(load, 1e3);
      for (int i = 0; i < 100; ++i) EXPECT_GT(volume_ratio(0.999 * last * std::pow(i / 99.0, 3)), 0);
      if (std::isinf(load)) continue;
      ++num_inverted;
      const double size = std::pow(1 + load * G.norm(), 3);
      EXPECT_NEAR(volume_ratio(load), 0, 1e-12 * size) << G;
    }
    EXPECT_GT(num_inverted, 100);
  }
}

}  // namespace
}  // namespace resilin::testing
