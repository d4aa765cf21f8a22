#include "resilin/element/quadrature.hpp"

#include <array>
#include <cmath>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

struct LineRule {
  std::vector<double> points, weights;
};

/// Gauss-Jacobi rule on [0, 1] with the weight (1 - x)^power, by the eigenvalues of the Jacobi matrix (Golub
/// & Welsch 1969). The recurrence is that of the Jacobi polynomials P^(power, 0) on [-1, 1].
LineRule gauss_jacobi(int count, int power) {
  Eigen::VectorXd diagonal(count), below(std::max(count - 1, 1));
  const double a = power;
  for (int n = 0; n < count; ++n) {
    const double s = 2 * n + a;
    diagonal[n] = n == 0 ? -a / (a + 2) : -a * a / (s * (s + 2));
    if (n > 0) below[n - 1] = 2 * n * (n + a) / (s * std::sqrt(s * s - 1));
  }
  LineRule rule;
  if (count == 1) {
    rule.points = {0.5 * (1 + diagonal[0])};
    rule.weights = {1 / (a + 1)};
    return rule;
  }
  const dense::Eigenpairs pairs = dense::tridiagonal_eigenpairs(diagonal, below);
  for (int n = 0; n < count; ++n) {
    const double first = pairs.vectors(0, n);
    rule.points.push_back(0.5 * (1 + pairs.values[n]));
    rule.weights.push_back(first * first / (a + 1));
  }
  return rule;
}

/// Product of `count` points in each direction on the collapsed cube: x = u, y = v (1 - u), z = w (1 - u) (1
/// - v).
std::vector<QuadraturePoint> simplex_product(int dim, int count) {
  const LineRule u = gauss_jacobi(count, dim - 1), v = gauss_jacobi(count, dim - 2);
  const LineRule w = dim == 3 ? gauss_jacobi(count, 0) : LineRule{{0}, {1}};
  std::vector<QuadraturePoint> points;
  for (std::size_t i = 0; i < u.points.size(); ++i)
    for (std::size_t j = 0; j < v.points.size(); ++j)
      for (std::size_t k = 0; k < w.points.size(); ++k) {
        const double x = u.points[i], y = v.points[j] * (1 - x), z = w.points[k] * (1 - x - y);
        points.push_back({Vector3(x, y, z), u.weights[i] * v.weights[j] * w.weights[k]});
      }
  return points;
}

std::vector<QuadraturePoint> cube_product(int dim, int count) {
  const LineRule line = gauss_jacobi(count, 0), none{{0}, {1}};
  const LineRule& third = dim == 3 ? line : none;
  std::vector<QuadraturePoint> points;
  for (std::size_t k = 0; k < third.points.size(); ++k)
    for (std::size_t j = 0; j < line.points.size(); ++j)
      for (std::size_t i = 0; i < line.points.size(); ++i)
        points.push_back({Vector3(line.points[i], line.points[j], third.points[k]),
                          line.weights[i] * line.weights[j] * third.weights[k]});
  return points;
}

/// Degree 2 with dim + 1 points, each on the way from the centre to a corner.
std::vector<QuadraturePoint> simplex_degree_2(int dim) {
  const double b = dim == 2 ? 1.0 / 6 : (5 - std::sqrt(5.0)) / 20, a = 1 - dim * b;
  const double weight = (dim == 2 ? 0.5 : 1.0 / 6) / (dim + 1);
  std::vector<QuadraturePoint> points;
  for (int corner = 0; corner <= dim; ++corner) {
    Vector3 xi(b, b, dim == 3 ? b : 0);
    if (corner > 0) xi[corner - 1] = a;
    points.push_back({xi, weight});
  }
  return points;
}

std::vector<QuadratureRule> make_rules(CellShape shape) {
  const int dim = dimension(shape);
  const bool is_plane = dim == 2;
  switch (family(shape)) {
    case ShapeFamily::simplices:
      return {{"1-point", 1, simplex_product(dim, 1)},
              {is_plane ? "3-point" : "4-point", 2, simplex_degree_2(dim)},
              {is_plane ? "4-point" : "8-point", 3, simplex_product(dim, 2)},
              {is_plane ? "9-point" : "27-point", 5, simplex_product(dim, 3)},
              {"exact", 11, simplex_product(dim, 6)}};
    case ShapeFamily::cubes:
      break;
  }
  return {{"1-point", 1, cube_product(dim, 1)},
          {is_plane ? "4-point" : "8-point", 3, cube_product(dim, 2)},
          {is_plane ? "9-point" : "27-point", 5, cube_product(dim, 3)},
          {"exact", 11, cube_product(dim, 6)}};
}

}  // namespace

double size(CellShape shape) {
  switch (shape) {
    case CellShape::triangle:
      return 0.5;
    case CellShape::tetrahedron:
      return 1.0 / 6;
    case CellShape::quadrilateral:
    case CellShape::hexahedron:
      break;
  }
  return 1;
}

const std::vector<QuadratureRule>& quadrature_rules(CellShape shape) {
  static const std::array<std::vector<QuadratureRule>, 4> rules = {
      make_rules(CellShape::triangle), make_rules(CellShape::quadrilateral),
      make_rules(CellShape::tetrahedron), make_rules(CellShape::hexahedron)};
  return rules[static_cast<std::size_t>(shape)];
}

const QuadratureRule& rule_of_degree(CellShape shape, int degree) {
  const std::vector<QuadratureRule>& rules = quadrature_rules(shape);
  for (const QuadratureRule& rule : rules)
    if (rule.degree >= degree) return rule;
  return rules.back();
}

}  // namespace resilin
