#pragma once

#include "resilin/core/types.hpp"

namespace resilin {

/// On which side of the line from a to b the point c is: 1 to the left, -1 to the right, 0 on it. Exact for
/// all doubles whose products neither overflow nor underflow.
///
/// The sign of a determinant is taken from its rounded value where an error bound allows, else from a sum of
/// doubles without any rounding. Source: Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and
/// Fast Robust Geometric Predicates".
int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// The sign of (b - a) . ((c - a) x (d - a)): 1 where b, c, d turn anticlockwise seen from a's far side,
/// -1 the other way, 0 for four points in one plane. Exact likewise.
int orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

}  // namespace resilin
