#include "resilin/world/domain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/text.hpp"

namespace resilin {

Domains::Domains(std::vector<Domain> all) : all_(std::move(all)) {
  for (const Domain& domain : all_) num_cells_ += domain.energy->num_cells();
  if (all_.size() == 1) return;
  places_.resize(static_cast<std::size_t>(num_cells_));
  for (std::size_t d = 0; d < all_.size(); ++d)
    for (Index cell = 0; cell < all_[d].energy->num_cells(); ++cell)
      places_[static_cast<std::size_t>(all_[d].number_of(cell))] = {d, cell};
}

std::vector<double> constants_of(const ElasticEnergy& energy) {
  const std::size_t count = energy.law().constants.size();
  const auto size = static_cast<std::size_t>(energy.parameters().front().size);
  std::vector<double> constants;
  for (Index cell = 0; constants.size() < size && cell < energy.num_cells(); ++cell) {
    const Material material = energy.material(cell);
    constants.insert(constants.end(), material.constants.begin(),
                     material.constants.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return constants;
}

std::string Domains::laws() const {
  std::vector<std::string> names;
  for (const Domain& domain : all_)
    if (std::ranges::find(names, domain.law) == names.end()) names.push_back(domain.law);
  return join(names);
}

Domains::Place Domains::place_of(Index cell) const {
  return places_.empty() ? Place{0, cell} : places_[static_cast<std::size_t>(cell)];
}

Material Domains::material(Index cell) const {
  const auto [domain, own] = place_of(cell);
  return all_[domain].energy->material(own);
}

double Domains::total_rest_volume() const {
  double volume = 0;
  for (const Domain& domain : all_) volume += domain.energy->total_rest_volume();
  return volume;
}

bool Domains::have_history() const {
  return std::ranges::any_of(all_, [](const Domain& domain) { return domain.history != nullptr; });
}

bool Domains::have_rigid_ones() const { return std::ranges::any_of(all_, &Domain::is_rigid); }

std::vector<double> Domains::deformable_volumes() const {
  std::vector<double> volumes = rest_volumes();
  for (const Domain& domain : all_)
    for (Index cell = 0; domain.is_rigid && cell < domain.energy->num_cells(); ++cell)
      volumes[static_cast<std::size_t>(domain.number_of(cell))] = 0;
  return volumes;
}

double Domains::value(const VectorX& x) const {
  double sum = 0;
  for (const Domain& domain : all_) sum += domain.stored_energy(x);
  return sum;
}

double Domains::difference(const VectorX& from, const VectorX& to) const {
  double sum = 0;
  for (const Domain& domain : all_) sum += domain.energy->difference(from, to, {});
  return sum;
}

ElasticEnergy::VolumeRatio Domains::min_volume_ratio(const VectorX& x) const {
  ElasticEnergy::VolumeRatio least{std::numeric_limits<double>::infinity(), -1};
  for (std::size_t d = 0; d < all_.size(); ++d) {
    ElasticEnergy::VolumeRatio own = all_[d].energy->min_volume_ratio(x);
    if (own.cell >= 0) own.cell = all_[d].number_of(own.cell);
    if (d == 0 || own.ratio < least.ratio || std::isnan(own.ratio)) least = own;
    if (std::isnan(least.ratio)) break;
  }
  return least;
}

std::vector<double> Domains::rest_volumes() const {
  return by_cell([](const Domain& domain) { return domain.energy->rest_volumes(); });
}

std::vector<double> Domains::point_volumes() const {
  return by_cell([](const Domain& domain) { return domain.energy->point_volumes(); });
}

std::vector<double> Domains::volume_ratios(const VectorX& x) const {
  return by_cell([&x](const Domain& domain) { return domain.energy->volume_ratios(x); });
}

std::vector<Matrix<3>> Domains::deformation_gradients(const VectorX& x) const {
  return by_cell([&x](const Domain& domain) { return domain.energy->deformation_gradients(x); });
}

}  // namespace resilin
