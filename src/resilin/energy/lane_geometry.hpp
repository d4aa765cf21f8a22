#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "resilin/core/simd.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/kernels/element_blocks.hpp"

/// Cells of a body eight at a time, in plain arithmetic: for what is asked once for a result, such as its
/// derivatives, and not once for each iteration.
namespace resilin {

/// A number of each lane of a block.
using LaneRow = Eigen::Array<double, block_size, 1>;

/// A matrix in each lane, by rows.
template <int dim>
struct LaneMatrix {
  std::array<LaneRow, static_cast<std::size_t>(dim* dim)> entries;

  LaneRow& operator()(int i, int k) { return entries[static_cast<std::size_t>(dim * i + k)]; }
  const LaneRow& operator()(int i, int k) const { return entries[static_cast<std::size_t>(dim * i + k)]; }

  static LaneMatrix zero() {
    LaneMatrix result;
    for (LaneRow& entry : result.entries) entry.setZero();
    return result;
  }
  /// From rows of lanes, as kernels have them.
  static LaneMatrix load(const double* rows) {
    LaneMatrix result;
    for (std::size_t i = 0; i < result.entries.size(); ++i)
      result.entries[i] = Eigen::Map<const LaneRow>(rows + i * block_size);
    return result;
  }
  void store(double* rows) const {
    for (std::size_t i = 0; i < entries.size(); ++i) Eigen::Map<LaneRow>(rows + i * block_size) = entries[i];
  }
  LaneRow trace() const {
    LaneRow sum = (*this)(0, 0);
    for (int i = 1; i < dim; ++i) sum += (*this)(i, i);
    return sum;
  }
  LaneMatrix transposed() const {
    LaneMatrix result;
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) result(i, k) = (*this)(k, i);
    return result;
  }
  /// This and `row` times the identity.
  LaneMatrix plus_identity(const LaneRow& row) const {
    LaneMatrix result = *this;
    for (int i = 0; i < dim; ++i) result(i, i) += row;
    return result;
  }
  friend LaneMatrix operator+(LaneMatrix a, const LaneMatrix& b) {
    for (std::size_t i = 0; i < a.entries.size(); ++i) a.entries[i] += b.entries[i];
    return a;
  }
  friend LaneMatrix operator-(LaneMatrix a, const LaneMatrix& b) {
    for (std::size_t i = 0; i < a.entries.size(); ++i) a.entries[i] -= b.entries[i];
    return a;
  }
  friend LaneMatrix operator*(const LaneRow& factor, LaneMatrix a) {
    for (LaneRow& entry : a.entries) entry *= factor;
    return a;
  }
  friend LaneMatrix operator*(const LaneMatrix& a, const LaneMatrix& b) {
    LaneMatrix result = zero();
    for (int i = 0; i < dim; ++i)
      for (int m = 0; m < dim; ++m)
        for (int k = 0; k < dim; ++k) result(i, k) += a(i, m) * b(m, k);
    return result;
  }
};

/// a : b
template <int dim>
LaneRow contracted(const LaneMatrix<dim>& a, const LaneMatrix<dim>& b) {
  LaneRow sum = a.entries[0] * b.entries[0];
  for (std::size_t i = 1; i < a.entries.size(); ++i) sum += a.entries[i] * b.entries[i];
  return sum;
}

/// Cofactor matrix: dJ/dF = J F^-T.
template <int dim>
LaneMatrix<dim> cofactor(const LaneMatrix<dim>& F) {
  LaneMatrix<dim> C;
  if constexpr (dim == 2) {
    C(0, 0) = F(1, 1);
    C(0, 1) = -F(1, 0);
    C(1, 0) = -F(0, 1);
    C(1, 1) = F(0, 0);
  } else {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        C(i, k) = F(i1, k1) * F(i2, k2) - F(i1, k2) * F(i2, k1);
      }
  }
  return C;
}

/// The shape functions of one block of cells at one quadrature point.
template <int dim>
class LanePoint {
 public:
  LanePoint(const ElementBlocks& blocks, std::size_t block, std::size_t point)
      : blocks_(blocks), first_node_(block * static_cast<std::size_t>(blocks.num_nodes)) {
    constexpr auto d = static_cast<std::size_t>(dim);
    const auto n = static_cast<std::size_t>(blocks.num_nodes);
    weight_ =
        Eigen::Map<const LaneRow>(blocks.weights.data() + (block * blocks.num_points + point) * block_size);
    if (blocks.is_linear_simplex()) {
      LaneMatrix<dim> edges;  // by columns
      for (int a = 0; a < dim; ++a)
        for (int i = 0; i < dim; ++i)
          edges(i, a) = component(blocks.rest_positions, static_cast<std::size_t>(a) + 1, i) -
                        component(blocks.rest_positions, 0, i);
      const LaneMatrix<dim> normals = cofactor(edges);
      LaneRow V = edges(0, 0) * normals(0, 0);
      for (int i = 1; i < dim; ++i) V += edges(i, 0) * normals(i, 0);
      for (int k = 0; k < dim; ++k) {
        slopes_[static_cast<std::size_t>(k)].setZero();
        for (int a = 0; a < dim; ++a) {
          LaneRow& slope = slopes_[(static_cast<std::size_t>(a) + 1) * d + static_cast<std::size_t>(k)];
          slope = (weight_ > 0).select(normals(k, a) / V, 0.0);
          slopes_[static_cast<std::size_t>(k)] -= slope;
        }
      }
      return;
    }
    const auto dxi_dX = LaneMatrix<dim>::load(blocks.gradients.data() +
                                              (block * blocks.num_points + point) * d * d * block_size);
    for (std::size_t a = 0; a < n; ++a) {
      const double* dN_dxi = blocks.reference_gradients.data() + (point * n + a) * d;
      for (std::size_t k = 0; k < d; ++k) {
        slopes_[a * d + k].setZero();
        for (std::size_t m = 0; m < d; ++m)
          slopes_[a * d + k] += dN_dxi[m] * dxi_dX(static_cast<int>(m), static_cast<int>(k));
      }
    }
  }

  const LaneRow& weight() const { return weight_; }  ///< zero in lanes that are filled up
  /// dN_a/dX_k
  const LaneRow& slope(std::size_t a, int k) const {
    return slopes_[a * static_cast<std::size_t>(dim) + static_cast<std::size_t>(k)];
  }

  /// The gradient of a field of the nodes, local numbers with the stride of the kernels.
  LaneMatrix<dim> gradient(const std::vector<double>& values) const {
    auto G = LaneMatrix<dim>::zero();
    for (std::size_t a = 0; a < static_cast<std::size_t>(blocks_.num_nodes); ++a)
      for (int i = 0; i < dim; ++i) {
        const LaneRow of_node = component(values, a, i);
        for (int k = 0; k < dim; ++k) G(i, k) += of_node * slope(a, k);
      }
    return G;
  }

  /// Adds weight M g_a, or its absolute values, to the nodes that are owned, g_a = dN_a/dX.
  void add(const LaneMatrix<dim>& M, const OwnedNodes& owned, double* local,
           bool is_magnitude = false) const {
    for (std::size_t a = 0; a < static_cast<std::size_t>(blocks_.num_nodes); ++a)
      for (int i = 0; i < dim; ++i) {
        LaneRow share = M(i, 0) * slope(a, 0);
        for (int k = 1; k < dim; ++k) share += M(i, k) * slope(a, k);
        share *= weight_;
        if (is_magnitude) share = share.abs();
        for (std::size_t lane = 0; lane < block_size; ++lane) {
          const Index to = node(a, lane);
          if (to >= owned.begin && to < owned.end)
            local[static_cast<std::size_t>(to) * blocks_.stride() + static_cast<std::size_t>(i)] +=
                share[static_cast<Eigen::Index>(lane)];
        }
      }
  }

 private:
  Index node(std::size_t a, std::size_t lane) const {
    return blocks_.nodes[(first_node_ + a) * block_size + lane];
  }
  /// Component i of node a, from numbers by local node.
  LaneRow component(const std::vector<double>& values, std::size_t a, int i) const {
    LaneRow row;
    for (std::size_t lane = 0; lane < block_size; ++lane)
      row[static_cast<Eigen::Index>(lane)] =
          values[static_cast<std::size_t>(node(a, lane)) * blocks_.stride() + static_cast<std::size_t>(i)];
    return row;
  }
  const ElementBlocks& blocks_;
  std::size_t first_node_;
  LaneRow weight_;
  std::array<LaneRow, 3 * max_element_nodes> slopes_;
};

}  // namespace resilin
