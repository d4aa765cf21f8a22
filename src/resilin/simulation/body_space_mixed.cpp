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
void BodySpace<dim>::add_pressures(std::size_t cell, const Batch& batch, std::size_t point, double stiffness,
                                   double* residuals) {
  is_convex_ = is_convex_ && stiffness > 0;
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const auto count = static_cast<Eigen::Index>(num_functions()), n = static_cast<Eigen::Index>(num_nodes());
  double volume = 0;
  Point mean = Point::Zero();
  for (std::size_t q = 0; q < points.size(); ++q) {
    volume += batch.weights[point + q];
    mean += batch.weights[point + q] * points[q].xi.head<dim>();
  }
  mean /= volume;
  Pressures& made = pressures_[cell];
  made.stiffness = stiffness / volume;
  made.volume.setZero((count + n) * dim);
  made.G.setZero(dim, (count + n) * dim);
  made.compliance.setZero();
  VectorX slope((count + n) * dim);
  for (std::size_t q = 0; q < points.size(); ++q) {
    const double weight = batch.weights[point + q];
    const Square gradient = Eigen::Map<const Tensor>(batch.H.data() + (point + q) * square);
    const Square push = cofactor<dim>(Square::Identity() + gradient) * batch.dxi_dX[point + q].transpose();
    const auto row = static_cast<Eigen::Index>(q) * dim;
    for (Eigen::Index f = 0; f < count; ++f)
      slope.segment<dim>(f * dim) = push * slopes_.template block<dim, 1>(row, f);
    for (Eigen::Index a = 0; a < n; ++a)
      slope.segment<dim>((count + a) * dim) = push * nodal_slopes_.template block<dim, 1>(row, a);
    const Point phi = points[q].xi.head<dim>() - mean;
    made.volume += weight * slope;
    made.G += weight * phi * slope.transpose();
    made.compliance += weight / stiffness * phi * phi.transpose();
    Eigen::Map<Point>(residuals + count * dim) -= weight * volume_change<dim>(gradient) * phi;
  }
}

template std::vector<double> BodySpace<2>::replace_pressures(const Domain& domain, std::size_t first,
                                                             std::size_t last, const VectorX& x,
                                                             const StateBatch<double>& states,
                                                             std::span<double> P, std::span<double> A) const;
template void BodySpace<2>::add_pressures(std::size_t cell, const Batch& batch, std::size_t point,
                                          double stiffness, double* residuals);
template std::vector<double> BodySpace<3>::replace_pressures(const Domain& domain, std::size_t first,
                                                             std::size_t last, const VectorX& x,
                                                             const StateBatch<double>& states,
                                                             std::span<double> P, std::span<double> A) const;
template void BodySpace<3>::add_pressures(std::size_t cell, const Batch& batch, std::size_t point,
                                          double stiffness, double* residuals);

}  // namespace resilin
