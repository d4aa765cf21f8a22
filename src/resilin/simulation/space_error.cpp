#include "resilin/simulation/space_error.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "resilin/core/determinant.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/minres.hpp"
#include "resilin/material/batch.hpp"
#include "resilin/material/volume_energy.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/simulation/distributed_loads.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/richer_space.hpp"
#include "resilin/simulation/time_stepping.hpp"

namespace resilin {
namespace {

constexpr std::size_t cells_per_chunk = 64, cells_per_batch = 2048;
constexpr double most_bytes = 512e6;      ///< for the element matrices of all bodies
constexpr int most_iterations = 30;       ///< iterations of conjugate gradients
constexpr double least_gain = 0.03;       ///< least relative gain of energy by an iteration
constexpr double solve_tolerance = 1e-2;  ///< tolerance for the element's own unknowns
/// Where they hold pressures, which a nearly incompressible solid makes large.
constexpr double mixed_solve_tolerance = 1e-6;
constexpr int most_saddle_iterations = 100;  ///< iterations of the minimum residual method
constexpr double saddle_tolerance = 0.1;     ///< the estimate is off by its square
/// The least share of the sizes of both changes that is told where they cancel (measured on random bars and
/// blocks).
constexpr double least_share_left = 0.25;

/// Corners of an edge or a facet in rising order, -1 after the last one; for an odd function of an edge,
/// `odd` at the end.
using Key = std::array<Index, 4>;
constexpr Index odd = -2;
/// In place of the corners: functions of the inside of a cell, whose number follows.
constexpr Index inside = -2, pressures = -3;

Key key_of(std::span<const Index> corners) {
  Key key{-1, -1, -1, -1};
  const std::size_t count = std::min(corners.size(), key.size());
  std::copy_n(corners.begin(), count, key.begin());
  std::sort(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(count));
  return key;
}

/// J - 1 of F = 1 + H, without cancellation.
template <int dim>
double volume_change(const Eigen::Matrix<double, dim, dim>& H) {
  double change = H.trace() + H.determinant();
  if constexpr (dim == 3) change += cofactor<3>(H).trace();
  return change;
}

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
  void form_preconditioner() {
    const auto invert = [](Square& block) { block = block.inverse().eval(); };
    const std::size_t count = rows_ / dim, p = space_.functions().size();
    for (std::size_t i = 0; i < keys_.size(); ++i)
      if (keys_[i][0] != pressures) invert(inverses_[i]);
    if (!is_mixed()) return;
    for (std::size_t cell = 0; cell < static_cast<std::size_t>(num_cells()); ++cell) {
      const auto row = static_cast<Eigen::Index>(p) * dim;
      Square block = -matrix(cell).template block<dim, dim>(row, row);
      for (std::size_t f = 0; f < p; ++f) {
        const auto number = static_cast<std::size_t>(numbers_[cell * count + f]);
        Square coupling = matrix(cell).template block<dim, dim>(row, static_cast<Eigen::Index>(f) * dim);
        for (int k = 0; k < dim; ++k)
          if (is_fixed_[number * dim + static_cast<std::size_t>(k)] != 0) coupling.col(k).setZero();
        block += coupling * inverses_[number] * coupling.transpose();
      }
      invert(block);
      inverses_[static_cast<std::size_t>(numbers_[cell * count + p])] = block;
    }
  }

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

template <int dim>
void BodySpace<dim>::form_cells(const Domain& domain, std::size_t first, std::size_t last, const VectorX& x,
                                const DistributedLoads& loads, const Vector3& body_force,
                                std::vector<double>& cell_residuals) {
  constexpr int square = dim * dim;
  const ElasticEnergy& elastic = *domain.energy;
  const ElementInfo& element = elastic.element();
  const std::vector<QuadraturePoint>& points = space_.rule().points;
  const std::vector<Index>& nodes = body_.cells;
  const std::size_t n = columns_ / dim, count = rows_ / dim, num_points = points.size();
  const std::size_t num_functions = space_.functions().size();
  std::vector<double> values;   // values of the functions on the reference cell, [point][function]
  std::vector<Vector3> slopes;  // likewise
  for (const QuadraturePoint& point : points)
    for (std::size_t f = 0; f < num_functions; ++f) {
      values.push_back(space_.value(f, point.xi));
      slopes.push_back(space_.gradient(f, point.xi));
    }
  std::vector<double> H((last - first) * num_points * square), P(H.size()), A(H.size() * square);
  std::vector<PointGeometry> geometries((last - first) * num_points);
  std::vector<double> constants;
  std::vector<Vector3> fibres;
  std::size_t num_fibres = 0;
  for (std::size_t cell = first; cell < last; ++cell) {
    const Material material = elastic.material(static_cast<Index>(cell));
    num_fibres = material.fibres.size();
    for (std::size_t q = 0; q < num_points; ++q) {
      constants.insert(constants.end(), material.constants.begin(), material.constants.end());
      fibres.insert(fibres.end(), material.fibres.begin(), material.fibres.end());
    }
  }
  parallel_for(last - first, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<double> rest(n * dim);
    for (std::size_t i = begin; i < end; ++i) {
      const Index* const local =
          nodes.data() + static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i))) * n;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t k = 0; k < dim; ++k)
          rest[a * dim + k] =
              world_.rest_positions[Eigen::Index{local[a]} * dim + static_cast<Eigen::Index>(k)];
      for (std::size_t q = 0; q < num_points; ++q) {
        PointGeometry& geometry = geometries[i * num_points + q];
        geometry = point_geometry(element, points[q], rest);
        Eigen::Map<Eigen::Matrix<double, dim, dim, Eigen::RowMajor>> gradient(H.data() +
                                                                              (i * num_points + q) * square);
        gradient.setZero();
        for (std::size_t a = 0; a < n; ++a) {
          const auto node = Eigen::Index{local[a]} * dim;
          gradient += (x.segment<dim>(node) - world_.rest_positions.segment<dim>(node)) *
                      Eigen::Map<const Eigen::Matrix<double, 1, dim>>(geometry.gradients.data() + a * dim);
        }
      }
    }
  });
  StateBatch<double> states{.law = &elastic.law(),
                            .dim = dim,
                            .count = (last - first) * num_points,
                            .deformation_gradients = H.data(),
                            .holds_displacement_gradients = true,
                            .constants = {},
                            .fibres = fibres.empty() ? nullptr : fibres.front().data(),
                            .num_fibres = num_fibres,
                            .fibre_stride = 3 * num_fibres,
                            .instruction_set = elastic.instruction_set()};
  const std::size_t num_constants = elastic.law().constants.size();
  for (std::size_t k = 0; k < num_constants; ++k)
    states.constants.push_back({constants.data() + k, num_constants});
  first_piola_kirchhoff_stresses(states, P.data());
  stress_tangents(states, Projection::none, A.data());
  std::vector<double> stiffnesses;
  if (is_mixed()) stiffnesses = replace_pressures(domain, first, last, x, states, P, A);

  parallel_for(last - first, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Matrix<double, dim, 1>> gradients(count + n);
    Eigen::Matrix<double, dim, Eigen::Dynamic, Eigen::RowMajor> products(
        dim, static_cast<Eigen::Index>(rows_ + columns_));
    products.setZero();
    for (std::size_t i = begin; i < end; ++i) {
      const auto cell = static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i)));
      Vector3 density = body_force;
      if (!loads.cells.empty()) {
        const auto found = loads.cells.find({nodes.begin() + static_cast<std::ptrdiff_t>(cell * n),
                                             nodes.begin() + static_cast<std::ptrdiff_t>((cell + 1) * n)});
        if (found != loads.cells.end()) density += found->second;
      }
      double* const K = matrices_.data() + cell * rows_ * (rows_ + columns_);
      for (std::size_t q = 0; q < num_points; ++q) {
        const PointGeometry& geometry = geometries[i * num_points + q];
        const double weight = geometry.weight;
        for (std::size_t f = 0; f < num_functions; ++f)
          gradients[f] = (geometry.dxi_dX.transpose() * slopes[q * num_functions + f]).template head<dim>();
        for (std::size_t a = 0; a < n; ++a)
          gradients[count + a] =
              Eigen::Map<const Eigen::Matrix<double, dim, 1>>(geometry.gradients.data() + a * dim);
        const std::size_t state = i * num_points + q;
        const Eigen::Map<const Eigen::Matrix<double, dim, dim, Eigen::RowMajor>> stress(P.data() +
                                                                                        state * square);
        for (std::size_t f = 0; f < num_functions; ++f)
          for (int k = 0; k < dim; ++k)
            cell_residuals[cell * rows_ + f * dim + static_cast<std::size_t>(k)] +=
                weight * (values[q * num_functions + f] * density[k] - stress.row(k).dot(gradients[f]));
        // K_ai,bk = G_aj A_ij,kl G_bl: A G of all functions b first, [j, (b, k)] for each i
        const Eigen::Map<const Eigen::Matrix<double, square, square, Eigen::RowMajor>> tangent(
            A.data() + state * square * square);
        for (int row = 0; row < dim; ++row) {
          for (int k = 0; k < dim; ++k) {
            const Square block = weight * tangent.template block<dim, dim>(row * dim, k * dim);
            for (std::size_t b = 0; b < count + n; ++b)
              if (b < num_functions || b >= count)
                products.col(static_cast<Eigen::Index>(b) * dim + k) = block * gradients[b];
          }
          for (std::size_t f = 0; f < num_functions; ++f) {
            Eigen::Map<Eigen::RowVectorXd> out(
                K + (f * dim + static_cast<std::size_t>(row)) * (rows_ + columns_),
                static_cast<Eigen::Index>(rows_ + columns_));
            if constexpr (dim == 3)
              out += gradients[f][0] * products.row(0) + gradients[f][1] * products.row(1) +
                     gradients[f][2] * products.row(2);
            else
              out += gradients[f][0] * products.row(0) + gradients[f][1] * products.row(1);
          }
        }
      }
    }
  });
  for (std::size_t i = 0; i < last - first; ++i) {
    const auto cell = static_cast<std::size_t>(domain.number_of(static_cast<Index>(first + i)));
    add_diagonal(cell);
    if (is_mixed())
      add_pressures(cell, std::span(geometries).subspan(i * num_points, num_points), slopes,
                    H.data() + i * num_points * square, stiffnesses[i], cell_residuals.data() + cell * rows_);
  }
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

using Apply = std::function<bool(const VectorX& v, VectorX& image)>;
using Precondition = std::function<void(const VectorX& r, VectorX& z)>;

/// Conjugate gradients, until an iteration adds little to the energy.
/// @return  zero: d . r is the energy that was found
std::optional<VectorX> solve_definite(const Apply& apply, const Precondition& precondition,
                                      const VectorX& right_side, VectorX& d) {
  VectorX residual = right_side, z, image;
  d.setZero(right_side.size());
  precondition(residual, z);
  VectorX direction = z;
  double product = residual.dot(z), energy = 0;
  for (int iteration = 0; iteration < most_iterations && product > 0; ++iteration) {
    if (!apply(direction, image)) return std::nullopt;
    const double curvature = direction.dot(image);
    if (!(curvature > 0)) break;
    const double step = product / curvature, gain = step * product;
    d += step * direction;
    residual -= step * image;
    energy += gain;
    if (gain < least_gain * energy) break;
    precondition(residual, z);
    const double next = residual.dot(z);
    direction = z + next / product * direction;
    product = next;
  }
  return VectorX(VectorX::Zero(right_side.size()));
}

/// The minimum residual method where pressures make a saddle point of it.
/// @return  the residual: d . (r + residual) is the stationary value up to its square
std::optional<VectorX> solve_saddle(const Apply& apply, const Precondition& precondition,
                                    const VectorX& right_side, VectorX& d) {
  const bool is_solved = minres(apply, precondition, right_side,
                                {.max_iterations = most_saddle_iterations, .tolerance = saddle_tolerance}, d);
  VectorX image;
  if (!is_solved || !apply(d, image)) return std::nullopt;
  return VectorX(right_side - image);
}

template <int dim>
std::optional<SpaceError> space_error_in(Simulation& simulation) {
  const World& world = simulation.world();
  const VectorX& x = simulation.state().positions;
  const Conditions conditions = world.at_load(simulation.state().load);
  Potential potential = Potential::at(world, conditions, x);
  potential.form_lag(x);
  const VectorX contact =
      potential.gradient_of(EnergyCategory::contact, x) + potential.gradient_of(EnergyCategory::friction, x);
  const DistributedLoads loads = distributed_loads(world, x, conditions);

  const bool has_free_unknowns = world.num_free_unknowns() > 0;
  // That of the search is not near enough: large rotations of the last steps would make S indefinite.
  if (has_free_unknowns) simulation.newton().form_matrix(potential, world.is_fixed, x);

  SpaceError error;
  error.changes.resize(world.bodies.size());
  std::vector<BodySpace<dim>> spaces;
  std::vector<std::size_t> numbers;
  Eigen::Index num_unknowns = 0;
  double bytes = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.num_cells() == 0) continue;
    BodySpace<dim> space(world, body);
    if (bytes + space.bytes() > most_bytes) continue;
    bytes += space.bytes();
    space.fix(contact);
    if (!space.form(x, loads, loads.bodies[b])) continue;
    num_unknowns += space.num_unknowns();
    spaces.push_back(std::move(space));
    numbers.push_back(b);
  }
  if (spaces.empty()) return std::nullopt;

  const auto for_spaces = [&](const auto& visit) {
    Eigen::Index begin = 0;
    for (const BodySpace<dim>& space : spaces) {
      visit(space, begin);
      begin += space.num_unknowns();
    }
  };
  const bool is_mixed = std::ranges::any_of(spaces, [](const auto& space) { return space.is_mixed(); });
  // S v = K_bb v - K_bh K_hh^-1 K_hb v. False where K_hh cannot be solved with.
  const auto schur = [&](const VectorX& v, VectorX& image) {
    VectorX forces = VectorX::Zero(x.size());
    image.resize(num_unknowns);
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.apply(v.segment(begin, space.num_unknowns()), image.segment(begin, space.num_unknowns()), forces);
    });
    if (!has_free_unknowns) return true;
    const std::optional<VectorX> z = simulation.newton().response(
        std::move(forces), world.is_fixed, is_mixed ? mixed_solve_tolerance : solve_tolerance);
    if (!z) return false;
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.subtract_coupling(*z, image.segment(begin, space.num_unknowns()));
    });
    return true;
  };
  const auto precondition = [&](const VectorX& r, VectorX& z) {
    z.resize(num_unknowns);
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.precondition(r.segment(begin, space.num_unknowns()), z.segment(begin, space.num_unknowns()));
    });
  };
  VectorX right_side(num_unknowns), d;
  for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
    right_side.segment(begin, space.num_unknowns()) = space.residual();
  });
  const std::optional<VectorX> left = is_mixed ? solve_saddle(schur, precondition, right_side, d)
                                               : solve_definite(schur, precondition, right_side, d);
  if (!left) return std::nullopt;
  Eigen::Index begin = 0;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    const Eigen::Index size = spaces[i].num_unknowns();
    SpaceError::Change change = spaces[i].change(
        d.segment(begin, size).cwiseProduct(right_side.segment(begin, size) + left->segment(begin, size)));
    if (!spaces[i].is_mixed()) change.by_displacements = std::max(0.0, change.by_displacements);
    error.changes[numbers[i]] = change;
    begin += size;
  }

  const VectorX displacement = x - world.rest_positions;
  VectorX gradient;
  potential.gradient(x, gradient);
  double work_of_supports = -contact.dot(displacement);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (world.is_fixed[static_cast<std::size_t>(i)] != 0) work_of_supports += gradient[i] * displacement[i];
  const double work_of_loads = -potential.gradient_of(EnergyCategory::external, x).dot(displacement);
  error.is_driven_by_displacements = std::abs(work_of_supports) > std::abs(work_of_loads);
  return error;
}

}  // namespace

double SpaceError::Change::total() const {
  const double sum = by_displacements + by_pressures;
  const double least = least_share_left * (std::abs(by_displacements) + std::abs(by_pressures));
  return std::abs(sum) < least ? std::copysign(least, sum) : sum;
}

std::optional<SpaceError> space_error(Simulation& simulation) {
  const World& world = simulation.world();
  if (world.is_dynamic || world.modes || !world.share.is_whole() || world.keeps_history())
    return std::nullopt;
  return world.dimension == 3 ? space_error_in<3>(simulation) : space_error_in<2>(simulation);
}

}  // namespace resilin
