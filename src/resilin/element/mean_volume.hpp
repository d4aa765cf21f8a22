#pragma once

#include "resilin/element/bilinear_quadrilateral.hpp"
#include "resilin/element/quadratic_tetrahedron.hpp"
#include "resilin/element/quadratic_triangle.hpp"
#include "resilin/element/trilinear_hexahedron.hpp"

/// Elements whose law sees the volume change through its mean over the cell, so that they do not lock when
/// the solid is nearly incompressible: a constant pressure per cell. Source: Nagtegaal, Parks & Rice 1974;
/// Simo, Taylor & Pister 1985 (docs/theory/mean_volume.md).
namespace resilin {

/// Quadratic triangle, constant pressure (mixed displacement-pressure element).
struct QuadraticTriangleP0 : QuadraticTriangle {
  static constexpr std::string_view name = "P2P0";
  static constexpr std::string_view text = "quadratic triangle with a constant pressure (mixed)";
  static constexpr bool takes_mean_volume = true;
};

/// Quadratic tetrahedron, constant pressure.
struct QuadraticTetrahedronP0 : QuadraticTetrahedron {
  static constexpr std::string_view name = "P2P0";
  static constexpr std::string_view text = "quadratic tetrahedron with a constant pressure (mixed)";
  static constexpr bool takes_mean_volume = true;
};

/// Bilinear quadrilateral, constant pressure.
struct BilinearQuadrilateralP0 : BilinearQuadrilateral {
  static constexpr std::string_view name = "Q1P0";
  static constexpr std::string_view text = "bilinear quadrilateral with a constant pressure (mixed)";
  static constexpr bool takes_mean_volume = true;
};

/// Trilinear hexahedron, constant pressure.
struct TrilinearHexahedronP0 : TrilinearHexahedron {
  static constexpr std::string_view name = "Q1P0";
  static constexpr std::string_view text = "trilinear hexahedron with a constant pressure (mixed)";
  static constexpr bool takes_mean_volume = true;
};

/// Whether an element takes the mean volume ratio; one that says nothing of it does not.
template <class Element>
constexpr bool has_mean_volume = requires { requires Element::takes_mean_volume; };

}  // namespace resilin
