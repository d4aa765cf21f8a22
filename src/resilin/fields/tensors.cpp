#include "resilin/fields/tensors.hpp"

#include <cmath>
#include <limits>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Matrix<3> green_strain(const Matrix<3>& H) { return 0.5 * (H + H.transpose() + H.transpose() * H); }

Matrix<3> logarithmic_strain(const Matrix<3>& H) {
  const Matrix<3> e = 0.5 * (H + H.transpose() + H * H.transpose());  // (F F^T - I) / 2
  if (!e.allFinite()) return Matrix<3>::Constant(nan);
  const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(e);
  const Vector3 logarithms = eigen.values.unaryExpr([](double value) { return 0.5 * std::log1p(2 * value); });
  return eigen.vectors * logarithms.asDiagonal() * eigen.vectors.transpose();
}

Principal principal(const Matrix<3>& tensor) {
  if (!tensor.allFinite()) return {{nan, nan, nan}, Matrix<3>::Constant(nan)};
  const dense::Eigenpairs3 ascending = dense::symmetric_eigenpairs3(tensor);
  Principal result;
  for (int i = 0; i < 3; ++i) {
    result.values[static_cast<std::size_t>(i)] = ascending.values[2 - i];
    const Vector3 direction = ascending.vectors.col(2 - i);
    int largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    result.directions.col(i) = direction[largest] < 0 ? Vector3(-direction) : direction;
  }
  return result;
}

}  // namespace resilin
