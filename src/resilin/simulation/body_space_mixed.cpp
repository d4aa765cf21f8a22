// Terms that mixed elements add to the richer space: the pressure of a cell in place of those of its points,
// and linear pressures.

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <span>
#include <vector>

#include "resilin/core/determinant.hpp"
#include "resilin/material/volume_energy.hpp"
#include "resilin/simulation/body_space.hpp"

namespace resilin {
namespace {

/// J - 1 of F = 1 + H, without cancellation.
template <int dim>
double volume_change(const Eigen::Matrix<double, dim, dim>& H) {
  double change = H.trace() + H.determinant();
  if constexpr (dim == 3) change += cofactor<3>(H).trace();
  return change;
}

}  // namespace

template <int dim>
std::vector<double> BodySpace<dim>::replace_pressures(const Domain& domain, std::size_t first,
                                                      std::size_t last, const VectorX& x,
                                                      const StateBatch<double>& states, std::span<double> P,
                                                      std::span<double> A) const {
  constexpr std::size_t square = dim * dim;
  const ElasticEnergy& elastic = *domain.energy;
  const std::size_t per_cell = states.count / (last - first);
  const auto own_points = static_cast<std::size_t>(elastic.num_points());
  using Gradient = Eigen::Map<const Eigen::Matrix<double, dim, dim, Eigen::RowMajor>>;

  std::vector<double> j(states.count);
  for (std::size_t i = 0; i < states.count; ++i)
    j[i] = volume_change<dim>(Gradient(states.deformation_gradients + i * square));
  std::vector<double> means(last - first, 0.0);
  const std::vector<double> ratios = elastic.volume_ratios(x), volumes = elastic.point_volumes();
  for (std::size_t i = 0; i < means.size(); ++i) {
    double volume = 0;
    for (std::size_t q = (first + i) * own_points; q < (first + i + 1) * own_points; ++q) {
      means[i] += volumes[q] * (ratios[q] - 1);
      volume += volumes[q];
    }
    means[i] /= volume;
  }
  std::vector<Column> of_cells = states.constants;
  for (Column& column : of_cells) column.stride *= per_cell;
  const LawInfo& law = *states.law;
  const std::vector<VolumeSlopes> at_points = volume_slopes(law, j, states.constants, states.instruction_set),
                                  of_means = volume_slopes(law, means, of_cells, states.instruction_set);

  std::vector<double> stiffnesses;
  for (const VolumeSlopes& mean : of_means) stiffnesses.push_back(mean.stiffness);
  for (std::size_t i = 0; i < states.count; ++i) {
    const Eigen::Matrix<double, dim, dim> F =
        Eigen::Matrix<double, dim, dim>::Identity() + Gradient(states.deformation_gradients + i * square);
    const Eigen::Matrix<double, dim, dim, Eigen::RowMajor> cof = cofactor<dim>(F);
    const auto D = determinant_hessian<dim>(F.transpose());  // vec(F) by rows
    const double added = of_means[i / per_cell].pressure - at_points[i].pressure;
    for (std::size_t a = 0; a < square; ++a) {
      P[i * square + a] += added * cof.data()[a];
      for (std::size_t b = 0; b < square; ++b) {
        double& entry = A[(i * square + a) * square + b];
        entry -= at_points[i].stiffness * cof.data()[a] * cof.data()[b];
        entry += added * D.data()[b * square + a];
      }
    }
  }
  return stiffnesses;
}

/// With phi_k a linear coordinate of the reference cell less its mean, theta the mean of J, and b and G_k the
/// gradients of its integrals by the degrees of freedom:
///
///   K += d2U/dJ2 / V b b^T,    K_pk,. = G_k,    K_pk,pl = - int phi_k phi_l dV / d2U/dJ2,
///   r_pk = - int phi_k J dV
template <int dim>
void BodySpace<dim>::add_pressures(std::size_t cell, std::span<const PointGeometry> geometries,
                                   std::span<const Vector3> slopes, const double* H, double stiffness,
                                   double* residuals) {
  using Point = Eigen::Matrix<double, dim, 1>;
  is_convex_ = is_convex_ && stiffness > 0;
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const std::size_t num_functions = space_.functions().size(), count = rows_ / dim, n = columns_ / dim;
  const auto size = static_cast<Eigen::Index>(rows_ + columns_),
             pressure = static_cast<Eigen::Index>(num_functions) * dim;
  double volume = 0;
  Point mean = Point::Zero();
  for (std::size_t q = 0; q < points.size(); ++q) {
    volume += geometries[q].weight;
    mean += geometries[q].weight * points[q].xi.head<dim>();
  }
  mean /= volume;
  VectorX b = VectorX::Zero(size), slope(size);
  Eigen::Matrix<double, dim, Eigen::Dynamic> G = Eigen::Matrix<double, dim, Eigen::Dynamic>::Zero(dim, size);
  Square compliance = Square::Zero();
  slope.setZero();
  for (std::size_t q = 0; q < points.size(); ++q) {
    const PointGeometry& geometry = geometries[q];
    const Square gradient = Eigen::Map<const Eigen::Matrix<double, dim, dim, Eigen::RowMajor>>(
        H + q * static_cast<std::size_t>(dim * dim));
    const Square cof = cofactor<dim>(Square::Identity() + gradient);
    for (std::size_t f = 0; f < num_functions; ++f)
      slope.segment<dim>(static_cast<Eigen::Index>(f) * dim) =
          cof * (geometry.dxi_dX.transpose() * slopes[q * num_functions + f]).template head<dim>();
    for (std::size_t a = 0; a < n; ++a)
      slope.segment<dim>(static_cast<Eigen::Index>(count + a) * dim) =
          cof * Eigen::Map<const Point>(geometry.gradients.data() + a * dim);
    const Point phi = points[q].xi.head<dim>() - mean;
    b += geometry.weight * slope;
    G += geometry.weight * phi * slope.transpose();
    compliance += geometry.weight / stiffness * phi * phi.transpose();
    Eigen::Map<Point>(residuals + pressure) -= geometry.weight * volume_change<dim>(gradient) * phi;
  }
  Eigen::Map<RowMajor> K(matrices_.data() + cell * rows_ * (rows_ + columns_),
                         static_cast<Eigen::Index>(rows_), size);
  K.topRows(pressure) += stiffness / volume * b.head(pressure) * b.transpose();
  K.template middleRows<dim>(pressure) = G;
  K.block(0, pressure, pressure, dim) = G.leftCols(pressure).transpose();
  K.template block<dim, dim>(pressure, pressure) = -compliance;
}

template std::vector<double> BodySpace<2>::replace_pressures(const Domain& domain, std::size_t first,
                                                             std::size_t last, const VectorX& x,
                                                             const StateBatch<double>& states,
                                                             std::span<double> P, std::span<double> A) const;
template void BodySpace<2>::add_pressures(std::size_t cell, std::span<const PointGeometry> geometries,
                                          std::span<const Vector3> slopes, const double* H, double stiffness,
                                          double* residuals);
template std::vector<double> BodySpace<3>::replace_pressures(const Domain& domain, std::size_t first,
                                                             std::size_t last, const VectorX& x,
                                                             const StateBatch<double>& states,
                                                             std::span<double> P, std::span<double> A) const;
template void BodySpace<3>::add_pressures(std::size_t cell, std::span<const PointGeometry> geometries,
                                          std::span<const Vector3> slopes, const double* H, double stiffness,
                                          double* residuals);

}  // namespace resilin
