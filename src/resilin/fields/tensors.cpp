#include "resilin/fields/tensors.hpp"

#include <cmath>
#include <limits>

namespace resilin {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Matrix<3> green_strain(const Matrix<3>& H) { return 0.5 * (H + H.transpose() + H.transpose() * H); }

Matrix<3> logarithmic_strain(const Matrix<3>& H) {
  const Matrix<3> e = 0.5 * (H + H.transpose() + H * H.transpose());  // (F F^T - I) / 2
  if (!e.allFinite()) return Matrix<3>::Constant(nan);
  const Eigen::SelfAdjointEigenSolver<Matrix<3>> eigen(e);
  const Vector3 logarithms =
      eigen.eigenvalues().unaryExpr([](double value) { return 0.5 * std::log1p(2 * value); });
  return eigen.eigenvectors() * logarithms.asDiagonal() * eigen.eigenvectors().transpose();
}

Principal principal(const Matrix<3>& tensor) {
  if (!tensor.allFinite()) return {{nan, nan, nan}, Matrix<3>::Constant(nan)};
  const Eigen::SelfAdjointEigenSolver<Matrix<3>> ascending(tensor);
  Principal result;
  for (int i = 0; i < 3; ++i) {
    result.values[static_cast<std::size_t>(i)] = ascending.eigenvalues()[2 - i];
    const Vector3 direction = ascending.eigenvectors().col(2 - i);
    int largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    result.directions.col(i) = direction[largest] < 0 ? Vector3(-direction) : direction;
  }
  return result;
}

}  // namespace resilin
