#include "resilin/simulation/richer_space.hpp"

#include "resilin/mesh/cell_kind.hpp"

namespace resilin {
namespace {

/// Corners of the facets of a cell, or of the cell itself in the plane.
std::vector<std::vector<int>> faces_of(const ElementInfo& element) {
  std::vector<std::vector<int>> faces;
  if (element.dim == 2) {
    faces.emplace_back();
    for (int corner = 0; corner < element.num_corners(); ++corner) faces.back().push_back(corner);
    return faces;
  }
  for (const CellSide& side : cell_sides(cell_kind(element)))
    faces.emplace_back(side.corners().begin(), side.corners().end());
  return faces;
}

/// Fourteen points in a tetrahedron, of degree 5, in place of the 27 of the product rule of degree 4.
/// Source: Walkington 2000.
const QuadratureRule& fourteen_points() {
  static const QuadratureRule rule = [] {
    QuadratureRule made{.name = "14-point", .degree = 5, .points = {}};
    const double volume = size(CellShape::tetrahedron);
    for (const auto& [a, weight] : {std::pair{0.31088591926330060980, 0.11268792571801585080},
                                    std::pair{0.092735250310891226402, 0.073493043116361949544}}) {
      made.points.push_back({Vector3(a, a, a), weight * volume});
      for (int k = 0; k < 3; ++k) {
        Vector3 xi(a, a, a);
        xi[k] = 1 - 3 * a;
        made.points.push_back({xi, weight * volume});
      }
    }
    const double a = 0.045503704125649649492, b = 0.5 - a, weight = 0.042546020777081466438;
    for (int k = 0; k < 3; ++k) {
      Vector3 one(a, a, a), two(b, b, b);  // two of the four barycentric coordinates are b
      one[k] = b;
      two[k] = a;
      made.points.push_back({one, weight * volume});
      made.points.push_back({two, weight * volume});
    }
    return made;
  }();
  return rule;
}

}  // namespace

RicherSpace::RicherSpace(const ElementInfo& element)
    : element_(element),
      is_simplex_(is_simplex(element.shape)),
      is_cubic_(is_simplex_ && element.degree == 2) {
  rule_ = is_cubic_ && element.dim == 3 ? &fourteen_points()
                                        : &rule_of_degree(element.shape, is_simplex_ && !is_cubic_ ? 2 : 4);
  for (const std::array<int, 2>& edge : cell_edges(cell_kind(element)))
    functions_.push_back({{edge[0], edge[1]}, is_cubic_});
  if (is_simplex_ && !is_cubic_) return;
  for (std::vector<int>& face : faces_of(element)) functions_.push_back({std::move(face), false});
  if (!is_simplex_ && element.dim == 3) functions_.push_back({{0, 1, 2, 3, 4, 5, 6, 7}, false});
  if (is_simplex_) return;
  for (const std::array<int, 2>& edge : cell_edges(cell_kind(element)))
    functions_.push_back({{edge[0], edge[1]}, true});
}

/// Quadratic, or odd and cubic, along an axis in which the corners differ, linear along the others.
RicherSpace::Factor RicherSpace::factor_along(int axis, const HierarchicalFunction& function,
                                              double t) const {
  const std::vector<int>& corners = function.corners;
  const auto place = [&](int corner) { return element_.nodes[static_cast<std::size_t>(corner)][axis]; };
  for (const int corner : corners)
    if (place(corner) != place(corners.front())) {
      if (!function.is_odd) return {4 * t * (1 - t), 4 - 8 * t};
      const double sign = place(corners.front()) == 0 ? 10 : -10;
      return {sign * t * (1 - t) * (1 - 2 * t), sign * (1 - 6 * t + 6 * t * t)};
    }
  return place(corners.front()) == 0 ? Factor{1 - t, -1} : Factor{t, 1};
}

double RicherSpace::barycentric(int corner, const Vector3& xi) const {
  return corner == 0 ? 1 - xi.head(element_.dim).sum() : xi[corner - 1];
}

Vector3 RicherSpace::barycentric_gradient(int corner) const {
  Vector3 gradient = Vector3::Zero();
  if (corner == 0) {
    gradient.head(element_.dim).setConstant(-1);
  } else {
    gradient[corner - 1] = 1;
  }
  return gradient;
}

double RicherSpace::value(std::size_t function, const Vector3& xi) const {
  const std::vector<int>& corners = functions_[function].corners;
  if (is_simplex_) {
    if (corners.size() == 3)
      return 27 * barycentric(corners[0], xi) * barycentric(corners[1], xi) * barycentric(corners[2], xi);
    const double a = barycentric(corners[0], xi), b = barycentric(corners[1], xi);
    return is_cubic_ ? 10 * a * b * (a - b) : 4 * a * b;
  }
  double product = 1;
  for (int m = 0; m < element_.dim; ++m) product *= factor_along(m, functions_[function], xi[m]).value;
  return product;
}

Vector3 RicherSpace::gradient(std::size_t function, const Vector3& xi) const {
  const std::vector<int>& corners = functions_[function].corners;
  if (is_simplex_) {
    const double a = barycentric(corners[0], xi), b = barycentric(corners[1], xi);
    const Vector3 da = barycentric_gradient(corners[0]), db = barycentric_gradient(corners[1]);
    if (corners.size() == 3) {
      const double c = barycentric(corners[2], xi);
      return 27 * (b * c * da + a * c * db + a * b * barycentric_gradient(corners[2]));
    }
    return is_cubic_ ? Vector3(10 * ((2 * a * b - b * b) * da + (a * a - 2 * a * b) * db))
                     : Vector3(4 * (b * da + a * db));
  }
  Vector3 values = Vector3::Ones(), slopes = Vector3::Zero();
  for (int m = 0; m < element_.dim; ++m) {
    const Factor factor = factor_along(m, functions_[function], xi[m]);
    values[m] = factor.value;
    slopes[m] = factor.slope;
  }
  Vector3 gradient = Vector3::Zero();
  for (int m = 0; m < element_.dim; ++m) gradient[m] = slopes[m] * values[(m + 1) % 3] * values[(m + 2) % 3];
  return gradient;
}

double RicherSpace::share_of_facet(std::size_t function) const {
  const HierarchicalFunction& on = functions_[function];
  const bool facet_is_edge = element_.dim == 2;
  if (on.is_odd) return 0;
  if (is_simplex_) {
    if (!on.is_on_edge()) return 27.0 / 60;
    return facet_is_edge ? 2.0 / 3 : 1.0 / 3;
  }
  if (facet_is_edge) return 2.0 / 3;
  return on.is_on_edge() ? 1.0 / 3 : 4.0 / 9;
}

}  // namespace resilin
