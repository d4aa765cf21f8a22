#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "resilin/element/element.hpp"
#include "resilin/sensitivity/world_change.hpp"

namespace resilin {

/// The Cauchy stress at a point of a body at rest, of the cell that carries it: where cells meet it may jump.
/// For mixed elements it includes their pressure.
class StressAtPlace {
 public:
  /// @param at  in the scene [m]
  /// @throws InputError  at `place`, for a point outside the body
  StressAtPlace(const World& world, const Body& body, const Vector3& at, const std::string& place);

  Matrix<3> stress(const VectorX& x) const;  ///< [Pa], three by three also in plane strain

  /// Adds the slopes of by : stress by the places, and those by constants and rest positions where `slopes`
  /// has room for them.
  /// @param by  symmetric
  void add_slopes(const Matrix<3>& by, const VectorX& x, VectorX& by_positions, WorldChange& slopes) const;

 private:
  /// The mean volume ratio of the cell and its slopes by the places and the rest places of its nodes.
  struct MeanVolume {
    double j = 0;  ///< J_mean - 1
    std::vector<double> by_x{}, by_X{};
  };
  MeanVolume mean_volume(const VectorX& x) const;
  Matrix<3> displacement_gradient(const VectorX& x) const;

  const World& world_;
  const Body& body_;
  std::size_t body_number_ = 0;
  Index cell_ = 0;
  std::vector<Index> nodes_;           ///< nodes of the cell, in the world
  std::vector<double> rest_;           ///< their rest positions, dim each [m]
  std::vector<double> gradients_;      ///< at [a * dim + k] [1/m]
  std::vector<PointGeometry> points_;  ///< points of the quadrature, for elements with a mean volume
  Material material_;
};

/// Components of a stress: "xx", "yy", "zz", "xy", "yz", "zx" and "von_mises".
std::vector<std::string> stress_components();

/// Its value and its slopes by the stress, a symmetric matrix.
/// @throws InputError  for von Mises' stress where it is zero, which has a kink there
double component_of_stress(std::string_view component, const Matrix<3>& stress, Matrix<3>& slopes);

}  // namespace resilin
