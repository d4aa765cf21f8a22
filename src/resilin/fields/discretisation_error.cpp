#include "resilin/fields/discretisation_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "resilin/core/dense.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/fields/patch_recovery.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

constexpr std::size_t cells_per_chunk = 256;
/// Strain below which stresses are what rounding and stopping rules leave.
constexpr double least_strain = 1e-12;
/// The least share of the squared norm that is left in a richer space: one step cannot tell of less.
constexpr double least_share_of_norm = 0.1;
constexpr double most_lambda_to_mu = 9;  ///< ratio at Poisson's ratio 0.45
/// With more materials than this in a body they count as one that varies in space.
constexpr std::size_t most_materials = 64;

SymmetricTensor mandel(const Matrix<3>& T) {
  const double root = std::numbers::sqrt2;
  SymmetricTensor vector;
  vector << T(0, 0), T(1, 1), T(2, 2), root * T(1, 2), root * T(0, 2), root * T(0, 1);
  return vector;
}

/// T = R^T J sigma R with F = R U: the stress that works on ln U, in the axes of the rest shape, so that a
/// turn that varies from cell to cell is no error. A law of small strain has but one stress.
std::vector<SymmetricTensor> turned_back_stresses(const ElasticEnergy& elastic, const VectorX& x) {
  const std::vector<Matrix<3>> sigma = elastic.cauchy_stresses(x);
  std::vector<SymmetricTensor> stresses(sigma.size());
  const bool is_small = elastic.law().kind == LawKind::small_strain;
  const std::vector<Matrix<3>> F = is_small ? std::vector<Matrix<3>>() : elastic.deformation_gradients(x);
  parallel_for(sigma.size(), cells_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (is_small) {
        stresses[i] = mandel(sigma[i]);
        continue;
      }
      const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(F[i].transpose() * F[i]);
      const Vector3 inverse_stretches = eigen.values.cwiseSqrt().cwiseInverse();
      const Matrix<3> R = F[i] * eigen.vectors * inverse_stretches.asDiagonal() * eigen.vectors.transpose();
      stresses[i] = mandel(F[i].determinant() * R.transpose() * sigma[i] * R);
    }
  });
  return stresses;
}

/// Materials of the cells: a number for each, equal where the constants are, and the moduli of each number.
struct CellMaterials {
  std::vector<Index> of_cells;
  std::vector<Hooke> moduli;
};

CellMaterials cell_materials(const ElasticEnergy& elastic) {
  CellMaterials found{std::vector<Index>(static_cast<std::size_t>(elastic.num_cells()), 0), {}};
  const auto add_moduli = [&](const std::vector<double>& constants) {
    for_each_rest_tangent(elastic.law(), constants, [&found](std::size_t, const double* A) {
      found.moduli.push_back({A[9 + 1], A[4]});  // dP_01/dF_01, dP_00/dF_11
    });
  };
  if (elastic.tiles().constant_stride != 0) {
    std::map<std::vector<double>, Index> numbers;
    for (Index cell = 0; cell < elastic.num_cells() && numbers.size() <= most_materials; ++cell) {
      const auto next = static_cast<Index>(numbers.size());
      found.of_cells[static_cast<std::size_t>(cell)] =
          numbers.try_emplace(elastic.material(cell).constants, next).first->second;
    }
    if (numbers.size() <= most_materials) {
      std::vector<std::vector<double>> by_number(numbers.size());
      for (const auto& [constants, number] : numbers) by_number[static_cast<std::size_t>(number)] = constants;
      for (const std::vector<double>& constants : by_number) add_moduli(constants);
      return found;
    }
    std::ranges::fill(found.of_cells, 0);
  }
  add_moduli(elastic.material(0).constants);
  return found;
}

/// Those of all domains, each with numbers of its own.
CellMaterials cell_materials(const Domains& domains) {
  CellMaterials all{std::vector<Index>(static_cast<std::size_t>(domains.num_cells()), 0), {}};
  for (const Domain& domain : domains) {
    if (domain.energy->num_cells() == 0) continue;
    const CellMaterials own = cell_materials(*domain.energy);
    for (Index cell = 0; cell < domain.energy->num_cells(); ++cell)
      all.of_cells[static_cast<std::size_t>(domain.number_of(cell))] =
          static_cast<Index>(all.moduli.size()) + own.of_cells[static_cast<std::size_t>(cell)];
    all.moduli.insert(all.moduli.end(), own.moduli.begin(), own.moduli.end());
  }
  return all;
}

/// Advice that brings a body nearer to the exact solution: the element of "auto", where it is another one,
/// and finer cells.
std::string finer_choice(const Body& body) {
  double poissons_ratio = -1;
  for (const Hooke& moduli : cell_materials(body.domains).moduli)
    poissons_ratio = std::max(poissons_ratio, moduli.poissons_ratio());
  const auto stands_apart = [](const Domain& domain) { return domain.law_info().has_volume_energy; };
  const auto limiting = std::ranges::find_if_not(body.domains, stands_apart);
  const LawInfo& law = (limiting == body.domains.end() ? body.domains.front() : *limiting).law_info();
  const ElementInfo& chosen =
      *choose_element({.cells = body.cell_kind, .law = law, .poissons_ratio = poissons_ratio}).element;
  if (&chosen != &body.domains.element())
    return "element = \"" + std::string(chosen.name) + "\" or finer cells";
  if (is_simplex(chosen.shape)) return "finer cells";
  return "finer cells or " + std::string(chosen.dim == 3 ? "tetrahedra" : "triangles");
}

/// T : C^-1 : T, twice the complementary energy per volume.
double squared_norm(const SymmetricTensor& T, const Hooke& moduli) {
  const double trace = T.head<3>().sum(), bulk_modulus = moduli.lambda + 2 * moduli.mu / 3;
  const double deviatoric = T.squaredNorm() - trace * trace / 3;
  return deviatoric / (2 * moduli.mu) + trace * trace / (9 * bulk_modulus);
}

/// By its own bulk modulus the pressure of a nearly incompressible solid hardly counts, and yet cells that
/// lock in volume show by nothing else.
double pressure_excess(const SymmetricTensor& T, const Hooke& moduli) {
  const Hooke softer{moduli.mu, std::min(moduli.lambda, most_lambda_to_mu * moduli.mu)};
  return squared_norm(T, softer) - squared_norm(T, moduli);
}

/// Where the error is sampled in each cell, and how T is continued there from the quadrature points: on
/// simplices as the polynomial, of one degree less than the element's, that fits them best, since the error
/// may vanish at the points themselves; elsewhere at the points.
struct ErrorSamples {
  const QuadratureRule* rule;
  Eigen::MatrixXd from_points;        ///< [sample, point]
  std::vector<double> corner_shapes;  ///< [sample * num_corners + corner]
  std::size_t num_corners;
  double reference_size;

  /// Share of the cell's volume.
  double share(std::size_t sample) const { return rule->points[sample].weight / reference_size; }
  std::span<const double> corner_shapes_at(std::size_t sample) const {
    return std::span(corner_shapes).subspan(sample * num_corners, num_corners);
  }
};

Eigen::MatrixXd reference_polynomials(const QuadratureRule& rule, int dim, int degree) {
  const auto count = static_cast<Eigen::Index>(rule.points.size());
  Eigen::MatrixXd values = Eigen::MatrixXd::Ones(count, degree == 0 ? 1 : 1 + dim);
  for (Eigen::Index i = 0; i < count && degree > 0; ++i)
    values.row(i).tail(dim) = rule.points[static_cast<std::size_t>(i)].xi.head(dim).transpose();
  return values;
}

ErrorSamples error_samples(const Domains& elastic) {
  const ElementInfo& element = elastic.element();
  const QuadratureRule& own = elastic.quadrature();
  ErrorSamples samples{.rule = &own,
                       .from_points = {},
                       .corner_shapes = {},
                       .num_corners = 0,
                       .reference_size = size(element.shape)};
  const auto count = static_cast<Eigen::Index>(own.points.size());
  if (is_simplex(element.shape)) {
    samples.rule = &rule_of_degree(element.shape, 2 * element.degree);
    const int degree = element.degree - 1;
    samples.from_points = dense::product(reference_polynomials(*samples.rule, element.dim, degree),
                                         dense::least_squares(reference_polynomials(own, element.dim, degree),
                                                              Eigen::MatrixXd::Identity(count, count)));
  } else {
    samples.from_points = Eigen::MatrixXd::Identity(count, count);
  }
  const ElementInfo& corner = corner_element(element);
  samples.num_corners = static_cast<std::size_t>(corner.num_nodes);
  samples.corner_shapes.resize(samples.rule->points.size() * samples.num_corners);
  for (std::size_t i = 0; i < samples.rule->points.size(); ++i)
    corner.shape_values(
        samples.rule->points[i].xi,
        std::span(samples.corner_shapes).subspan(i * samples.num_corners, samples.num_corners));
  return samples;
}

/// T* is made of what the cells let through: where elements of degree 1 are too stiff it is too small as
/// well. Calibrated: docs/theory/discretisation.md
double of_linear_elements(double e) { return e * (1.5 + 4 * e); }

/// Integrals of |T* - T|^2, of what locking adds to it, of |T|^2 and of the squared strain that belongs to T.
struct Sums {
  double error = 0, locking = 0, norm = 0, strain = 0, volume = 0;
  Sums& operator+=(const Sums& other) {
    error += other.error;
    locking += other.locking;
    norm += other.norm;
    strain += other.strain;
    volume += other.volume;
    return *this;
  }
};

/// Adds what a cell has of |T|^2, of the strain that belongs to it and of volume.
void add_norms(std::span<const SymmetricTensor> stresses, std::span<const double> volumes,
               const Hooke& moduli, Sums& sums) {
  for (std::size_t q = 0; q < stresses.size(); ++q) {
    const double norm = squared_norm(stresses[q], moduli);
    sums.volume += volumes[q];
    sums.norm += volumes[q] * norm;
    sums.strain += volumes[q] * norm / moduli.mu;
  }
}

bool is_strained(const Sums& sums) { return sums.strain > least_strain * least_strain * sums.volume; }

/// Stress and smoother stress of a body, cell by cell.
class StressErrors {
 public:
  StressErrors(const World& world, const Body& body, const VectorX& positions)
      : elastic_(body.domains),
        stresses_(elastic_.by_cell(
            [&](const Domain& domain) { return turned_back_stresses(*domain.energy, positions); })),
        materials_(cell_materials(elastic_)),
        samples_(error_samples(elastic_)),
        places_(body, world.rest_positions, *samples_.rule),
        volumes_(elastic_.point_volumes()),
        recovery_(body, world.rest_positions, world.dimension, materials_.of_cells) {
    recovery_.fit(stresses_);
  }

  bool has_enough_points() const { return recovery_.has_enough_points(); }

  Sums of_cell(std::size_t cell) const {
    const auto num_points = static_cast<std::size_t>(elastic_.num_points());
    const Hooke& moduli = materials_.moduli[static_cast<std::size_t>(materials_.of_cells[cell])];
    Sums sums;
    add_norms(std::span(stresses_).subspan(cell * num_points, num_points),
              std::span(volumes_).subspan(cell * num_points, num_points), moduli, sums);
    const std::vector<SymmetricTensor> differences = differences_of(cell);
    for (std::size_t i = 0; i < differences.size(); ++i) {
      const double volume = sums.volume * samples_.share(i);
      sums.error += volume * squared_norm(differences[i], moduli);
      if (!elastic_.element().has_mean_volume)
        sums.locking += volume * pressure_excess(differences[i], moduli);
    }
    return sums;
  }

 private:
  /// T* - T at the samples. Of the pressure an element with one for each cell means but the mean.
  std::vector<SymmetricTensor> differences_of(std::size_t cell) const {
    const auto num_points = static_cast<std::size_t>(elastic_.num_points());
    const std::size_t count = samples_.rule->points.size();
    std::vector<SymmetricTensor> differences(count);
    double mean_trace = 0;
    for (std::size_t i = 0; i < count; ++i) {
      differences[i] = recovery_.value(cell, samples_.corner_shapes_at(i), places_.of(cell, i));
      for (std::size_t q = 0; q < num_points; ++q)
        differences[i] -= samples_.from_points(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(q)) *
                          stresses_[cell * num_points + q];
      mean_trace += samples_.share(i) * differences[i].head<3>().sum();
    }
    if (elastic_.element().has_mean_volume) {
      for (SymmetricTensor& difference : differences)
        difference.head<3>().array() += (mean_trace - difference.head<3>().sum()) / 3;
    }
    return differences;
  }

  const Domains& elastic_;
  std::vector<SymmetricTensor> stresses_;  ///< at the quadrature points
  CellMaterials materials_;
  ErrorSamples samples_;
  RestPlaces places_;            ///< places of the samples
  std::vector<double> volumes_;  ///< volumes of the quadrature points [m^3]
  PatchRecovery recovery_;
};

}  // namespace

std::optional<double> discretisation_error(const World& world, const Body& body, const VectorX& positions) {
  const Domains& elastic = body.domains;
  if (elastic.num_cells() == 0) return std::nullopt;
  const StressErrors errors(world, body, positions);
  if (!errors.has_enough_points()) return std::nullopt;
  const Sums sums = parallel_sum<Sums>(static_cast<std::size_t>(elastic.num_cells()), cells_per_chunk,
                                       [&errors](std::size_t begin, std::size_t end) {
                                         Sums chunk;
                                         for (std::size_t cell = begin; cell < end; ++cell)
                                           chunk += errors.of_cell(cell);
                                         return chunk;
                                       });
  if (!is_strained(sums)) return std::nullopt;
  if (!std::isfinite((sums.error + sums.locking) / sums.norm)) return std::nullopt;  // a cell is flat
  // |u|^2 = |u_h|^2 + |u - u_h|^2: a share e / (1 + e) of the whole.
  const double e = sums.error / sums.norm;
  const double whole = (elastic.element().degree > 1 ? e : of_linear_elements(e)) + sums.locking / sums.norm;
  return whole / (1 + whole);
}

std::optional<double> squared_solution_norm(const Body& body, const VectorX& positions) {
  const Domains& elastic = body.domains;
  if (elastic.num_cells() == 0) return std::nullopt;
  // A constant pressure per cell hides how the volume ratio varies within the cell.
  const bool is_mixed = elastic.element().has_mean_volume;
  const std::vector<SymmetricTensor> stresses =
      elastic.by_cell([&](const Domain& domain) { return turned_back_stresses(*domain.energy, positions); });
  const CellMaterials materials = cell_materials(elastic);
  const std::vector<double> volumes = elastic.point_volumes();
  const auto num_points = static_cast<std::size_t>(elastic.num_points());
  Sums sums;
  for (std::size_t cell = 0; cell < materials.of_cells.size(); ++cell)
    add_norms(std::span(stresses).subspan(cell * num_points, num_points),
              std::span(volumes).subspan(cell * num_points, num_points),
              materials.moduli[static_cast<std::size_t>(materials.of_cells[cell])], sums);
  if (is_mixed) sums.norm = 2 * elastic.value(positions);
  if (!is_strained(sums) || !std::isfinite(sums.norm)) return std::nullopt;
  return sums.norm;
}

bool is_one_cell_across(const Body& body) {
  const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
  std::vector<char> is_outside(static_cast<std::size_t>(body.num_nodes), 0);
  for (const Index node : facets.nodes) is_outside[static_cast<std::size_t>(node - body.first_node)] = 1;
  const auto num_nodes = static_cast<std::size_t>(resilin::num_nodes(body.cell_kind)),
             num_corners = static_cast<std::size_t>(resilin::num_corners(body.cell_kind));
  const std::vector<double> volumes = body.domains.rest_volumes();
  double all = 0, outside = 0;
  for (std::size_t cell = 0; cell < volumes.size(); ++cell) {
    const Index* const nodes = body.cells.data() + cell * num_nodes;
    all += volumes[cell];
    if (std::all_of(nodes, nodes + num_corners, [&](Index node) {
          return is_outside[static_cast<std::size_t>(node - body.first_node)] != 0;
        }))
      outside += volumes[cell];
  }
  return 2 * outside > all;
}

std::optional<double> error_by_recovered_stress(const World& world, const Body& body,
                                                const VectorX& positions) {
  if (body.rigid || body.domains.have_rigid_ones()) return std::nullopt;
  if (body.num_cells() > 0 && is_one_cell_across(body))
    return squared_solution_norm(body, positions) ? std::optional(cannot_tell) : std::nullopt;
  return discretisation_error(world, body, positions);
}

DiscretisationErrors discretisation_errors(const World& world, const VectorX& positions) {
  DiscretisationErrors errors;
  for (const Body& body : world.bodies) {
    const std::optional<double> share = error_by_recovered_stress(world, body, positions);
    errors.push_back(share ? std::optional(DiscretisationError{*share, ErrorEstimate::recovered_stress})
                           : std::nullopt);
  }
  return errors;
}

std::vector<std::string> coarseness_texts(const World& world, const DiscretisationErrors& errors) {
  std::vector<std::string> texts;
  for (std::size_t b = 0; b < errors.size() && b < world.bodies.size(); ++b) {
    if (!errors[b]) continue;
    const double error = errors[b]->share;
    const Body& body = world.bodies[b];
    const bool is_by_stress = errors[b]->estimate == ErrorEstimate::recovered_stress && error != cannot_tell;
    const bool has_better = !world.is_dynamic && !world.keeps_history();  // where it does not fail
    if (is_by_stress && has_better && body.domains.element().has_mean_volume) {
      texts.push_back("\"" + body.name + "\" has a discretisation error of " + share_text(error) +
                      " by recovered stress alone, which may tell many times too little of " + body.element +
                      ": compare with finer cells");
      continue;
    }
    if (error <= large_discretisation_error) continue;
    if (error == cannot_tell) {
      texts.push_back("\"" + body.name +
                      "\" is one cell across: its discretisation error cannot be estimated " +
                      "from its stresses; compare with " + finer_choice(body));
      continue;
    }
    texts.push_back("\"" + body.name + "\" has an estimated discretisation error of " + share_text(error) +
                    (is_by_stress ? " by recovered stress" : "") +
                    " (displacements, or forces where displacements are prescribed): " + body.element +
                    " on these cells is too coarse; take " + finer_choice(body));
  }
  return texts;
}

double share_missing(double gain, bool is_driven_by_displacements) {
  if (is_driven_by_displacements) return std::min(std::abs(gain), 1.0);
  return std::abs(gain) / std::max(1 + gain, least_share_of_norm);
}

std::string_view name(ErrorEstimate estimate) {
  return estimate == ErrorEstimate::richer_space ? "richer space" : "recovered stress";
}

std::string share_text(double share) {
  if (share == cannot_tell) return "unknown: one cell across";
  const double percent = 100 * share;
  if (percent < 0.01) return "less than 0.01 %";
  const double digit = std::pow(10.0, std::floor(std::log10(percent)) - 1);
  return format_short(std::round(percent / digit) * digit) + " %";
}

}  // namespace resilin
