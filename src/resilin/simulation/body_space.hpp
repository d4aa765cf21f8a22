#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/material/batch.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/simulation/distributed_loads.hpp"
#include "resilin/simulation/richer_space.hpp"
#include "resilin/simulation/space_error.hpp"

namespace resilin {

/// The richer space on a body of one domain: which functions there are, their residual, and the stiffness
/// that couples them with one another and with the element's own unknowns, cell by cell.
template <int dim>
class BodySpace {
 public:
  BodySpace(const World& world, const Body& body)
      : world_(world), body_(body), space_(body.domains.element()) {
    const std::vector<Index>& nodes = body.cells;
    const auto n = static_cast<std::size_t>(body_.domains.element().num_nodes), count = num_local();
    std::vector<std::pair<Key, std::size_t>> keys;
    for (Index cell = 0; cell < num_cells(); ++cell)
      for (std::size_t f = 0; f < count; ++f) {
        if (f == space_.functions().size()) {
          keys.emplace_back(Key{pressures, cell, -1, -1}, keys.size());
          continue;
        }
        std::vector<Index> corners;
        for (const int corner : space_.functions()[f].corners)
          corners.push_back(nodes[static_cast<std::size_t>(cell) * n + static_cast<std::size_t>(corner)]);
        Key key = corners.size() > 4 ? Key{inside, cell, -1, -1} : key_of(corners);
        if (space_.functions()[f].is_odd) key[3] = odd;
        keys.emplace_back(key, keys.size());
      }
    std::ranges::sort(keys);
    numbers_.resize(keys.size());
    for (const auto& [key, place] : keys) {
      if (keys_.empty() || keys_.back() != key) {
        keys_.push_back(key);
        locals_.push_back(place % count);
      }
      numbers_[place] = static_cast<Index>(keys_.size() - 1);
    }
    signs_.assign(keys.size(), 1);
    for (std::size_t place = 0; place < signs_.size(); ++place) {
      if (place % count == space_.functions().size()) continue;
      const HierarchicalFunction& function = space_.functions()[place % count];
      const Index* const corners = nodes.data() + place / count * n;
      if (function.is_odd && corners[function.corners[0]] > corners[function.corners[1]]) signs_[place] = -1;
    }
  }

  Index num_cells() const { return body_.domains.num_cells(); }
  Eigen::Index num_unknowns() const { return static_cast<Eigen::Index>(keys_.size()) * dim; }
  /// The element keeps a pressure. The richer one has `dim` more in each cell, linear ones with no mean.
  bool is_mixed() const { return body_.domains.element().has_mean_volume; }
  double bytes() const {
    const double rows = static_cast<double>(num_local()) * dim;
    return 8 * rows * (rows + dim * body_.domains.element().num_nodes) * num_cells();
  }

  /// Functions of facets that one support holds, or that are in contact, do not move. A facet between two
  /// supports is free.
  void fix(const VectorX& contact_forces) {
    is_fixed_.assign(static_cast<std::size_t>(num_unknowns()), 0);
    const CellBlock facets = boundary({.kind = body_.cell_kind, .nodes = body_.cells}).facets;
    const auto num_corners = static_cast<std::size_t>(resilin::num_corners(facets.kind));
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> corners = facets.cell(facet).first(num_corners);
      std::array<bool, dim> is_fixed{};
      is_fixed.fill(true);
      bool is_touched = false;
      for (const Index corner : corners)
        for (int k = 0; k < dim; ++k) {
          const Eigen::Index unknown = Eigen::Index{corner} * dim + k;
          const std::int32_t support = world_.support_of[static_cast<std::size_t>(unknown)];
          is_fixed[k] = is_fixed[k] && support >= 0 &&
                        support == world_.support_of[static_cast<std::size_t>(corners[0]) * dim + k];
          is_touched = is_touched || contact_forces[unknown] != 0;
        }
      for_functions_of(corners, [&](Index function) {
        for (int k = 0; k < dim; ++k)
          if (is_fixed[k] || is_touched) is_fixed_[static_cast<std::size_t>(function * dim + k)] = 1;
      });
    }
  }

  /// Makes the matrices and the residual at positions x. False where the law is outside its domain, or its
  /// volumetric energy is not convex and pressures have no compliance.
  bool form(const VectorX& x, const DistributedLoads& loads, const Vector3& body_force) {
    residual_.setZero(num_unknowns());
    is_convex_ = true;
    rows_ = num_local() * dim;
    columns_ = static_cast<std::size_t>(body_.domains.element().num_nodes) * dim;
    matrices_.assign(static_cast<std::size_t>(num_cells()) * rows_ * (rows_ + columns_), 0.0);
    std::vector<double> cell_residuals(static_cast<std::size_t>(num_cells()) * rows_, 0.0);
    inverses_.assign(keys_.size(), Square::Zero());
    for (const Domain& domain : body_.domains) {
      const auto count = static_cast<std::size_t>(domain.energy->num_cells());
      for (std::size_t first = 0; first < count; first += cells_per_batch)
        form_cells(domain, first, std::min(first + cells_per_batch, count), x, loads,
                   body_force + domain.density * loads.acceleration, cell_residuals);
    }
    gather(cell_residuals, residual_);
    for (const FacetForce& facet : loads.facets) add_facet(facet);
    set_fixed_to_zero(residual_);
    form_preconditioner();
    return is_convex_ && residual_.allFinite();
  }

  /// The energies that stresses and pressures of a step give, of which the entries are `by_unknown`.
  SpaceError::Change change(const Eigen::Ref<const VectorX>& by_unknown) const {
    SpaceError::Change sums;
    for (std::size_t i = 0; i < keys_.size(); ++i)
      (keys_[i][0] == pressures ? sums.by_pressures : sums.by_displacements) +=
          by_unknown.segment<dim>(static_cast<Eigen::Index>(i) * dim).sum();
    return sums;
  }
  const VectorX& residual() const { return residual_; }

  void set_fixed_to_zero(Eigen::Ref<VectorX> values) const {
    for (Eigen::Index i = 0; i < values.size(); ++i)
      if (is_fixed_[static_cast<std::size_t>(i)] != 0) values[i] = 0;
  }

  /// image = K_bb v, forces += K_hb v.
  void apply(const Eigen::Ref<const VectorX>& v, Eigen::Ref<VectorX> image, VectorX& forces) const {
    const auto n = columns_ / dim;
    std::vector<double> own(static_cast<std::size_t>(num_cells()) * rows_),
        others(static_cast<std::size_t>(num_cells()) * columns_);
    for_each_cell([&](std::size_t cell) {
      const VectorX local = local_values(cell, v);
      const auto K = matrix(cell);
      Eigen::Map<VectorX>(own.data() + cell * rows_, static_cast<Eigen::Index>(rows_)) =
          K.leftCols(static_cast<Eigen::Index>(rows_)) * local;
      Eigen::Map<VectorX>(others.data() + cell * columns_, static_cast<Eigen::Index>(columns_)) =
          K.rightCols(static_cast<Eigen::Index>(columns_)).transpose() * local;
    });
    VectorX sum = VectorX::Zero(num_unknowns());
    gather(own, sum);
    set_fixed_to_zero(sum);
    image = sum;
    const std::vector<Index>& nodes = body_.cells;
    for (std::size_t i = 0; i < others.size(); i += dim)
      forces.segment(Eigen::Index{nodes[i / columns_ * n + i % columns_ / dim]} * dim, dim) +=
          Eigen::Map<const Eigen::Matrix<double, dim, 1>>(others.data() + i);
  }

  /// image -= K_bh z.
  void subtract_coupling(const VectorX& z, Eigen::Ref<VectorX> image) const {
    const auto n = columns_ / dim;
    std::vector<double> own(static_cast<std::size_t>(num_cells()) * rows_);
    const std::vector<Index>& nodes = body_.cells;
    for_each_cell([&](std::size_t cell) {
      VectorX local(static_cast<Eigen::Index>(columns_));
      for (std::size_t a = 0; a < n; ++a)
        local.segment<dim>(static_cast<Eigen::Index>(a) * dim) =
            z.segment<dim>(Eigen::Index{nodes[cell * n + a]} * dim);
      Eigen::Map<VectorX>(own.data() + cell * rows_, static_cast<Eigen::Index>(rows_)) =
          matrix(cell).rightCols(static_cast<Eigen::Index>(columns_)) * local;
    });
    VectorX sum = VectorX::Zero(num_unknowns());
    gather(own, sum);
    set_fixed_to_zero(sum);
    image -= sum;
  }

  void precondition(const Eigen::Ref<const VectorX>& r, Eigen::Ref<VectorX> z) const {
    for (std::size_t f = 0; f < inverses_.size(); ++f)
      z.segment<dim>(static_cast<Eigen::Index>(f) * dim) =
          inverses_[f] * r.segment<dim>(static_cast<Eigen::Index>(f) * dim);
    VectorX fixed = z;
    set_fixed_to_zero(fixed);
    z = fixed;
  }

 private:
  static constexpr std::size_t cells_per_chunk = 64, cells_per_batch = 2048;

  /// Corners of an edge or a facet in rising order, -1 after the last one; for an odd function of an edge,
  /// `odd` at the end.
  using Key = std::array<Index, 4>;
  static constexpr Index odd = -2;
  /// In place of the corners: functions of the inside of a cell, whose number follows.
  static constexpr Index inside = -2, pressures = -3;

  static Key key_of(std::span<const Index> corners) {
    Key key{-1, -1, -1, -1};
    const std::size_t count = std::min(corners.size(), key.size());
    std::copy_n(corners.begin(), count, key.begin());
    std::sort(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(count));
    return key;
  }

  using Square = Eigen::Matrix<double, dim, dim>;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Map<const RowMajor> matrix(std::size_t cell) const {
    return {matrices_.data() + cell * rows_ * (rows_ + columns_), static_cast<Eigen::Index>(rows_),
            static_cast<Eigen::Index>(rows_ + columns_)};
  }

  void for_each_cell(const auto& body) const {
    parallel_for(static_cast<std::size_t>(num_cells()), cells_per_chunk,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t cell = begin; cell < end; ++cell) body(cell);
                 });
  }

  VectorX local_values(std::size_t cell, const Eigen::Ref<const VectorX>& v) const {
    VectorX local(static_cast<Eigen::Index>(rows_));
    const std::size_t count = rows_ / dim;
    for (std::size_t f = 0; f < count; ++f)
      local.segment<dim>(static_cast<Eigen::Index>(f) * dim) =
          signs_[cell * count + f] * v.segment<dim>(Eigen::Index{numbers_[cell * count + f]} * dim);
    return local;
  }

  /// Sums what each cell has for its functions, in the order of the cells.
  void gather(const std::vector<double>& by_cell, VectorX& sum) const {
    for (std::size_t place = 0; place < numbers_.size(); ++place)
      sum.segment<dim>(Eigen::Index{numbers_[place]} * dim) +=
          signs_[place] * Eigen::Map<const Eigen::Matrix<double, dim, 1>>(by_cell.data() + place * dim);
  }

  /// Calls `visit` for the functions of the edges of a facet and of its inside.
  void for_functions_of(std::span<const Index> corners, const auto& visit) const {
    const auto look_up = [&](std::span<const Index> some) {
      for (const bool is_odd : {false, true}) {
        Key key = key_of(some);
        if (is_odd) key[3] = odd;
        const auto found = std::ranges::lower_bound(keys_, key);
        if (found != keys_.end() && *found == key) visit(static_cast<Index>(found - keys_.begin()));
      }
    };
    for (std::size_t a = 0; a < corners.size(); ++a)
      for (std::size_t b = a + 1; b < corners.size(); ++b) look_up(std::array{corners[a], corners[b]});
    if (corners.size() > 2) look_up(corners);
  }

  void add_facet(const FacetForce& facet) {
    for_functions_of(facet.corners, [&](Index number) {
      const double share = space_.share_of_facet(locals_[static_cast<std::size_t>(number)]);
      residual_.segment<dim>(Eigen::Index{number} * dim) += share * facet.force.template head<dim>();
    });
  }

  void form_cells(const Domain& domain, std::size_t first, std::size_t last, const VectorX& x,
                  const DistributedLoads& loads, const Vector3& body_force,
                  std::vector<double>& cell_residuals);

  /// Adds the diagonal blocks of the functions of a cell.
  void add_diagonal(std::size_t cell) {
    const std::size_t count = rows_ / dim;
    for (std::size_t f = 0; f < space_.functions().size(); ++f) {
      const auto row = static_cast<Eigen::Index>(f) * dim;
      inverses_[static_cast<std::size_t>(numbers_[cell * count + f])] +=
          matrix(cell).template block<dim, dim>(row, row);
    }
  }

  /// Pressures get their compliance, and what the functions of their cell alone would give them of it.
  void form_preconditioner();

  std::size_t num_local() const { return space_.functions().size() + (is_mixed() ? 1 : 0); }

  void add_pressures(std::size_t cell, std::span<const PointGeometry> geometries,
                     std::span<const Vector3> slopes, const double* H, double stiffness, double* residuals);
  /// Gives stresses and tangents of these cells the pressure of the cell in place of that of the point.
  /// @return  d2U/dJ2 of the mean volume, by cell [Pa]
  std::vector<double> replace_pressures(const Domain& domain, std::size_t first, std::size_t last,
                                        const VectorX& x, const StateBatch<double>& states,
                                        std::span<double> P, std::span<double> A) const;

  const World& world_;
  const Body& body_;
  RicherSpace space_;
  std::vector<Key> keys_;            ///< keys of the functions, rising
  std::vector<std::size_t> locals_;  ///< their numbers in one of the cells that have them
  std::vector<Index> numbers_;       ///< [cell, function of the cell]
  std::vector<double> signs_;        ///< likewise
  std::vector<char> is_fixed_;       ///< per unknown
  std::size_t rows_ = 0, columns_ = 0;
  std::vector<double> matrices_;  ///< [cell][row][K_bb, then K_bh]
  std::vector<Square> inverses_;  ///< inverses of the diagonal blocks
  VectorX residual_;
  bool is_convex_ = true;  ///< the volumetric energy is, in each cell
};

}  // namespace resilin
