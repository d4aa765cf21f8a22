#pragma once

#include <span>

#include "resilin/element/element.hpp"

namespace resilin {

/// Bounds of the Jacobian determinant det dx/dxi of a cell, a polynomial of xi.
struct JacobianSign {
  enum class Kind {
    positive,      ///< everywhere: shown by a bound, not by samples
    not_positive,  ///< at `xi`
    unknown        ///< zero up to rounding somewhere near `xi`: neither could be shown
  };
  Kind kind;
  double value;  ///< lower bound when positive, else det dx/dxi at `xi` [m^3], in 2D [m^2]
  Vector3 xi;    ///< reference coordinates
};

/// Decides whether a cell with these node positions (dim numbers each, in the element's node order) is turned
/// inverted anywhere.
///
/// The determinant lies between its least and largest Bernstein coefficients, and those at corners are
/// values; where they differ in sign the reference cell is halved, and so on. Cost without halving: one
/// determinant for each coefficient (20 for a quadratic tetrahedron). Source: Johnen, Remacle & Geuzaine
/// 2013, "Geometrical validity of curvilinear finite elements".
JacobianSign jacobian_sign(const ElementInfo& element, std::span<const double> positions);

/// det dx/dxi at one point.
double jacobian(const ElementInfo& element, const Vector3& xi, std::span<const double> positions);

}  // namespace resilin
