#include "resilin/mesh/shape_integrals.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace resilin {
ShapeIntegrals::ShapeIntegrals(const ElementInfo& element)
    : element_(element),
      for_values_(sample(element.degree + element.jacobian_degree())),
      for_products_(sample(2 * element.degree + element.jacobian_degree())),
      for_affine_products_(sample(2 * element.degree)) {}

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

/// dX/dxi at a point; in 2D with the third direction of unit length.
Eigen::Matrix3d jacobian(std::size_t dim, std::size_t num_nodes, std::span<const double> rest_positions,
                         const double* gradients) {
  Eigen::Matrix3d dX_dxi = Eigen::Matrix3d::Zero();
  if (dim == 2) dX_dxi(2, 2) = 1;
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t k = 0; k < dim; ++k)
        dX_dxi(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) +=
            rest_positions[a * dim + i] * gradients[a * dim + k];
  return dX_dxi;
}

}  // namespace

void ShapeIntegrals::measure(const Samples& samples, std::span<const double> rest_positions) {
  const auto dim = static_cast<std::size_t>(element_.dim);
  const auto num_nodes = static_cast<std::size_t>(element_.num_nodes);
  volumes_.resize(samples.weights.size());
  for (std::size_t q = 0; q < volumes_.size(); ++q)
    volumes_[q] = samples.weights[q] *
                  jacobian(dim, num_nodes, rest_positions, samples.gradients.data() + q * num_nodes * dim)
                      .determinant();
}

/// d(det J)/dX_a = det J J^-T dN_a/dxi
void ShapeIntegrals::measure_slopes(const Samples& samples, std::span<const double> rest_positions) {
  const auto dim = static_cast<std::size_t>(element_.dim);
  const auto num_nodes = static_cast<std::size_t>(element_.num_nodes);
  volumes_.resize(samples.weights.size());
  slopes_.assign(samples.gradients.size(), 0.0);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double* gradients = samples.gradients.data() + q * num_nodes * dim;
    const Eigen::Matrix3d J = jacobian(dim, num_nodes, rest_positions, gradients);
    volumes_[q] = samples.weights[q] * J.determinant();
    const Eigen::Matrix3d inverse = J.inverse();
    for (std::size_t a = 0; a < num_nodes; ++a)
      for (std::size_t i = 0; i < dim; ++i)
        for (std::size_t k = 0; k < dim; ++k)
          slopes_[(q * num_nodes + a) * dim + i] +=
              volumes_[q] * gradients[a * dim + k] *
              inverse(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
  }
}

/// Every node stands where the cell's first corner and the corners along the reference axes put it.
bool ShapeIntegrals::is_affine(std::span<const double> rest_positions) const {
  const auto dim = static_cast<std::size_t>(element_.dim);
  std::array<const double*, 3> axis_ends{};
  for (std::size_t a = 0; a < element_.nodes.size(); ++a)
    for (std::size_t k = 0; k < dim; ++k)
      if (element_.nodes[a] == Vector3::Unit(static_cast<Eigen::Index>(k)))
        axis_ends[k] = rest_positions.data() + a * dim;
  double size = 0, deviation = 0;
  for (std::size_t a = 0; a < element_.nodes.size(); ++a)
    for (std::size_t i = 0; i < dim; ++i) {
      const double origin = rest_positions[i];
      double expected = origin;
      for (std::size_t k = 0; k < dim; ++k)
        expected += element_.nodes[a][static_cast<Eigen::Index>(k)] * (axis_ends[k][i] - origin);
      size = std::max(size, std::abs(rest_positions[a * dim + i] - origin));
      deviation = std::max(deviation, std::abs(rest_positions[a * dim + i] - expected));
    }
  return deviation <= 1e-13 * size;
}

void ShapeIntegrals::of_values(std::span<const double> rest_positions, std::span<double> integrals) {
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

}  // namespace

void ShapeIntegrals::add_change_of_values(std::span<const double> rest_positions,
                                          std::span<const double> change, std::span<double> integrals) {
  measure_slopes(for_values_, rest_positions);
  const std::size_t n = integrals.size();
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double of_volume = dot(slopes_.data() + q * change.size(), change);
    for (std::size_t a = 0; a < n; ++a) integrals[a] += of_volume * for_values_.values[q * n + a];
  }
}

void ShapeIntegrals::add_slopes_of_values(std::span<const double> rest_positions,
                                          std::span<const double> weights, std::span<double> slopes) {
  measure_slopes(for_values_, rest_positions);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double by_volume = dot(for_values_.values.data() + q * weights.size(), weights);
    for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] += by_volume * slopes_[q * slopes.size() + i];
  }
}

void ShapeIntegrals::add_change_of_products(std::span<const double> rest_positions,
                                            std::span<const double> change, std::span<double> integrals) {
  const Samples& samples = for_products_;  // an affine cell does not stay so
  measure_slopes(samples, rest_positions);
  const auto n = static_cast<std::size_t>(element_.num_nodes);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double of_volume = dot(slopes_.data() + q * change.size(), change);
    const double* values = samples.values.data() + q * n;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) integrals[a * n + b] += of_volume * values[a] * values[b];
  }
}

void ShapeIntegrals::add_slopes_of_products(std::span<const double> rest_positions,
                                            std::span<const double> weights, std::span<double> slopes) {
  const Samples& samples = for_products_;  // an affine cell does not stay so
  measure_slopes(samples, rest_positions);
  const auto n = static_cast<std::size_t>(element_.num_nodes);
  for (std::size_t q = 0; q < volumes_.size(); ++q) {
    const double* values = samples.values.data() + q * n;
    double by_volume = 0;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) by_volume += weights[a * n + b] * values[a] * values[b];
    for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] += by_volume * slopes_[q * slopes.size() + i];
  }
}

}  // namespace resilin
