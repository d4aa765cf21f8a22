#include "resilin/mesh/shape_integrals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resilin/element/axisymmetric.hpp"

namespace resilin {
namespace {

/// Degree that the radius adds to integrals over rings.
int degree_of_radius(const ElementInfo& element) { return is_axisymmetric(element) ? element.degree : 0; }

}  // namespace

ShapeIntegrals::ShapeIntegrals(const ElementInfo& element)
    : element_(element),
      for_values_(sample(element.degree + element.jacobian_degree() + degree_of_radius(element))),
      for_products_(sample(2 * element.degree + element.jacobian_degree() + degree_of_radius(element))),
      for_affine_products_(sample(2 * element.degree)) {
  const auto n = static_cast<std::size_t>(element.num_nodes), dim = static_cast<std::size_t>(element.dim);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t k = 0; k < dim; ++k)
      if (element.nodes[a] == Vector3::Unit(static_cast<Eigen::Index>(k))) axis_ends_[k] = a;
  for_affine_.weights = {1};
  for_affine_.gradients.assign(for_values_.gradients.begin(),
                               for_values_.gradients.begin() + element.num_nodes * element.dim);
  reference_values_.assign(n, 0);
  reference_slopes_.assign(n * dim * n, 0);
  for (std::size_t q = 0; q < for_values_.weights.size(); ++q)
    for (std::size_t b = 0; b < n; ++b) {
      const double value = for_values_.weights[q] * for_values_.values[q * n + b];
      reference_values_[b] += value;
      for (std::size_t j = 0; j < n * dim; ++j)
        reference_slopes_[j * n + b] += value * for_values_.gradients[q * n * dim + j];
    }
}

ShapeIntegrals::Samples ShapeIntegrals::sample(int degree) const {
  Samples samples;
  const auto num_nodes = static_cast<std::size_t>(element_.num_nodes);
  const std::size_t num_gradients = num_nodes * static_cast<std::size_t>(element_.dim);
  for (const QuadraturePoint& point : rule_of_degree(element_.shape, degree).points) {
    samples.weights.push_back(point.weight);
    samples.values.resize(samples.values.size() + num_nodes);
    element_.shape_values(point.xi, std::span(samples.values).last(num_nodes));
    samples.gradients.resize(samples.gradients.size() + num_gradients);
    element_.shape_gradients(point.xi, std::span(samples.gradients).last(num_gradients));
  }
  return samples;
}

namespace {

/// Weights times det dX/dxi and, where there is room for them, times its cofactors, which are its slopes by
/// dX/dxi.
template <int dim>
void measure_points(std::span<const double> weights, std::span<const double> gradients,
                    std::span<const double> rest_positions, std::span<double> volumes,
                    std::span<double> cofactors) {
  using Nodes = Eigen::Map<const Eigen::Matrix<double, dim, Eigen::Dynamic>>;
  const auto n = static_cast<Eigen::Index>(rest_positions.size()) / dim;
  const Nodes X(rest_positions.data(), dim, n);
  for (std::size_t q = 0; q < weights.size(); ++q) {
    const Nodes dN(gradients.data() + static_cast<Eigen::Index>(q) * n * dim, dim, n);
    Matrix<dim> J = Matrix<dim>::Zero(), C;
    for (Eigen::Index a = 0; a < n; ++a) J += X.col(a) * dN.col(a).transpose();
    if constexpr (dim == 2)
      C << J(1, 1), -J(1, 0), -J(0, 1), J(0, 0);
    else
      C << J.col(1).cross(J.col(2)), J.col(2).cross(J.col(0)), J.col(0).cross(J.col(1));
    volumes[q] = weights[q] * J.col(0).dot(C.col(0));
    if (!cofactors.empty())
      Eigen::Map<Matrix<dim>>(cofactors.data() + q * std::size_t{dim} * dim) = weights[q] * C;
  }
}

}  // namespace

void ShapeIntegrals::measure(const Samples& samples, std::span<const double> rest_positions,
                             bool has_slopes) {
  const auto dim = static_cast<std::size_t>(element_.dim);
  volumes_.resize(samples.weights.size());
  cofactors_.resize(has_slopes ? dim * dim * samples.weights.size() : 0);
  const auto measure_in = element_.dim == 2 ? &measure_points<2> : &measure_points<3>;
  measure_in(samples.weights, samples.gradients, rest_positions, volumes_, cofactors_);
  if (!is_axisymmetric(element_)) return;
  const auto n = static_cast<std::size_t>(element_.num_nodes);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    double R = 0;
    for (std::size_t a = 0; a < n; ++a) R += samples.values[q * n + a] * rest_positions[a * dim];
    volumes_[q] *= 2 * std::numbers::pi * R;
  }
}

// d(det J) = cof J : dJ, dJ = sum_a dX_a dN_a/dxi^T
double ShapeIntegrals::change_of_volume(const Samples& samples, std::size_t point,
                                        std::span<const double> change) const {
  const auto dim = static_cast<std::size_t>(element_.dim);
  const double* cofactors = cofactors_.data() + point * dim * dim;
  const double* gradients = samples.gradients.data() + point * change.size();
  double sum = 0;
  for (std::size_t first = 0; first < change.size(); first += dim)
    for (std::size_t k = 0; k < dim; ++k)
      for (std::size_t i = 0; i < dim; ++i)
        sum += cofactors[k * dim + i] * change[first + i] * gradients[first + k];
  return sum;
}

void ShapeIntegrals::add_slopes_of_volume(const Samples& samples, std::size_t point, double factor,
                                          std::span<double> slopes) const {
  const auto dim = static_cast<std::size_t>(element_.dim);
  const double* cofactors = cofactors_.data() + point * dim * dim;
  const double* gradients = samples.gradients.data() + point * slopes.size();
  for (std::size_t first = 0; first < slopes.size(); first += dim)
    for (std::size_t k = 0; k < dim; ++k)
      for (std::size_t i = 0; i < dim; ++i)
        slopes[first + i] += factor * cofactors[k * dim + i] * gradients[first + k];
}

/// Every node stands where the cell's first corner and the corners along the reference axes put it.
bool ShapeIntegrals::is_affine(std::span<const double> rest_positions) const {
  if (is_axisymmetric(element_)) return false;  // the radius varies
  if (element_.jacobian_degree() == 0) return true;
  const auto dim = static_cast<std::size_t>(element_.dim);
  double size = 0, deviation = 0;
  for (std::size_t a = 0; a < element_.nodes.size(); ++a)
    for (std::size_t i = 0; i < dim; ++i) {
      const double origin = rest_positions[i];
      double expected = origin;
      for (std::size_t k = 0; k < dim; ++k)
        expected += element_.nodes[a][static_cast<Eigen::Index>(k)] *
                    (rest_positions[axis_ends_[k] * dim + i] - origin);
      size = std::max(size, std::abs(rest_positions[a * dim + i] - origin));
      deviation = std::max(deviation, std::abs(rest_positions[a * dim + i] - expected));
    }
  return deviation <= 1e-13 * size;
}

void ShapeIntegrals::of_values(std::span<const double> rest_positions, std::span<double> integrals) {
  if (is_affine(rest_positions)) {
    measure(for_affine_, rest_positions);
    for (std::size_t a = 0; a < integrals.size(); ++a) integrals[a] = volumes_[0] * reference_values_[a];
    return;
  }
  measure(for_values_, rest_positions);
  std::ranges::fill(integrals, 0.0);
  for (std::size_t q = 0; q < volumes_.size(); ++q)
    for (std::size_t a = 0; a < integrals.size(); ++a)
      integrals[a] += volumes_[q] * for_values_.values[q * integrals.size() + a];
}

void ShapeIntegrals::of_products(std::span<const double> rest_positions, std::span<double> integrals) {
  const Samples& samples = is_affine(rest_positions) ? for_affine_products_ : for_products_;
  measure(samples, rest_positions);
  const auto num_nodes = static_cast<std::size_t>(element_.num_nodes);
  std::ranges::fill(integrals, 0.0);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double* values = samples.values.data() + q * num_nodes;
    for (std::size_t a = 0; a < num_nodes; ++a)
      for (std::size_t b = a; b < num_nodes; ++b)
        integrals[a * num_nodes + b] += volumes_[q] * values[a] * values[b];
  }
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t b = 0; b < a; ++b) integrals[a * num_nodes + b] = integrals[b * num_nodes + a];
}

namespace {

double dot(const double* a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < b.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Where dX/dxi is constant, of its cofactors C and S = integral N_b dN_a/dxi_k at [a][k][b]:
// d(integral N_b) = sum_a,k (C^T dX_a)_k S_akb.
template <int dim>
void add_affine_change(std::span<const double> cofactors, std::span<const double> S,
                       std::span<const double> change, std::span<double> integrals) {
  const Eigen::Map<const Matrix<dim>> C(cofactors.data());
  const std::size_t n = integrals.size();
  for (std::size_t a = 0; a < n; ++a) {
    const Vector<dim> by_gradient = C.transpose() * Eigen::Map<const Vector<dim>>(change.data() + a * dim);
    for (std::size_t k = 0; k < dim; ++k)
      for (std::size_t b = 0; b < n; ++b)
        integrals[b] += by_gradient[static_cast<int>(k)] * S[(a * dim + k) * n + b];
  }
}

template <int dim>
void add_affine_slopes(std::span<const double> cofactors, std::span<const double> S,
                       std::span<const double> weights, std::span<double> slopes) {
  const Eigen::Map<const Matrix<dim>> C(cofactors.data());
  const std::size_t n = weights.size();
  for (std::size_t a = 0; a < n; ++a) {
    Vector<dim> by_gradient;
    for (std::size_t k = 0; k < dim; ++k)
      by_gradient[static_cast<int>(k)] = dot(S.data() + (a * dim + k) * n, weights);
    Eigen::Map<Vector<dim>>(slopes.data() + a * dim) += C * by_gradient;
  }
}

}  // namespace

void ShapeIntegrals::add_change_of_values(std::span<const double> rest_positions,
                                          std::span<const double> change, std::span<double> integrals) {
  const std::size_t n = integrals.size(), dim = change.size() / n;
  if (is_affine(rest_positions)) {
    measure(for_affine_, rest_positions, true);
    const auto add = dim == 2 ? &add_affine_change<2> : &add_affine_change<3>;
    add(cofactors_, reference_slopes_, change, integrals);
    return;
  }
  measure(for_values_, rest_positions, true);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double of_volume = change_of_volume(for_values_, q, change);
    for (std::size_t a = 0; a < n; ++a) integrals[a] += of_volume * for_values_.values[q * n + a];
  }
}

void ShapeIntegrals::add_slopes_of_values(std::span<const double> rest_positions,
                                          std::span<const double> weights, std::span<double> slopes) {
  const std::size_t n = weights.size(), dim = slopes.size() / n;
  if (is_affine(rest_positions)) {
    measure(for_affine_, rest_positions, true);
    const auto add = dim == 2 ? &add_affine_slopes<2> : &add_affine_slopes<3>;
    add(cofactors_, reference_slopes_, weights, slopes);
    return;
  }
  measure(for_values_, rest_positions, true);
  for (std::size_t q = 0; q < volumes_.size(); ++q)
    add_slopes_of_volume(for_values_, q, dot(for_values_.values.data() + q * n, weights), slopes);
}

void ShapeIntegrals::add_change_of_products(std::span<const double> rest_positions,
                                            std::span<const double> change, std::span<double> integrals) {
  const Samples& samples = for_products_;  // an affine cell does not stay so
  measure(samples, rest_positions, true);
  const auto n = static_cast<std::size_t>(element_.num_nodes);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double of_volume = change_of_volume(samples, q, change);
    const double* values = samples.values.data() + q * n;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) integrals[a * n + b] += of_volume * values[a] * values[b];
  }
}

void ShapeIntegrals::add_slopes_of_products(std::span<const double> rest_positions,
                                            std::span<const double> weights, std::span<double> slopes) {
  const Samples& samples = for_products_;  // an affine cell does not stay so
  measure(samples, rest_positions, true);
  const auto n = static_cast<std::size_t>(element_.num_nodes);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double* values = samples.values.data() + q * n;
    double by_volume = 0;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) by_volume += weights[a * n + b] * values[a] * values[b];
    add_slopes_of_volume(samples, q, by_volume, slopes);
  }
}

}  // namespace resilin
