#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// Rest positions of the points of a rule in the cells of a body, which must outlive it.
class RestPlaces {
 public:
  RestPlaces(const Body& body, const VectorX& rest_positions, const QuadratureRule& rule);
  Vector3 of(std::size_t cell, std::size_t point) const;  ///< [m]

 private:
  const Body& body_;
  const VectorX& rest_positions_;
  int dim_;
  std::size_t num_nodes_;       ///< number of nodes of a cell
  std::vector<double> shapes_;  ///< [point * num_nodes + node]
};

/// A symmetric tensor in Mandel's notation: xx, yy, zz, then yz, xz, xy times the root of 2, so that the dot
/// product is that of the tensors.
using SymmetricTensor = Eigen::Matrix<double, 6, 1>;

/// Continuous fields of a body, of one order more than those at its quadrature points, which they are
/// recovered from: a polynomial of the element's degree is fitted to the points of the cells around each
/// vertex, and within a cell the polynomials of its corners are blended by the linear shape functions.
///
///   f(X) = sum_a N_a(X) p_a(X),    sum_q |p_a(X_q) - f_q|^2 least
///
/// Cells of different materials lie in patches of their own: stresses jump between them. Patches whose points
/// do not tell a polynomial take in the cells around, at last they fit one of lower degree.
/// Source: Zienkiewicz & Zhu 1992 (patches); Blacker & Belytschko 1994 (blending).
class PatchRecovery {
 public:
  /// @param rest_positions  of all nodes of the world, dim each [m]
  /// @param materials       a number for each cell, equal where the material is
  PatchRecovery(const Body& body, const VectorX& rest_positions, int dim, std::span<const Index> materials);

  /// Fits the patches to values at the body's quadrature points, those of one cell after another.
  void fit(std::span<const SymmetricTensor> point_values);

  /// The recovered value in a cell.
  /// @param corner_shapes  N_a of its corners there
  /// @param X              rest position there [m]
  SymmetricTensor value(std::size_t cell, std::span<const double> corner_shapes, const Vector3& X) const;

  /// Whether some patch has points enough for more than their mean.
  bool has_enough_points() const { return has_enough_points_; }

 private:
  struct Patch {
    Vector3 center = Vector3::Zero();         ///< the mean of its points [m]
    Matrix<3> scale = Matrix<3>::Identity();  ///< its points then vary by 1 in every direction [1/m]
    int degree = 0;                           ///< degree of the polynomial
    std::vector<Index> cells = {};            ///< rising
  };
  /// Coefficients of one patch: a column for each monomial up to the element's degree.
  using Coefficients = Eigen::Map<Eigen::Matrix<double, 6, Eigen::Dynamic>>;
  using ConstCoefficients = Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>;
  void add_patches(std::span<const Index> materials);
  void widen(Patch& patch, std::span<const Index> materials) const;
  void place(Patch& patch) const;
  int num_monomials(int degree) const;
  /// Those of a degree at the points of a patch, one row for each.
  Eigen::MatrixXd monomials_of(const Patch& patch, int degree) const;
  std::span<const Index> corners_of(std::size_t cell) const {
    return std::span(corners_).subspan(cell * num_corners_, num_corners_);
  }
  std::span<const Index> cells_around(Index vertex) const;

  int dim_, degree_;
  std::size_t num_corners_, num_points_;
  std::vector<Index> corners_;           ///< nodes of the body, num_corners_ for each cell
  std::vector<std::size_t> around_end_;  ///< for each node, where its cells end in `around_`
  std::vector<Index> around_;            ///< cells around the nodes
  std::vector<Vector3> points_;          ///< rest positions of the quadrature points [m]
  std::vector<Patch> patches_;
  std::vector<double> coefficients_;  ///< those of one patch after another
  std::vector<Index> patch_of_;       ///< patches of the corners of the cells
  bool has_enough_points_ = false;
};

}  // namespace resilin
