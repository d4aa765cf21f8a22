#pragma once

#include <array>
#include <span>
#include <vector>

#include "resilin/element/element.hpp"

namespace resilin {

/// Integrals of an element's shape functions over rest cells, exact also for curved and distorted ones.
class ShapeIntegrals {
 public:
  explicit ShapeIntegrals(const ElementInfo& element);

  /// integral N_a dV for each node [m^3], in 2D [m^2] on unit thickness. For a quadratic tetrahedron with
  /// straight sides that is -V/20 for a corner and V/5 for the middle of an edge.
  /// @param rest_positions  dim numbers for each node of the cell [m]
  void of_values(std::span<const double> rest_positions, std::span<double> integrals);

  /// integral N_a N_b dV at [a * num_nodes + b].
  void of_products(std::span<const double> rest_positions, std::span<double> integrals);

  // Derivatives of the same by the rest positions, dim numbers for each node. `change`: of these [m];
  // `weights`: of the integrals, whose weighted sum is differentiated.
  void add_change_of_values(std::span<const double> rest_positions, std::span<const double> change,
                            std::span<double> integrals);
  void add_slopes_of_values(std::span<const double> rest_positions, std::span<const double> weights,
                            std::span<double> slopes);
  void add_change_of_products(std::span<const double> rest_positions, std::span<const double> change,
                              std::span<double> integrals);
  void add_slopes_of_products(std::span<const double> rest_positions, std::span<const double> weights,
                              std::span<double> slopes);

 private:
  /// A rule with shape functions and reference gradients at its points.
  struct Samples {
    std::vector<double> weights;
    std::vector<double> values;     ///< [point][node]
    std::vector<double> gradients;  ///< [point][node][dim]
  };
  Samples sample(int degree) const;
  /// Weights times det dX/dxi at the points, into `volumes_`; where slopes are asked for, weights times the
  /// cofactors of dX/dxi, the slopes of the determinant, into `cofactors_`: [point][k][i].
  void measure(const Samples& samples, std::span<const double> rest_positions, bool has_slopes = false);
  /// Change of `volumes_` at a point with the reference positions.
  double change_of_volume(const Samples& samples, std::size_t point, std::span<const double> change) const;
  /// Adds `factor` times the slopes of `volumes_` at a point by the rest positions.
  void add_slopes_of_volume(const Samples& samples, std::size_t point, double factor,
                            std::span<double> slopes) const;
  bool is_affine(std::span<const double> rest_positions) const;

  const ElementInfo& element_;
  std::array<std::size_t, 3> axis_ends_{};  ///< the nodes one unit along the reference axes
  Samples for_values_;                      ///< exact on every cell
  Samples for_products_;                    ///< exact on every cell
  Samples for_affine_products_;             ///< exact where dX/dxi is constant
  Samples for_affine_;                      ///< one point, anywhere where dX/dxi is constant
  // Over the reference cell: integral N_a, and integral N_b dN_a/dxi_k at [a][k][b].
  std::vector<double> reference_values_, reference_slopes_;
  std::vector<double> volumes_, cofactors_;
};

}  // namespace resilin
