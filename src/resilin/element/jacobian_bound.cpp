#include "resilin/element/jacobian_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "resilin/core/dense.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

using Exponents =
    std::array<int, 4>;  ///< exponents of the barycentric coordinates, or of a cube's coordinates

double binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

/// Bernstein polynomials of one degree on a reference cell.
struct BernsteinBasis {
  CellShape shape;
  bool is_simplex_basis;
  int dim;
  int degree;
  std::vector<Exponents> exponents;
  std::vector<Vector3> points;       ///< one for each coefficient
  Eigen::MatrixXd from_values;       ///< coefficients from values at the points
  std::vector<std::size_t> corners;  ///< coefficients that are values at corners

  BernsteinBasis(CellShape of_shape, int of_degree);

  double value(std::size_t which, const Vector3& xi) const {
    const Exponents& a = exponents[which];
    double product = 1;
    if (!is_simplex_basis) {
      for (int k = 0; k < dim; ++k) {
        const int e = a[static_cast<std::size_t>(k)];
        product *= binomial(degree, e) * std::pow(xi[k], e) * std::pow(1 - xi[k], degree - e);
      }
      return product;
    }
    int left = degree;
    for (int k = 0; k <= dim; ++k) {
      const int e = a[static_cast<std::size_t>(k)];
      const double L = k == 0 ? 1 - xi.sum() : xi[k - 1];
      product *= binomial(left, e) * std::pow(L, e);
      left -= e;
    }
    return product;
  }

  std::size_t find(const Exponents& wanted) const {
    return static_cast<std::size_t>(std::ranges::find(exponents, wanted) - exponents.begin());
  }

 private:
  void add(const Exponents& a, const Vector3& sum, bool is_corner) {
    if (is_corner) corners.push_back(exponents.size());
    exponents.push_back(a);
    points.push_back(degree == 0 ? Vector3(Vector3::Zero()) : Vector3(sum / degree));
  }
};

BernsteinBasis::BernsteinBasis(CellShape of_shape, int of_degree)
    : shape(of_shape), is_simplex_basis(is_simplex(shape)), dim(dimension(shape)), degree(of_degree) {
  for (int c = 0; c <= (dim == 3 ? degree : 0); ++c)
    for (int b = 0; b <= degree; ++b)
      for (int a = 0; a <= degree; ++a) {
        const int rest = degree - a - b - c;
        if (is_simplex_basis && rest < 0) continue;
        const auto is_end = [this](int e) { return e == 0 || e == degree; };
        const bool is_corner =
            is_simplex_basis ? std::max({a, b, c, rest}) == degree : is_end(a) && is_end(b) && is_end(c);
        add(is_simplex_basis ? Exponents{rest, a, b, c} : Exponents{a, b, c, 0}, Vector3(a, b, c), is_corner);
      }
  const auto count = static_cast<Eigen::Index>(exponents.size());
  Eigen::MatrixXd values(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      values(i, j) = value(static_cast<std::size_t>(j), points[static_cast<std::size_t>(i)]);
  from_values = dense::inverse(values);
}

/// A basis for each shape and degree of det dx/dxi that elements of the catalogue have.
std::vector<BernsteinBasis> bases_of_elements() {
  std::vector<BernsteinBasis> bases;
  for (const ElementInfo* element : elements()) {
    const auto is_its = [element](const BernsteinBasis& basis) {
      return basis.shape == element->shape && basis.degree == element->jacobian_degree();
    };
    if (std::ranges::none_of(bases, is_its)) bases.emplace_back(element->shape, element->jacobian_degree());
  }
  return bases;
}

/// The basis in which det dx/dxi of an element lies.
const BernsteinBasis& basis_of(const ElementInfo& element) {
  static const std::vector<BernsteinBasis> bases = bases_of_elements();
  const int degree = element.jacobian_degree();
  return *std::ranges::find_if(bases, [&](const BernsteinBasis& basis) {
    return basis.shape == element.shape && basis.degree == degree;
  });
}

/// A part of the reference cell, by its corners (simplex) or its lowest and highest corner, and the
/// determinant's coefficients on it.
struct Part {
  std::array<Vector3, 4> corners;
  std::vector<double> coefficients;
};

/// De Casteljau: the coefficients on a half, whose corner `moved` has gone to the middle of its edge to
/// `kept`. On a cube `kept` and `moved` are the ends of coordinate `axis`.
std::vector<double> on_half(const BernsteinBasis& basis, const std::vector<double>& c, std::size_t kept,
                            std::size_t moved) {
  std::vector<double> half(c.size(), 0.0);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const int e = basis.exponents[i][moved];
    for (int l = 0; l <= e; ++l) {
      Exponents from = basis.exponents[i];
      from[moved] -= l;
      from[kept] += l;
      half[i] += binomial(e, l) / std::pow(2.0, e) * c[basis.find(from)];
    }
  }
  return half;
}

std::vector<double> on_cube_half(const BernsteinBasis& basis, const std::vector<double>& c, std::size_t axis,
                                 bool is_upper) {
  std::vector<double> half(c.size(), 0.0);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const int place = basis.exponents[i][axis], e = is_upper ? basis.degree - place : place;
    for (int l = 0; l <= e; ++l) {
      Exponents from = basis.exponents[i];
      from[axis] = is_upper ? place + l : l;
      half[i] += binomial(e, l) / std::pow(2.0, e) * c[basis.find(from)];
    }
  }
  return half;
}

std::array<Part, 2> halves(const BernsteinBasis& basis, const Part& part) {
  std::array<Part, 2> result = {part, part};
  if (!basis.is_simplex_basis) {
    Eigen::Index axis = 0;
    (part.corners[1] - part.corners[0]).maxCoeff(&axis);
    const double middle = 0.5 * (part.corners[0][axis] + part.corners[1][axis]);
    result[0].corners[1][axis] = result[1].corners[0][axis] = middle;
    for (const bool is_upper : {false, true})
      result[is_upper ? 1 : 0].coefficients =
          on_cube_half(basis, part.coefficients, static_cast<std::size_t>(axis), is_upper);
    return result;
  }
  std::size_t first = 0, second = 1;
  double longest = 0;
  const auto num_corners = static_cast<std::size_t>(basis.dim) + 1;
  for (std::size_t i = 0; i < num_corners; ++i)
    for (std::size_t j = i + 1; j < num_corners; ++j) {
      const double length = (part.corners[i] - part.corners[j]).squaredNorm();
      if (length <= longest) continue;
      longest = length;
      first = i;
      second = j;
    }
  const Vector3 middle = 0.5 * (part.corners[first] + part.corners[second]);
  result[0].corners[second] = result[1].corners[first] = middle;
  result[0].coefficients = on_half(basis, part.coefficients, first, second);
  result[1].coefficients = on_half(basis, part.coefficients, second, first);
  return result;
}

/// Where a coefficient that is the value at a corner has its place in the reference cell.
Vector3 place_of(const BernsteinBasis& basis, const Part& part, std::size_t coefficient) {
  const Exponents& a = basis.exponents[coefficient];
  Vector3 place = Vector3::Zero();
  if (basis.is_simplex_basis) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(basis.dim); ++k)
      if (a[k] == basis.degree) return part.corners[k];
    return place;
  }
  for (int k = 0; k < basis.dim; ++k) place[k] = part.corners[a[static_cast<std::size_t>(k)] == 0 ? 0 : 1][k];
  return place;
}

std::array<Vector3, 4> reference_corners(const ElementInfo& element) {
  const Vector3 last(1, 1, element.dim == 3 ? 1 : 0);
  if (!is_simplex(element.shape)) return {Vector3::Zero(), last, Vector3::Zero(), Vector3::Zero()};
  return {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
}

}  // namespace

double jacobian(const ElementInfo& element, const Vector3& xi, std::span<const double> positions) {
  const auto dim = static_cast<std::size_t>(element.dim), n = static_cast<std::size_t>(element.num_nodes);
  std::array<double, 3 * max_element_nodes> gradients;
  element.shape_gradients(xi, std::span(gradients).first(n * dim));
  Eigen::Matrix3d dx_dxi = Eigen::Matrix3d::Zero();
  if (dim == 2) dx_dxi(2, 2) = 1;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t k = 0; k < dim; ++k)
        dx_dxi(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) +=
            positions[a * dim + i] * gradients[a * dim + k];
  return dx_dxi.determinant();
}

JacobianSign jacobian_sign(const ElementInfo& element, std::span<const double> positions) {
  using Kind = JacobianSign::Kind;
  constexpr std::size_t most_parts = 4096;
  const BernsteinBasis& basis = basis_of(element);
  Eigen::VectorXd values(static_cast<Eigen::Index>(basis.points.size()));
  for (std::size_t i = 0; i < basis.points.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = jacobian(element, basis.points[i], positions);
  const Eigen::VectorXd coefficients = basis.from_values * values;
  const double round_off = 64 * std::numeric_limits<double>::epsilon() * coefficients.cwiseAbs().maxCoeff();

  std::vector<Part> open = {
      {reference_corners(element), std::vector<double>(coefficients.begin(), coefficients.end())}};
  JacobianSign result{Kind::positive, std::numeric_limits<double>::infinity(), Vector3::Zero()};
  for (std::size_t examined = 0; !open.empty(); ++examined) {
    const Part part = std::move(open.back());
    open.pop_back();
    for (const std::size_t corner : basis.corners)
      if (!(part.coefficients[corner] > 0))
        return {Kind::not_positive, part.coefficients[corner], place_of(basis, part, corner)};
    const double least = *std::ranges::min_element(part.coefficients);
    if (least > round_off) {
      result.value = std::min(result.value, least);
      continue;
    }
    if (examined == most_parts || least > -round_off)
      return {Kind::unknown, part.coefficients[basis.corners[0]], place_of(basis, part, basis.corners[0])};
    for (Part& half : halves(basis, part)) open.push_back(std::move(half));
  }
  return result;
}

}  // namespace resilin
