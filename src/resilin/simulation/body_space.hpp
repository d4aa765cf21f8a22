#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "resilin/core/dense.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/material/batch.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/simulation/distributed_loads.hpp"
#include "resilin/simulation/richer_space.hpp"
#include "resilin/simulation/space_error.hpp"

namespace resilin {

/// The richer space on a body: which functions there are, their residual, and the stiffness that couples them
/// with one another and with the element's own unknowns, cell by cell.
///
/// A cell keeps the tangents of its quadrature points, pulled back to the reference cell. There the gradients
/// of all functions are those of every cell, and products with the stiffness are dense products of matrices.
template <int dim>
class BodySpace {
 public:
  BodySpace(const World& world, const Body& body)
      : world_(world), body_(body), space_(body.domains.element()) {
    tabulate();
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
    const auto numbers = static_cast<double>(num_points() * square * square),
               of_pressures = static_cast<double>((dim + 1) * dim * (num_local() + num_nodes()));
    return num_cells() * (is_mixed() ? sizeof(double) * (numbers + of_pressures) : sizeof(float) * numbers);
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

  /// Makes the tangents and the residual at positions x. False where the law is outside its domain, or its
  /// volumetric energy is not convex and pressures have no compliance.
  bool form(const VectorX& x, const DistributedLoads& loads, const Vector3& body_force);

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
  void apply(const Eigen::Ref<const VectorX>& v, Eigen::Ref<VectorX> image, VectorX& forces) const;

  /// image -= K_bh z.
  void subtract_coupling(const VectorX& z, Eigen::Ref<VectorX> image) const;

  void precondition(const Eigen::Ref<const VectorX>& r, Eigen::Ref<VectorX> z) const {
    for (std::size_t f = 0; f < inverses_.size(); ++f)
      z.segment<dim>(static_cast<Eigen::Index>(f) * dim) =
          inverses_[f] * r.segment<dim>(static_cast<Eigen::Index>(f) * dim);
    VectorX fixed = z;
    set_fixed_to_zero(fixed);
    z = fixed;
  }

 private:
  static constexpr std::size_t cells_per_chunk = 64, cells_per_batch = 1024;
  static constexpr int square = dim * dim;

  /// Corners of an edge or a facet in rising order, -1 after the last one; for an odd function of an edge,
  /// `odd` at the end.
  using Key = std::array<Index, 4>;
  static constexpr Index odd = -2;
  /// In place of the corners: functions of the inside of a cell, whose number follows.
  static constexpr Index inside = -2, pressures = -3;

  static Key key_of(std::span<const Index> corners) {
    Key key{-1, -1, -1, -1};
    for (const Index corner : corners) {
      auto place = key.end() - 1;
      for (; place != key.begin() && (*(place - 1) < 0 || *(place - 1) > corner); --place)
        *place = *(place - 1);
      *place = corner;
    }
    return key;
  }

  using Square = Eigen::Matrix<double, dim, dim>;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Point = Eigen::Matrix<double, dim, 1>;
  using Tensor = Eigen::Matrix<double, dim, dim, Eigen::RowMajor>;
  /// Values of functions or of gradients in a chunk of cells: a column for each cell and direction.
  using Columns = dense::Matrix;

  /// Terms that a mixed element adds in a cell, over the functions and then the nodes.
  struct Pressures {
    VectorX volume;                                ///< gradient of the integral of J
    Eigen::Matrix<double, dim, Eigen::Dynamic> G;  ///< gradients of the integrals of phi_k J
    Square compliance = Square::Zero();
    double stiffness = 0;  ///< d2U/dJ2 / V
  };

  /// Gradients and values of all functions at the quadrature points of the reference cell.
  void tabulate();

  std::size_t num_points() const { return space_.rule().points.size(); }
  std::size_t num_nodes() const { return static_cast<std::size_t>(body_.domains.element().num_nodes); }
  std::size_t num_functions() const { return space_.functions().size(); }

  /// Calls body(begin, end) for chunks of cells.
  void for_each_chunk(const auto& body) const {
    parallel_for(static_cast<std::size_t>(num_cells()), cells_per_chunk, body);
  }

  /// Nodal values of the cells from `begin` to `end`, a row for each node.
  Columns nodal_values(std::size_t begin, std::size_t end, const VectorX& values) const;
  /// The same of the richer functions, with the signs of their cells.
  Columns function_values(std::size_t begin, std::size_t end, const Eigen::Ref<const VectorX>& v) const;
  /// Replaces gradients at the points of cells by the forces that the tangents give.
  void multiply_by_tangents(std::size_t begin, Columns& gradients) const;
  template <class Number>
  static void multiply_by(const Number* tangents, Columns& gradients);

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

  /// Deformation and tangents of cells `first` to `last` of a domain, which the batch calls of laws take.
  struct Batch {
    std::vector<double> H, P, A;  ///< at the points: dim x dim and square x square, by rows
    std::vector<Square> dxi_dX;   ///< [1/m]
    std::vector<double> weights;  ///< [m^3], in 2D [m^2]
    std::vector<double> constants;
    std::vector<Vector3> fibres;
  };
  void form_cells(const Domain& domain, std::size_t first, std::size_t last, const VectorX& x,
                  const DistributedLoads& loads, const Vector3& body_force, Batch& batch,
                  std::vector<double>& cell_residuals);

  /// Pressures get their compliance, and what the functions of their cell alone would give them of it.
  void form_preconditioner();

  std::size_t num_local() const { return space_.functions().size() + (is_mixed() ? 1 : 0); }

  /// @param point  number of the first point of the cell in the batch
  void add_pressures(std::size_t cell, const Batch& batch, std::size_t point, double stiffness,
                     double* residuals);
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
  std::size_t rows_ = 0;             ///< unknowns of the richer space in a cell
  dense::Matrix slopes_;             ///< dN/dxi of the richer functions: a row for each point and coordinate
  dense::Matrix nodal_slopes_;       ///< the same of the element's functions
  dense::Matrix outer_slopes_;       ///< products of slopes of each richer function: rows by point, J, L
  dense::Matrix values_;             ///< values of the richer functions, a row for each point
  /// [cell][point][i, J][k, L]: pulled back to the reference cell, with the weights. An estimate needs no
  /// more than single precision, except beside the pressures of a nearly incompressible solid.
  std::vector<float> tangents_;
  std::vector<double> mixed_tangents_;  ///< those of mixed elements
  std::vector<Pressures> pressures_;    ///< by cell; empty without
  std::vector<Square> inverses_;        ///< inverses of the diagonal blocks
  VectorX residual_;
  bool is_convex_ = true;  ///< the volumetric energy is, in each cell
};

}  // namespace resilin
