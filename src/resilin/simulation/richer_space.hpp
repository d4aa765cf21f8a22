#pragma once

#include <array>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"

namespace resilin {

/// A hierarchical shape function of a cell that vanishes at the nodes of the element: on an edge, a facet or
/// the whole cell, which the corners name.
struct HierarchicalFunction {
  std::vector<int> corners;  ///< local numbers, as on the reference cell
  bool is_odd = false;       ///< changes its sign with the direction of its edge

  bool is_on_edge() const { return corners.size() == 2; }
};

/// The functions that raise an element's degree: quadratic ones for linear simplices, cubic ones for
/// quadratic simplices. Quadrilaterals and hexahedra get quadratic ones in each coordinate, and odd cubic
/// ones on their edges, which hold the warping of a twisted square. Source: Szabo & Babuska 1991, ch. 6.
class RicherSpace {
 public:
  explicit RicherSpace(const ElementInfo& element);

  const std::vector<HierarchicalFunction>& functions() const { return functions_; }
  /// Quadrature rule for products of their gradients with those of the element.
  const QuadratureRule& rule() const { return *rule_; }

  double value(std::size_t function, const Vector3& xi) const;
  Vector3 gradient(std::size_t function, const Vector3& xi) const;  ///< dN/dxi

  /// The integral of a function over a flat facet of which it is an edge or the inside, as a share of the
  /// facet's size.
  double share_of_facet(std::size_t function) const;

 private:
  struct Factor {
    double value, slope;
  };
  Factor factor_along(int axis, const HierarchicalFunction& function, double t) const;
  /// Barycentric coordinate of a corner of a simplex, and its constant gradient.
  double barycentric(int corner, const Vector3& xi) const;
  Vector3 barycentric_gradient(int corner) const;

  const ElementInfo& element_;
  const QuadratureRule* rule_;
  bool is_simplex_, is_cubic_;
  std::vector<HierarchicalFunction> functions_;
};

}  // namespace resilin
