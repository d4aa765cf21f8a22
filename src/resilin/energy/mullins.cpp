#include "resilin/energy/mullins.hpp"

#include <algorithm>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/viscoelastic.hpp"

namespace resilin {
namespace {

constexpr std::size_t softened_points_per_task = 2048;

}  // namespace

MullinsEnergy::MullinsEnergy(std::shared_ptr<ElasticEnergy> first, const Softening& softening)
    : first_(std::move(first)),
      isochoric_(first_->with_scaled_constants(
          relaxing_factors(first_->law(), ViscoelasticForm::simo, {.shape = 1, .volume = 0}))),
      softening_(softening) {}

Eigen::Index MullinsEnergy::num_history_values() const {
  return Eigen::Index{first_->num_cells()} * first_->num_points();
}

std::unique_ptr<Energy> MullinsEnergy::begin_stage_after(const VectorX& history, const Stage&) const {
  return std::make_unique<ElasticEnergy>(first_->with_softening(
      softening_, {history.data(), static_cast<std::size_t>(history.size())}, isochoric_));
}

HistoryTerm::Advance MullinsEnergy::advance(const VectorX& history, const VectorX& from, const VectorX& to,
                                            double) const {
  const std::vector<double> W = isochoric_.energy_densities(to), W_n = isochoric_.energy_densities(from),
                            volumes = first_->point_volumes();
  Advance result{.history = VectorX(history.size())};
  result.heat =
      parallel_sum<double>(W.size(), softened_points_per_task, [&](std::size_t begin, std::size_t end) {
        double heat = 0;
        for (std::size_t point = begin; point < end; ++point) {
          const double most = history[static_cast<Eigen::Index>(point)];
          result.history[static_cast<Eigen::Index>(point)] = std::max(most, W[point]);
          heat += volumes[point] * (softening_.energy(W[point], most) - softening_.energy(W_n[point], most) -
                                    (W[point] - W_n[point]));
        }
        return heat;
      });
  return result;
}

std::vector<Matrix<3>> MullinsEnergy::cauchy_stresses(const VectorX& x, const VectorX& history) const {
  std::vector<Matrix<3>> stresses = first_->cauchy_stresses(x);
  const std::vector<double> W = isochoric_.energy_densities(x);
  parallel_for(stresses.size(), softened_points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t point = begin; point < end; ++point) {
      Matrix<3>& sigma = stresses[point];
      const double eta = softening_.factor(W[point], history[static_cast<Eigen::Index>(point)]);
      const Matrix<3> pressure = sigma.trace() / 3 * Matrix<3>::Identity();
      sigma += (eta - 1) * (sigma - pressure);
    }
  });
  return stresses;
}

}  // namespace resilin
