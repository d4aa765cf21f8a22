#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/shared_indices.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/history_material.hpp"

namespace resilin {

/// Cells of a body that are of one material: their constitutive model, their density and their own term of
/// strain energy.
struct Domain {
  std::string name;  ///< name of the [[body.region]]; empty for the body's own material
  int region = -1;   ///< its number among the regions of the body's description; -1: the body's own material
  bool is_rigid = false;  ///< its nodes follow a rigid body (rigid_region.hpp)
  std::string law;        ///< name of the constitutive model; "rigid" where its nodes follow a rigid body
  /// Constants of its formula; per-cell ones by their mean
  std::vector<std::pair<std::string, double>> constants{};
  double density = 0;  ///< [kg/m^3]; 0 where a rigid body has the mass
  /// Numbers of its cells in the body, rising; null: all
  std::shared_ptr<const std::vector<Index>> numbers{};
  SharedIndices cells{};  ///< nodes of its cells, in the world's numbering
  /// Strain energy; of a viscoelastic material the instantaneous one
  std::shared_ptr<const ElasticEnergy> energy{};
  std::shared_ptr<const HistoryMaterial> history{};  ///< null for a material without internal variables

  const LawInfo& law_info() const { return energy->law(); }
  /// Strain energy [J]; of a viscoelastic material that of its long-term moduli.
  double stored_energy(const VectorX& x) const {
    return history ? history->stored_energy(x) : energy->value(x, {});
  }
  /// The number in the body of one of its cells.
  Index number_of(Index cell) const { return numbers ? (*numbers)[static_cast<std::size_t>(cell)] : cell; }
};

/// Constants of the law's formula that an energy was made with: once, or for one cell after another.
std::vector<double> constants_of(const ElasticEnergy& energy);

/// The domains of a body, one at least. All have one element and share the body's nodes. Sums, extremes and
/// lists are those of the whole body; lists by cell or by quadrature point are in the order of its cells.
class Domains {
 public:
  Domains() = default;
  explicit Domains(std::vector<Domain> all);

  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }
  std::size_t size() const { return all_.size(); }
  const Domain& operator[](std::size_t i) const { return all_[i]; }
  const Domain& front() const { return all_.front(); }
  /// Names of the constitutive models, each once.
  std::string laws() const;

  struct Place {
    std::size_t domain;
    Index cell;  ///< in the domain
  };
  Place place_of(Index cell) const;
  const Domain& of_cell(Index cell) const { return all_[place_of(cell).domain]; }
  Material material(Index cell) const;

  const ElementInfo& element() const { return front().energy->element(); }
  const QuadratureRule& quadrature() const { return front().energy->quadrature(); }
  Index num_points() const {
    return front().energy->num_points();
  }  ///< number of quadrature points of a cell
  Index num_cells() const { return num_cells_; }
  double total_rest_volume() const;

  bool have_history() const;  ///< internal variables, one of them at least
  bool have_rigid_ones() const;
  /// Rest volumes of all cells, zero in rigid domains [m^3]
  std::vector<double> deformable_volumes() const;
  double value(const VectorX& x) const;  ///< stored energy [J]
  double difference(const VectorX& from, const VectorX& to) const;
  /// The smallest J of all domains, as ElasticEnergy has it.
  ElasticEnergy::VolumeRatio min_volume_ratio(const VectorX& x) const;

  std::vector<double> rest_volumes() const;
  std::vector<double> point_volumes() const;
  std::vector<double> volume_ratios(const VectorX& x) const;
  std::vector<Matrix<3>> deformation_gradients(const VectorX& x) const;

  /// Entries of all cells, each of which has as many: `ask(domain)` gives those of a domain.
  template <class Ask>
  auto by_cell(const Ask& ask) const {
    auto first = ask(front());
    if (all_.size() == 1) return first;
    decltype(first) entries;
    for (std::size_t d = 0; d < all_.size(); ++d) {
      const auto own = d == 0 ? std::move(first) : ask(all_[d]);
      const auto count = static_cast<std::size_t>(all_[d].energy->num_cells());
      if (count == 0) continue;
      const std::size_t width = own.size() / count;
      entries.resize(width * static_cast<std::size_t>(num_cells_));
      for (std::size_t cell = 0; cell < count; ++cell)
        for (std::size_t k = 0; k < width; ++k)
          entries[static_cast<std::size_t>(all_[d].number_of(static_cast<Index>(cell))) * width + k] =
              own[cell * width + k];
    }
    return entries;
  }

 private:
  std::vector<Domain> all_;
  Index num_cells_ = 0;
  std::vector<Place> places_{};  ///< by cell of the body; empty with one domain
};

}  // namespace resilin
