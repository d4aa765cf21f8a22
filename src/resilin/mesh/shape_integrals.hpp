#pragma once

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
  /// Weights times det dX/dxi at the points, into `volumes_`.
  void measure(const Samples& samples, std::span<const double> rest_positions);
  /// The same, and their slopes by the rest positions into `slopes_`: [point][node][dim].
  void measure_slopes(const Samples& samples, std::span<const double> rest_positions);
  bool is_affine(std::span<const double> rest_positions) const;

  const ElementInfo& element_;
  Samples for_values_;           ///< exact on every cell
  Samples for_products_;         ///< exact on every cell
  Samples for_affine_products_;  ///< exact where dX/dxi is constant
  std::vector<double> volumes_, slopes_;
};

}  // namespace resilin
