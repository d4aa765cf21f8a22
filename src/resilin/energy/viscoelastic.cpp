#include "resilin/energy/viscoelastic.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "resilin/core/determinant.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/energy/axisymmetric_blocks.hpp"
#include "resilin/energy/kernels/overstress_kernels.hpp"
#include "resilin/energy/tile_sum.hpp"
#include "resilin/material/kernels/point_kernels.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin {
namespace {

/// Components of a symmetric tensor as the history has them: xx, yy, zz, xy, yz, xz.
constexpr std::array<std::array<int, 2>, symmetric_size> tensor_places = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
constexpr std::size_t points_per_task = 512;

using Tensor = Eigen::Matrix<double, symmetric_size, 1>;

Matrix<3> matrix_of(const Tensor& tensor) {
  Matrix<3> matrix;
  for (std::size_t k = 0; k < tensor_places.size(); ++k) {
    const auto [i, j] = tensor_places[k];
    matrix(i, j) = matrix(j, i) = tensor[static_cast<Eigen::Index>(k)];
  }
  return matrix;
}

Tensor tensor_of(const Matrix<3>& matrix) {
  Tensor tensor;
  for (std::size_t k = 0; k < tensor_places.size(); ++k) {
    const auto [i, j] = tensor_places[k];
    tensor[static_cast<Eigen::Index>(k)] = 0.5 * (matrix(i, j) + matrix(j, i));
  }
  return tensor;
}

Matrix<3> deviator(const Matrix<3>& sigma) { return sigma - sigma.trace() / 3 * Matrix<3>::Identity(); }

/// Kirchhoff stress J sigma of J^(-2/3) DEV[A]; of A itself where no deviator is taken.
Matrix<3> pushed_forward(ViscoelasticForm form, const Matrix<3>& F, const Matrix<3>& A) {
  Matrix<3> tau = F * A * F.transpose();
  if (form != ViscoelasticForm::simo) return tau;
  return std::pow(F.determinant(), -2.0 / 3) * deviator(tau);
}

/// P:D of the nominal stress P = J^(-2/3) (F A - (F:F A)/3 F^-T) of J^(-2/3) DEV[A]; of F A where no deviator
/// is taken.
double nominal_work(ViscoelasticForm form, const Matrix<3>& F, const Matrix<3>& A, const Matrix<3>& D) {
  if (form != ViscoelasticForm::simo) return (F * A).cwiseProduct(D).sum();
  const Matrix<3> cofactors = cofactor(F), pull = F * A;
  const double J = F.row(0).dot(cofactors.row(0)), cube_root = std::cbrt(J);
  return (pull.cwiseProduct(D).sum() -
          pull.cwiseProduct(F).sum() / (3 * J) * cofactors.cwiseProduct(D).sum()) /
         (cube_root * cube_root);
}

/// P:D of the nominal stress P = q F^-T.
double pressure_work(double q, const Matrix<3>& F, const Matrix<3>& D) {
  const Matrix<3> cofactors = cofactor(F);
  return q / F.row(0).dot(cofactors.row(0)) * cofactors.cwiseProduct(D).sum();
}

bool relaxes_pressure(const std::vector<PronyBranch>& branches) {
  return std::ranges::any_of(branches, [](const PronyBranch& branch) { return branch.volume_share > 0; });
}

/// Internal variables of a quadrature point: X, the h_i; where the pressure relaxes Y and its branches.
Eigen::Index history_values_per_point(const std::vector<PronyBranch>& branches) {
  return (symmetric_size + (relaxes_pressure(branches) ? 1 : 0)) *
         (1 + static_cast<Eigen::Index>(branches.size()));
}

/// Place of Y in the internal variables of a point.
Eigen::Index place_of_pressure(const std::vector<PronyBranch>& branches) {
  return symmetric_size * (1 + static_cast<Eigen::Index>(branches.size()));
}

/// c: what is left of an increment that came evenly in this time.
double mean_decay(const PronyBranch& branch, double duration) {
  const double r = duration / branch.time;
  return r > 0 ? -std::expm1(-r) / r : 1;
}

/// e and c of each branch.
struct Decays {
  std::vector<double> whole, mean;

  Decays(const std::vector<PronyBranch>& branches, double duration) {
    for (const PronyBranch& branch : branches) {
      whole.push_back(std::exp(-duration / branch.time));
      mean.push_back(mean_decay(branch, duration));
    }
  }
};

/// The part s C:H / 2 + q ln J of a stage's energy.
class Overstress {
 public:
  /// @param rows  H and q by row of lanes: see OverstressRows
  Overstress(const ElasticEnergy& body, ViscoelasticForm form, bool has_pressure, std::vector<double> rows)
      : body_(body),
        rows_(std::move(rows)),
        is_isochoric_(form == ViscoelasticForm::simo),
        has_pressure_(has_pressure),
        kernels_(
            is_axisymmetric(body.tiles().blocks)
                ? axisymmetric_overstress_kernels(body.element().num_nodes, body.instruction_set())
                : overstress_kernels(body.element().dim, body.element().num_nodes, body.instruction_set())),
        all_blocks_(body.tiles().blocks.num_blocks) {
    std::iota(all_blocks_.begin(), all_blocks_.end(), 0);
  }

  const ElasticEnergy& body() const { return body_; }

  double difference(const std::vector<double>& from, const std::vector<double>& to) const {
    return sum([&](const QuadratureTile& tile, EnergySum& sum) {
      kernels_.add_differences(tile, overstress(), from.data(), to.data(), sum);
    });
  }
  double magnitude(const std::vector<double>& u) const {
    return sum([&](const QuadratureTile& tile, EnergySum& sum) {
      kernels_.add_magnitudes(tile, overstress(), u.data(), sum);
    });
  }
  void add_forces(const std::vector<double>& u, bool is_magnitude, VectorX& forces) const {
    body_.add_by_owner(
        [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
          kernels_.add_forces(body_.tiles().quadrature_tile(tile), overstress(), u.data(), is_magnitude,
                              owned, local);
        },
        forces);
  }
  void add_matrices(const std::vector<double>& u, Projection projection, const ElasticTiles::Tile& tile,
                    double* K) const {
    kernels_.add_matrices(body_.tiles().quadrature_tile(tile), overstress(), u.data(),
                          removed_part(projection), K);
  }

 private:
  OverstressRows overstress() const { return {rows_.data(), is_isochoric_, has_pressure_}; }

  template <class Add>
  double sum(const Add& add) const {
    const ElasticTiles& tiles = body_.tiles();
    return sum_of_tiles(tiles, all_blocks_,
                        [&](const ElasticTiles::Tile& tile, ElasticTiles::Scratch&, EnergySum& sum) {
                          add(tiles.quadrature_tile(tile), sum);
                        });
  }

  const ElasticEnergy& body_;
  std::vector<double> rows_;
  bool is_isochoric_, has_pressure_;
  const OverstressKernels& kernels_;
  std::vector<Index> all_blocks_;
};

/// Its matrices at a place, which the body adds with its own.
class OverstressMatrices final : public CellMatrices {
 public:
  OverstressMatrices(const Overstress& overstress, std::vector<double> displacements, Projection projection)
      : overstress_(overstress), displacements_(std::move(displacements)), projection_(projection) {}

  const ElasticEnergy& body() const override { return overstress_.body(); }
  void add_to(const ElasticTiles::Tile& tile, double* K) const override {
    overstress_.add_matrices(displacements_, projection_, tile, K);
  }

 private:
  const Overstress& overstress_;
  std::vector<double> displacements_;
  Projection projection_;
};

/// H and q of a stage that begins with `history`, by row of lanes: see OverstressRows.
std::vector<double> overstress_rows(const ElementBlocks& blocks, const std::vector<PronyBranch>& branches,
                                    const VectorX& history, double elapsed) {
  const bool has_pressure = relaxes_pressure(branches);
  const std::size_t rows_per_entry = OverstressRows{nullptr, true, has_pressure}.size() * block_size;
  const Eigen::Index values_per_point = history_values_per_point(branches);
  const Decays decays(branches, elapsed);
  std::vector<double> rows(blocks.num_blocks * blocks.num_points * rows_per_entry, 0.0);
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * block_size; i < end * block_size; ++i) {
      if (blocks.cells[i] < 0) continue;
      for (std::size_t q = 0; q < blocks.num_points; ++q) {
        const Eigen::Index point =
            Eigen::Index{blocks.cells[i]} * static_cast<Eigen::Index>(blocks.num_points) +
            static_cast<Eigen::Index>(q);
        const auto values = history.segment(point * values_per_point, values_per_point);
        Tensor H = Tensor::Zero();
        for (std::size_t k = 0; k < branches.size(); ++k)
          H += branches[k].share * (decays.whole[k] * values.segment<symmetric_size>(
                                                          symmetric_size * static_cast<Eigen::Index>(k + 1)) -
                                    decays.mean[k] * values.head<symmetric_size>());
        double* entry = rows.data() + ((i / block_size) * blocks.num_points + q) * rows_per_entry;
        for (std::size_t k = 0; k < tensor_places.size(); ++k)
          entry[k * block_size + i % block_size] = H[static_cast<Eigen::Index>(k)];
        if (!has_pressure) continue;
        const auto pressures = values.tail(static_cast<Eigen::Index>(1 + branches.size()));
        double& pull = entry[symmetric_size * block_size + i % block_size];
        for (std::size_t k = 0; k < branches.size(); ++k)
          pull += branches[k].volume_share * (decays.whole[k] * pressures[static_cast<Eigen::Index>(k + 1)] -
                                              decays.mean[k] * pressures[0]);
      }
    }
  });
  return rows;
}

/// The incremental potential of one stage.
class StageViscoelastic final : public BasicEnergy, public CellTerm {
 public:
  /// @param body     whose cells other terms refer to
  /// @param elastic  the same with the relaxing part of its energy scaled
  StageViscoelastic(const ElasticEnergy& body, std::shared_ptr<const ElasticEnergy> elastic,
                    const std::vector<PronyBranch>& branches, ViscoelasticForm form, VectorX history,
                    double elapsed)
      : body_(body),
        elastic_(std::move(elastic)),
        branches_(branches),
        form_(form),
        history_(std::move(history)),
        elapsed_(elapsed) {}

  std::string_view name() const override { return elastic_->name(); }
  EnergyProperties properties() const override { return elastic_->properties(); }
  double value(const VectorX& x, const Conditions& c) const override {
    const double elastic = elastic_->value(x, c);
    if (!std::isfinite(elastic)) return elastic;
    const std::vector<double> u = local(x);
    return elastic + overstress().difference(std::vector<double>(u.size(), 0.0), u);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    const double elastic = elastic_->difference(from, to, c);
    return std::isfinite(elastic) ? elastic + overstress().difference(local(from), local(to)) : elastic;
  }
  double magnitude(const VectorX& x, const Conditions& c) const override {
    return elastic_->magnitude(x, c) + overstress().magnitude(local(x));
  }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    elastic_->add_gradient(x, c, gradient);
    overstress().add_forces(local(x), false, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    elastic_->add_gradient_magnitude(x, c, magnitude);
    overstress().add_forces(local(x), true, magnitude);
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override {
    add_hessian_at({}, x, c, projection, hessian);
  }
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    return elastic_->max_step(x, p, c);
  }
  const CellTerm* cell_term() const override { return this; }
  VectorX internal_values(const VectorX& x) const override { return elastic_->internal_values(x); }
  Eigen::Index num_internal_values() const override { return elastic_->num_internal_values(); }
  VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const override {
    return elastic_->predicted_internal_values(x, p, t);
  }
  void add_hessian_at(const VectorX& internal, const VectorX& x, const Conditions& c, Projection projection,
                      BlockMatrix& hessian, std::span<const CellMatrices* const> along = {}) const override {
    const OverstressMatrices matrices(overstress(), local(x), projection);
    std::vector<const CellMatrices*> all(along.begin(), along.end());
    all.push_back(&matrices);
    elastic_->add_hessian_at(internal, x, c, projection, hessian, all);
  }
  bool takes(const CellMatrices& matrices) const override { return &matrices.body() == &body_; }

 private:
  std::vector<double> local(const VectorX& x) const {
    return elastic_->tiles().blocks.local_displacements(x);
  }

  /// Made when it is first asked for: reports of energies do without.
  const Overstress& overstress() const {
    std::call_once(is_made_, [this] {
      overstress_ = std::make_unique<const Overstress>(
          *elastic_, form_, relaxes_pressure(branches_),
          overstress_rows(elastic_->tiles().blocks, branches_, history_, elapsed_));
    });
    return *overstress_;
  }

  const ElasticEnergy& body_;
  std::shared_ptr<const ElasticEnergy> elastic_;
  const std::vector<PronyBranch>& branches_;
  ViscoelasticForm form_;
  VectorX history_;
  double elapsed_;
  mutable std::once_flag is_made_{};
  mutable std::unique_ptr<const Overstress> overstress_{};
};

}  // namespace

namespace {
bool is_bulk_modulus(const ConstantText& constant) { return constant.name == "bulk_modulus"; }
}  // namespace

bool has_isochoric_split(const LawInfo& law) {
  return std::ranges::all_of(parts_of(law), [](const LawPart& part) {
    return std::ranges::any_of(part.law->constants, is_bulk_modulus);
  });
}

// Psi is a stress times a pure number, so it is linear in all constants that are stresses together; the bulk
// modulus alone stands in U.
std::vector<double> relaxing_factors(const LawInfo& law, ViscoelasticForm form,
                                     const RemainingShares& shares) {
  std::vector<double> factors;
  for (const LawPart& part : parts_of(law))
    for (const ConstantText& constant : part.law->constants) {
      const bool is_of_volume = form != ViscoelasticForm::whole && is_bulk_modulus(constant);
      factors.push_back(constant.unit != "Pa" ? 1 : is_of_volume ? shares.volume : shares.shape);
    }
  return factors;
}

/// The copies that steps ask for again and again, the one asked for last first.
struct ViscoelasticEnergy::Scaled {
  struct Copy {
    RemainingShares shares;
    std::shared_ptr<const ElasticEnergy> energy;
  };
  std::mutex mutex;
  std::vector<Copy> copies;
};

ViscoelasticEnergy::~ViscoelasticEnergy() = default;

ViscoelasticEnergy::ViscoelasticEnergy(std::shared_ptr<ElasticEnergy> instantaneous,
                                       std::vector<PronyBranch> branches, ViscoelasticForm form)
    : instantaneous_(std::move(instantaneous)),
      branches_(std::move(branches)),
      form_(form),
      scaled_(std::make_unique<Scaled>()) {
  for (const PronyBranch& branch : branches_) {
    long_term_.shape -= branch.share;
    long_term_.volume -= branch.volume_share;
  }
}

void ViscoelasticEnergy::bind(const BlockPattern& pattern) {
  instantaneous_->bind(pattern);
  scaled_->copies.clear();
}

Eigen::Index ViscoelasticEnergy::values_per_point() const { return history_values_per_point(branches_); }

double ViscoelasticEnergy::pressure_pull(const double* values) const {
  double pull = 0;
  for (std::size_t k = 0; k < branches_.size(); ++k) pull += branches_[k].volume_share * values[k + 1];
  return pull;
}

Eigen::Index ViscoelasticEnergy::num_history_values() const {
  return Eigen::Index{instantaneous_->num_cells()} * instantaneous_->num_points() * values_per_point();
}

std::shared_ptr<const ElasticEnergy> ViscoelasticEnergy::with_shares(const RemainingShares& shares) const {
  constexpr std::size_t most = 3;  // the long term and two lengths of a stage
  const std::scoped_lock lock(scaled_->mutex);
  std::vector<Scaled::Copy>& copies = scaled_->copies;
  const auto found = std::ranges::find(copies, shares, &Scaled::Copy::shares);
  if (found != copies.end()) {
    std::rotate(copies.begin(), found, found + 1);
    return copies.front().energy;
  }
  if (copies.size() == most) copies.pop_back();
  const auto energy = std::make_shared<const ElasticEnergy>(
      instantaneous_->with_scaled_constants(relaxing_factors(instantaneous_->law(), form_, shares)));
  copies.insert(copies.begin(), {.shares = shares, .energy = energy});
  return energy;
}

std::unique_ptr<Energy> ViscoelasticEnergy::begin_stage_after(const VectorX& history,
                                                              const Stage& stage) const {
  std::shared_ptr<const ElasticEnergy> elastic = instantaneous_;  // where no time has passed
  if (stage.elapsed > 0) {
    RemainingShares shares = long_term_;
    for (const PronyBranch& branch : branches_) {
      const double c = mean_decay(branch, stage.elapsed);
      shares.shape += branch.share * c;
      shares.volume += branch.volume_share * c;
    }
    elastic = with_shares(shares);
  }
  return std::make_unique<StageViscoelastic>(*instantaneous_, std::move(elastic), branches_, form_, history,
                                             stage.elapsed);
}

HistoryTerm::Advance ViscoelasticEnergy::advance(const VectorX& history, const VectorX& from,
                                                 const VectorX& to, double duration) const {
  const std::vector<Matrix<3>> stresses = instantaneous_->cauchy_stresses(to);
  const std::vector<Matrix<3>> gradients = instantaneous_->deformation_gradients(to);
  const std::vector<Matrix<3>> before = instantaneous_->deformation_gradients(from);
  const std::vector<double> volumes = instantaneous_->point_volumes();
  const Decays decays(branches_, duration);
  const bool has_pressure = relaxes_pressure(branches_);
  Advance result{.history = VectorX(history.size())};
  result.heat =
      parallel_sum<double>(gradients.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
        double heat = 0;
        for (std::size_t point = begin; point < end; ++point) {
          const auto first = static_cast<Eigen::Index>(point) * values_per_point();
          const Matrix<3>&F = gradients[point], &F_n = before[point], inverse = F.inverse();
          const double J = F.determinant();
          const Matrix<3> relaxing =
              form_ == ViscoelasticForm::whole ? stresses[point] : deviator(stresses[point]);
          const double scale = form_ == ViscoelasticForm::simo ? std::cbrt(J * J) * J : J;
          const Tensor X = tensor_of(scale * (inverse * relaxing * inverse.transpose()));
          const Tensor change = X - history.segment<symmetric_size>(first);
          Tensor pull = Tensor::Zero(), pull_before = Tensor::Zero();  // sum_i g_i h_i
          for (std::size_t k = 0; k < branches_.size(); ++k) {
            const Eigen::Index at = first + symmetric_size * static_cast<Eigen::Index>(k + 1);
            const Tensor h_n = history.segment<symmetric_size>(at);
            const Tensor h = decays.whole[k] * h_n + decays.mean[k] * change;
            result.history.segment<symmetric_size>(at) = h;
            pull += branches_[k].share * h;
            pull_before += branches_[k].share * h_n;
          }
          result.history.segment<symmetric_size>(first) = X;
          // Work of the mean of the nominal stresses at both ends.
          const Matrix<3> D = F - F_n;
          heat += volumes[point] * 0.5 *
                  (nominal_work(form_, F, matrix_of(pull), D) +
                   nominal_work(form_, F_n, matrix_of(pull_before), D));
          if (!has_pressure) continue;
          const double *y_n = history.data() + first + place_of_pressure(branches_),
                       Y = J * stresses[point].trace() / 3;
          double* y = result.history.data() + first + place_of_pressure(branches_);
          y[0] = Y;
          for (std::size_t k = 0; k < branches_.size(); ++k)
            y[k + 1] = decays.whole[k] * y_n[k + 1] + decays.mean[k] * (Y - y_n[0]);
          heat += volumes[point] * 0.5 *
                  (pressure_work(pressure_pull(y), F, D) + pressure_work(pressure_pull(y_n), F_n, D));
        }
        return heat;
      });
  return result;
}

double ViscoelasticEnergy::stored_energy(const VectorX& x) const {
  return with_shares(long_term_)->value(x, {});
}

double ViscoelasticEnergy::stored_difference(const VectorX& from, const VectorX& to) const {
  return with_shares(long_term_)->difference(from, to, {});
}

std::vector<Matrix<3>> ViscoelasticEnergy::cauchy_stresses(const VectorX& x, const VectorX& history) const {
  std::vector<Matrix<3>> stresses = instantaneous_->cauchy_stresses(x);
  const std::vector<Matrix<3>> gradients = instantaneous_->deformation_gradients(x);
  const bool has_pressure = relaxes_pressure(branches_);
  parallel_for(stresses.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t point = begin; point < end; ++point) {
      const auto first = static_cast<Eigen::Index>(point) * values_per_point();
      Tensor pull = Tensor::Zero();
      for (std::size_t k = 0; k < branches_.size(); ++k)
        pull += branches_[k].share *
                history.segment<symmetric_size>(first + symmetric_size * static_cast<Eigen::Index>(k + 1));
      const Matrix<3> relaxing =
          form_ == ViscoelasticForm::whole ? stresses[point] : deviator(stresses[point]);
      const double J = gradients[point].determinant(), pressure = stresses[point].trace() / 3;
      stresses[point] +=
          (long_term_.shape - 1) * relaxing + pushed_forward(form_, gradients[point], matrix_of(pull)) / J;
      if (!has_pressure) continue;
      const double* y = history.data() + first + place_of_pressure(branches_);
      stresses[point] += ((long_term_.volume - 1) * pressure + pressure_pull(y) / J) * Matrix<3>::Identity();
    }
  });
  return stresses;
}

std::vector<double> ViscoelasticEnergy::energy_densities(const VectorX& x) const {
  return with_shares(long_term_)->energy_densities(x);
}

}  // namespace resilin
