#include "resilin/simulation/space_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/energy/spread_force.hpp"
#include "resilin/material/batch.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/richer_space.hpp"
#include "resilin/simulation/time_stepping.hpp"

namespace resilin {
namespace {

constexpr std::size_t cells_per_chunk = 64, cells_per_batch = 2048;
constexpr double most_bytes = 512e6;  ///< for the element matrices of all bodies
constexpr int most_iterations = 30;   ///< most iterations of conjugate gradients
constexpr double least_gain = 0.01;   ///< least gain of the energy, by which an iteration has to add to it
constexpr double solve_tolerance = 1e-3;  ///< solve tolerance of the element's own unknowns

/// Corners of an edge or a facet in rising order, -1 after the last one; for an odd function of an edge,
/// `odd` at the end.
using Key = std::array<Index, 4>;
constexpr Index odd = -2;

Key key_of(std::span<const Index> corners) {
  Key key{-1, -1, -1, -1};
  const std::size_t count = std::min(corners.size(), key.size());
  std::copy_n(corners.begin(), count, key.begin());
  std::sort(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(count));
  return key;
}

/// A force that acts on a flat facet in sum [N].
struct FacetForce {
  std::vector<Index> corners;
  Vector3 force;
};

/// Loads of a static scene that do work on functions which vanish at the nodes.
struct DistributedLoads {
  std::vector<FacetForce> facets;
  std::map<std::vector<Index>, Vector3> cells;  ///< by the nodes of a cell [N/m^3]
  std::vector<Vector3> bodies;                  ///< on all cells of a body [N/m^3]
  Vector3 acceleration = Vector3::Zero();       ///< gravity [m/s^2]
};

void add_facets(const CellBlock& block, const auto& force_of, DistributedLoads& loads) {
  const auto num_corners = static_cast<std::size_t>(resilin::num_corners(block.kind));
  for (Index facet = 0; facet < block.num_cells(); ++facet) {
    const std::span<const Index> corners = block.cell(facet).first(num_corners);
    loads.facets.push_back({{corners.begin(), corners.end()}, force_of(corners)});
  }
}

DistributedLoads distributed_loads(const World& world, const VectorX& x, const Conditions& c) {
  DistributedLoads loads;
  loads.acceleration = c.load * world.gravity;
  loads.bodies.assign(world.bodies.size(), Vector3::Zero());
  for (const auto& term : world.terms) {
    if (const auto* pressure = dynamic_cast<const Pressure*>(term.get())) {
      const CellKind kind = first_order(pressure->facets().kind);
      add_facets(
          pressure->facets(),
          [&](std::span<const Index> corners) {
            return Vector3(-pressure->pressure(c) * area_vector(world.dimension, kind, corners, x));
          },
          loads);
      continue;
    }
    const auto* dead = dynamic_cast<const DeadLoad*>(term.get());
    if (dead == nullptr) continue;
    const Vector3 density = dead->density(c);
    if (const auto* on = dynamic_cast<const LoadedFacets*>(dead->region())) {
      const CellKind kind = first_order(on->facets().kind);
      add_facets(
          on->facets(),
          [&](std::span<const Index> corners) {
            return Vector3(area_vector(world.dimension, kind, corners, world.rest_positions).norm() *
                           density);
          },
          loads);
    } else if (const auto* spread = dynamic_cast<const SpreadForce*>(dead->region())) {
      const CellKind kind = first_order(spread->facets().kind);
      const SpreadForce::Traction traction = spread->traction(density, world.rest_positions);
      add_facets(
          spread->facets(),
          [&](std::span<const Index> corners) {
            Vector3 middle = Vector3::Zero();
            for (const Index corner : corners)
              middle += node_position(world.dimension, corner, world.rest_positions) /
                        static_cast<double>(corners.size());
            return Vector3(area_vector(world.dimension, kind, corners, world.rest_positions).norm() *
                           traction.at(middle));
          },
          loads);
    } else if (const auto* cells = dynamic_cast<const LoadedCells*>(dead->region())) {
      const auto whole = std::ranges::find_if(
          world.bodies, [&](const Body& body) { return std::ranges::equal(body.cells, cells->cells()); });
      if (whole != world.bodies.end()) {
        loads.bodies[static_cast<std::size_t>(whole - world.bodies.begin())] += density;
        continue;
      }
      const Body& body = world.body_of(cells->cells().front());
      const auto n = static_cast<std::size_t>(num_nodes(body.cell_kind));
      for (std::size_t i = 0; i < cells->cells().size(); i += n)
        loads.cells.try_emplace({cells->cells().begin() + i, cells->cells().begin() + i + n}, Vector3::Zero())
            .first->second += density;
    }
  }
  return loads;
}

/// The richer space on a body of one domain: which functions there are, their residual, and the stiffness
/// that couples them with one another and with the element's own unknowns, cell by cell.
template <int dim>
class BodySpace {
 public:
  BodySpace(const World& world, const Body& body)
      : world_(world), body_(body), space_(body.domains.element()) {
    const std::vector<Index>& nodes = body.cells;
    const auto n = static_cast<std::size_t>(body_.domains.element().num_nodes),
               count = space_.functions().size();
    std::vector<std::pair<Key, std::size_t>> keys;
    for (Index cell = 0; cell < num_cells(); ++cell)
      for (std::size_t f = 0; f < count; ++f) {
        std::vector<Index> corners;
        for (const int corner : space_.functions()[f].corners)
          corners.push_back(nodes[static_cast<std::size_t>(cell) * n + static_cast<std::size_t>(corner)]);
        Key key = corners.size() > 4 ? Key{-2, cell, -1, -1} : key_of(corners);
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
      const HierarchicalFunction& function = space_.functions()[place % count];
      const Index* const corners = nodes.data() + place / count * n;
      if (function.is_odd && corners[function.corners[0]] > corners[function.corners[1]]) signs_[place] = -1;
    }
  }

  Index num_cells() const { return body_.domains.num_cells(); }
  Eigen::Index num_unknowns() const { return static_cast<Eigen::Index>(keys_.size()) * dim; }
  const Body& body() const { return body_; }
  double bytes() const {
    const double rows = static_cast<double>(space_.functions().size()) * dim;
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

  /// Makes the matrices and the residual at positions x. False where the law is outside its domain.
  bool form(const VectorX& x, const DistributedLoads& loads, const Vector3& body_force) {
    residual_.setZero(num_unknowns());
    rows_ = space_.functions().size() * dim;
    columns_ = static_cast<std::size_t>(body_.domains.element().num_nodes) * dim;
    matrices_.assign(static_cast<std::size_t>(num_cells()) * rows_ * (rows_ + columns_), 0.0);
    std::vector<double> cell_residuals(static_cast<std::size_t>(num_cells()) * rows_, 0.0);
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
    return residual_.allFinite();
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

  void form_preconditioner() {
    inverses_.assign(keys_.size(), Square::Zero());
    const std::size_t count = rows_ / dim;
    for (std::size_t place = 0; place < numbers_.size(); ++place) {
      const auto f = static_cast<Eigen::Index>(place % count) * dim;
      inverses_[static_cast<std::size_t>(numbers_[place])] +=
          matrix(place / count).template block<dim, dim>(f, f);
    }
    for (Square& block : inverses_) block = block.inverse().eval();
  }

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
};

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
  std::vector<double> values;   // values of the functions on the reference cell, [point][function]
  std::vector<Vector3> slopes;  // likewise
  for (const QuadraturePoint& point : points)
    for (std::size_t f = 0; f < count; ++f) {
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

  parallel_for(last - first, cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Matrix<double, dim, 1>> gradients(count + n);
    Eigen::Matrix<double, dim, Eigen::Dynamic, Eigen::RowMajor> products(
        dim, static_cast<Eigen::Index>(rows_ + columns_));
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
        for (std::size_t f = 0; f < count; ++f)
          gradients[f] = (geometry.dxi_dX.transpose() * slopes[q * count + f]).template head<dim>();
        for (std::size_t a = 0; a < n; ++a)
          gradients[count + a] =
              Eigen::Map<const Eigen::Matrix<double, dim, 1>>(geometry.gradients.data() + a * dim);
        const std::size_t state = i * num_points + q;
        const Eigen::Map<const Eigen::Matrix<double, dim, dim, Eigen::RowMajor>> stress(P.data() +
                                                                                        state * square);
        for (std::size_t f = 0; f < count; ++f)
          for (int k = 0; k < dim; ++k)
            cell_residuals[cell * rows_ + f * dim + static_cast<std::size_t>(k)] +=
                weight * (values[q * count + f] * density[k] - stress.row(k).dot(gradients[f]));
        // K_ai,bk = G_aj A_ij,kl G_bl: A G of all functions b first, [j, (b, k)] for each i
        const Eigen::Map<const Eigen::Matrix<double, square, square, Eigen::RowMajor>> tangent(
            A.data() + state * square * square);
        for (int row = 0; row < dim; ++row) {
          for (int k = 0; k < dim; ++k) {
            const Square block = weight * tangent.template block<dim, dim>(row * dim, k * dim);
            for (std::size_t b = 0; b < count + n; ++b)
              products.col(static_cast<Eigen::Index>(b) * dim + k) = block * gradients[b];
          }
          for (std::size_t f = 0; f < count; ++f) {
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
  error.squared_norms.resize(world.bodies.size());
  std::vector<BodySpace<dim>> spaces;
  std::vector<std::size_t> numbers;
  Eigen::Index num_unknowns = 0;
  double bytes = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.num_cells() == 0 || body.domains.element().has_mean_volume) continue;
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
  // S v = K_bb v - K_bh K_hh^-1 K_hb v. False where K_hh cannot be solved with.
  const auto schur = [&](const VectorX& v, VectorX& image) {
    VectorX forces = VectorX::Zero(x.size());
    image.resize(num_unknowns);
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.apply(v.segment(begin, space.num_unknowns()), image.segment(begin, space.num_unknowns()), forces);
    });
    if (!has_free_unknowns) return true;
    const std::optional<VectorX> z =
        simulation.newton().response(std::move(forces), world.is_fixed, solve_tolerance);
    if (!z) return false;
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.subtract_coupling(*z, image.segment(begin, space.num_unknowns()));
    });
    return true;
  };

  VectorX residual(num_unknowns), d = VectorX::Zero(num_unknowns), z(num_unknowns), image;
  for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
    residual.segment(begin, space.num_unknowns()) = space.residual();
  });
  const auto precondition = [&] {
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.precondition(residual.segment(begin, space.num_unknowns()),
                         z.segment(begin, space.num_unknowns()));
    });
  };
  precondition();
  VectorX direction = z;
  double product = residual.dot(z), energy = 0;
  const VectorX right_side = residual;
  for (int iteration = 0; iteration < most_iterations && product > 0; ++iteration) {
    if (!schur(direction, image)) return std::nullopt;
    const double curvature = direction.dot(image);
    if (!(curvature > 0)) break;
    const double step = product / curvature, gain = step * product;
    d += step * direction;
    residual -= step * image;
    energy += gain;
    if (gain < least_gain * energy) break;
    precondition();
    const double next = residual.dot(z);
    direction = z + next / product * direction;
    product = next;
  }
  Eigen::Index begin = 0;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    const Eigen::Index size = spaces[i].num_unknowns();
    error.squared_norms[numbers[i]] =
        std::max(0.0, d.segment(begin, size).dot(right_side.segment(begin, size)));
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

std::optional<SpaceError> space_error(Simulation& simulation) {
  const World& world = simulation.world();
  if (world.is_dynamic || world.modes || !world.share.is_whole() || world.keeps_history())
    return std::nullopt;
  return world.dimension == 3 ? space_error_in<3>(simulation) : space_error_in<2>(simulation);
}

}  // namespace resilin
