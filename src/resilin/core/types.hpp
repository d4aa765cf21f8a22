#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace resilin {

using Index = std::int32_t;   ///< number of a node or a cell
using Offset = std::int64_t;  ///< position in a long array, such as the values of a matrix

/// Small square matrices and vectors of fixed size.
template <int dim>
using Matrix = Eigen::Matrix<double, dim, dim>;
template <int dim>
using Vector = Eigen::Matrix<double, dim, 1>;
using Vector3 = Eigen::Vector3d;

/// One number per unknown, node by node: entry `dim * node + component`.
using VectorX = Eigen::VectorXd;

}  // namespace resilin
