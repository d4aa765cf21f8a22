#include "resilin/energy/viscoelastic.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/lane_geometry.hpp"

namespace resilin {
namespace {

/// Components of a symmetric tensor as the history has them: xx, yy, zz, xy, yz, xz.
constexpr Eigen::Index tensor_size = 6;
constexpr std::array<std::array<int, 2>, tensor_size> tensor_places = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
constexpr std::size_t points_per_task = 512;

using Tensor = Eigen::Matrix<double, tensor_size, 1>;

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

/// Kirchhoff stress J sigma of J^(-2/3) DEV[A].
Matrix<3> pushed_forward(const Matrix<3>& F, const Matrix<3>& A) {
  return std::pow(F.determinant(), -2.0 / 3) * deviator(F * A * F.transpose());
}

double decay(const PronyBranch& branch, double duration) { return std::exp(-duration / branch.time); }

/// c: what is left of an increment that came evenly in this time.
double mean_decay(const PronyBranch& branch, double duration) {
  const double r = duration / branch.time;
  return r > 0 ? -std::expm1(-r) / r : 1;
}

/// s = J^(-2/3)
LaneRow isochoric_scale(const LaneRow& J) {
  LaneRow s;
  for (Eigen::Index lane = 0; lane < J.size(); ++lane) s[lane] = 1 / std::cbrt(J[lane] * J[lane]);
  return s;
}

/// J = det F, of F and its cofactors.
template <int dim>
LaneRow determinant(const LaneMatrix<dim>& F, const LaneMatrix<dim>& cofactors) {
  LaneRow J = F(0, 0) * cofactors(0, 0);
  for (int k = 1; k < dim; ++k) J += F(0, k) * cofactors(0, k);
  return J;
}
template <int dim>
LaneRow determinant(const LaneMatrix<dim>& F) {
  return determinant(F, cofactor(F));
}

/// H of one block of cells at a quadrature point; zz is its part out of a plane.
template <int dim>
struct LaneHistory {
  LaneMatrix<dim> H;
  LaneRow zz;

  explicit LaneHistory(const double* rows) {
    const auto row = [rows](std::size_t k) {
      return LaneRow(Eigen::Map<const LaneRow>(rows + k * block_size));
    };
    for (std::size_t k = 0; k < tensor_places.size(); ++k) {
      const auto [i, j] = tensor_places[k];
      if (i < dim && j < dim) H(i, j) = H(j, i) = row(k);
    }
    zz = dim == 2 ? row(2) : LaneRow(LaneRow::Zero());
  }
};

/// Terms of the derivatives of s C:H / 2 by F.
template <int dim>
struct OverstressAt {
  LaneMatrix<dim> G;  ///< F^-T
  LaneMatrix<dim> Q;  ///< F H
  LaneRow s, t;       ///< J^(-2/3), C:H

  OverstressAt(const LaneMatrix<dim>& F, const LaneHistory<dim>& history) : Q(F * history.H) {
    const LaneMatrix<dim> cofactors = cofactor(F);
    const LaneRow J = determinant(F, cofactors);
    G = LaneRow(1 / J) * cofactors;
    s = isochoric_scale(J);
    t = contracted(F, Q) + history.zz;
  }
  /// P = s (F H - t/3 F^-T)
  LaneMatrix<dim> stress() const { return s * (Q - LaneRow(t / 3) * G); }
};

/// The part J^(-2/3) C:H / 2 of a stage's energy.
class Overstress {
 public:
  /// @param rows  H by row of lanes: [block][point][tensor_size][lane]
  Overstress(const ElasticEnergy& body, std::vector<double> rows) : body_(body), rows_(std::move(rows)) {}

  const ElasticEnergy& body() const { return body_; }
  void add_matrices(const std::vector<double>& u, Projection projection, const ElasticTiles::Tile& tile,
                    double* K) const {
    body_.element().dim == 2 ? add_matrices_of<2>(u, projection, tile, K)
                             : add_matrices_of<3>(u, projection, tile, K);
  }
  double difference(const std::vector<double>& from, const std::vector<double>& to) const {
    return body_.element().dim == 2 ? difference_of<2>(from, to) : difference_of<3>(from, to);
  }
  double magnitude(const std::vector<double>& u) const {
    return body_.element().dim == 2 ? magnitude_of<2>(u) : magnitude_of<3>(u);
  }
  void add_forces(const std::vector<double>& u, bool is_magnitude, VectorX& forces) const {
    body_.element().dim == 2 ? add_forces_of<2>(u, is_magnitude, forces)
                             : add_forces_of<3>(u, is_magnitude, forces);
  }

 private:
  template <int dim>
  LaneHistory<dim> history(std::size_t block, std::size_t point) const {
    const std::size_t entry = block * body_.tiles().blocks.num_points + point;
    return LaneHistory<dim>(rows_.data() + entry * static_cast<std::size_t>(tensor_size) * block_size);
  }

  /// Sum over the points of `density(point, H)` times their volumes.
  template <int dim, class Density>
  double sum(const Density& density) const {
    const ElementBlocks& blocks = body_.tiles().blocks;
    return parallel_sum<double>(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
      LaneRow lanes = LaneRow::Zero();
      for (std::size_t block = begin; block < end; ++block)
        for (std::size_t q = 0; q < blocks.num_points; ++q) {
          const LanePoint<dim> at(blocks, block, q);
          lanes += (at.weight() > 0).select(at.weight() * density(at, history<dim>(block, q)), 0.0);
        }
      double total = 0;
      for (const double lane : lanes) total += lane;
      return total;
    });
  }

  /// Each factor as a difference, so that the sum keeps its digits when the two shapes are close.
  template <int dim>
  double difference_of(const std::vector<double>& from, const std::vector<double>& to) const {
    std::vector<double> change(to.size());
    std::ranges::transform(to, from, change.begin(), std::minus<>());
    return sum<dim>([&](const LanePoint<dim>& at, const LaneHistory<dim>& history) -> LaneRow {
      const LaneRow one = LaneRow::Ones();
      const LaneMatrix<dim> F = at.gradient(from).plus_identity(one), D = at.gradient(change);
      const LaneMatrix<dim> twice_mean = F + F + D;
      // det(M + D/2) - det(M - D/2) = cof(M):D + det(D)/4 in 3D, M being the mean
      LaneRow change_of_J = contracted(cofactor(LaneRow(0.5 * one) * twice_mean), D);
      if (dim == 3) change_of_J += 0.25 * determinant(D);
      const LaneRow J = determinant(F), s = isochoric_scale(J);
      LaneRow change_of_s;
      for (Eigen::Index lane = 0; lane < s.size(); ++lane)
        change_of_s[lane] = s[lane] * std::expm1(-2.0 / 3 * std::log1p(change_of_J[lane] / J[lane]));
      // C:H of the end less that of the start is D:((F + F + D) H)
      const LaneRow change_of_t = contracted(D, twice_mean * history.H);
      const LaneRow t = contracted(F, F * history.H) + history.zz;
      return 0.5 * ((s + change_of_s) * change_of_t + change_of_s * t);
    });
  }

  template <int dim>
  double magnitude_of(const std::vector<double>& u) const {
    return sum<dim>([&](const LanePoint<dim>& at, const LaneHistory<dim>& history) -> LaneRow {
      const LaneMatrix<dim> F = at.gradient(u).plus_identity(LaneRow::Ones());
      const LaneMatrix<dim> C = F.transposed() * F;
      LaneRow parts = history.zz.abs();
      for (std::size_t k = 0; k < C.entries.size(); ++k) parts += (C.entries[k] * history.H.entries[k]).abs();
      return 0.5 * isochoric_scale(determinant(F)) * parts;
    });
  }

  template <int dim>
  void add_forces_of(const std::vector<double>& u, bool is_magnitude, VectorX& forces) const {
    const ElementBlocks& blocks = body_.tiles().blocks;
    body_.add_by_owner(
        [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
          for (std::size_t i = 0; i < tile.num_blocks; ++i)
            for (std::size_t q = 0; q < blocks.num_points; ++q) {
              const auto block = static_cast<std::size_t>(tile.blocks[i]);
              const LanePoint<dim> at(blocks, block, q);
              const LaneMatrix<dim> F = at.gradient(u).plus_identity(LaneRow::Ones());
              at.add(OverstressAt<dim>(F, history<dim>(block, q)).stress(), owned, local, is_magnitude);
            }
        },
        forces);
  }

  /// With n_a = F^-T g_a and q_a = F H g_a the exact block of nodes a and b is
  ///
  ///   s ((g_a.H g_b) 1 - 2/3 (n_a q_b^T + q_a n_b^T) + t/3 n_b n_a^T + 2/9 t n_a n_b^T).
  ///
  /// Projected, it is s (g_a.H' g_b) 1 with the eigenvalues of H projected: never negative, and close where
  /// the branches pull.
  template <int dim>
  void add_matrices_of(const std::vector<double>& u, Projection projection, const ElasticTiles::Tile& tile,
                       double* K) const {
    const ElementBlocks& blocks = body_.tiles().blocks;
    const auto num_nodes = static_cast<std::size_t>(blocks.num_nodes);
    const auto size = static_cast<std::size_t>(blocks.num_pairs() * dim * dim) * block_size;
    constexpr auto d = static_cast<std::size_t>(dim);
    std::array<LaneRow, d * max_element_nodes> n, q, Hg;
    for (std::size_t i = 0; i < tile.num_blocks; ++i)
      for (std::size_t point = 0; point < blocks.num_points; ++point) {
        const auto block = static_cast<std::size_t>(tile.blocks[i]);
        const LanePoint<dim> at(blocks, block, point);
        LaneHistory<dim> history = this->history<dim>(block, point);
        const LaneMatrix<dim> F = at.gradient(u).plus_identity(LaneRow::Ones());
        const OverstressAt<dim> here(F, history);
        const bool is_exact = projection == Projection::none;
        if (!is_exact) project<dim>(projection, history.H);
        for (std::size_t a = 0; a < num_nodes; ++a)
          for (std::size_t k = 0; k < d; ++k) {
            n[a * d + k].setZero();
            q[a * d + k].setZero();
            Hg[a * d + k].setZero();
            for (int m = 0; m < dim; ++m) {
              const LaneRow& slope = at.slope(a, m);
              Hg[a * d + k] += history.H(static_cast<int>(k), m) * slope;
              if (!is_exact) continue;
              n[a * d + k] += here.G(static_cast<int>(k), m) * slope;
              q[a * d + k] += here.Q(static_cast<int>(k), m) * slope;
            }
          }
        const LaneRow scale = at.weight() * here.s, third = here.t / 3;
        double* rows = K + i * size;
        for (std::size_t a = 0; a < num_nodes; ++a)
          for (std::size_t b = a; b < num_nodes; ++b)
            for (std::size_t r = 0; r < d; ++r)
              for (std::size_t c = 0; c < d; ++c, rows += block_size) {
                LaneRow entry = LaneRow::Zero();
                if (r == c)
                  for (std::size_t m = 0; m < d; ++m)
                    entry += at.slope(a, static_cast<int>(m)) * Hg[b * d + m];
                if (is_exact)
                  entry += third * n[b * d + r] * n[a * d + c] -
                           (2.0 / 3) * (n[a * d + r] * (q[b * d + c] - third * n[b * d + c]) +
                                        q[a * d + r] * n[b * d + c]);
                Eigen::Map<LaneRow>(rows) += (at.weight() > 0).select(scale * entry, 0.0);
              }
      }
  }

  template <int dim>
  static void project(Projection projection, LaneMatrix<dim>& H) {
    for (Eigen::Index lane = 0; lane < static_cast<Eigen::Index>(block_size); ++lane) {
      Matrix<dim> of_lane;
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) of_lane(i, k) = H(i, k)[lane];
      const Eigen::SelfAdjointEigenSolver<Matrix<dim>> eigen(of_lane);
      const auto values = projection == Projection::clamp ? Vector<dim>(eigen.eigenvalues().cwiseMax(0))
                                                          : Vector<dim>(eigen.eigenvalues().cwiseAbs());
      of_lane = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) H(i, k)[lane] = of_lane(i, k);
    }
  }

  const ElasticEnergy& body_;
  std::vector<double> rows_;
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

/// H of a stage that begins with `history`, by row of lanes: [block][point][tensor_size][lane].
std::vector<double> overstress_rows(const ElementBlocks& blocks, const std::vector<PronyBranch>& branches,
                                    const VectorX& history, double elapsed) {
  const auto rows_per_entry = static_cast<std::size_t>(tensor_size) * block_size;
  const auto values_per_point = tensor_size * static_cast<Eigen::Index>(1 + branches.size());
  std::vector<double> decays, mean_decays;
  for (const PronyBranch& branch : branches) {
    decays.push_back(decay(branch, elapsed));
    mean_decays.push_back(mean_decay(branch, elapsed));
  }
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
          H += branches[k].share *
               (decays[k] * values.segment<tensor_size>(tensor_size * static_cast<Eigen::Index>(k + 1)) -
                mean_decays[k] * values.head<tensor_size>());
        double* entry = rows.data() + ((i / block_size) * blocks.num_points + q) * rows_per_entry;
        for (std::size_t k = 0; k < tensor_places.size(); ++k)
          entry[k * block_size + i % block_size] = H[static_cast<Eigen::Index>(k)];
      }
    }
  });
  return rows;
}

/// The incremental potential of one stage.
class StageViscoelastic final : public BasicEnergy {
 public:
  /// @param body     whose cells other terms refer to
  /// @param elastic  the same with its isochoric part scaled
  StageViscoelastic(const ElasticEnergy& body, std::shared_ptr<const ElasticEnergy> elastic,
                    const std::vector<PronyBranch>& branches, VectorX history, double elapsed)
      : body_(body),
        elastic_(std::move(elastic)),
        branches_(branches),
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
          *elastic_, overstress_rows(elastic_->tiles().blocks, branches_, history_, elapsed_));
    });
    return *overstress_;
  }

  const ElasticEnergy& body_;
  std::shared_ptr<const ElasticEnergy> elastic_;
  const std::vector<PronyBranch>& branches_;
  VectorX history_;
  double elapsed_;
  mutable std::once_flag is_made_{};
  mutable std::unique_ptr<const Overstress> overstress_{};
};

}  // namespace

bool has_isochoric_split(const LawInfo& law) {
  return std::ranges::any_of(law.constants,
                             [](const ConstantText& constant) { return constant.name == "bulk_modulus"; });
}

// Psi is a stress times a pure number, so it is linear in all constants that are stresses together; the bulk
// modulus alone stands in U.
std::vector<double> isochoric_factors(const LawInfo& law, double factor) {
  std::vector<double> factors;
  for (const ConstantText& constant : law.constants)
    factors.push_back(constant.unit == "Pa" && constant.name != "bulk_modulus" ? factor : 1);
  return factors;
}

ViscoelasticEnergy::ViscoelasticEnergy(std::shared_ptr<ElasticEnergy> instantaneous,
                                       std::vector<PronyBranch> branches)
    : instantaneous_(std::move(instantaneous)), branches_(std::move(branches)) {
  for (const PronyBranch& branch : branches_) long_term_share_ -= branch.share;
}

Eigen::Index ViscoelasticEnergy::values_per_point() const {
  return tensor_size * (1 + static_cast<Eigen::Index>(branches_.size()));
}

Eigen::Index ViscoelasticEnergy::num_history_values() const {
  return Eigen::Index{instantaneous_->num_cells()} * instantaneous_->num_points() * values_per_point();
}

ElasticEnergy ViscoelasticEnergy::with_isochoric_share(double share) const {
  return instantaneous_->with_scaled_constants(isochoric_factors(instantaneous_->law(), share));
}

std::unique_ptr<Energy> ViscoelasticEnergy::begin_stage_after(const VectorX& history,
                                                              const Stage& stage) const {
  std::shared_ptr<const ElasticEnergy> elastic = instantaneous_;  // where no time has passed
  if (stage.elapsed > 0) {
    double share = long_term_share_;
    for (const PronyBranch& branch : branches_) share += branch.share * mean_decay(branch, stage.elapsed);
    elastic = std::make_shared<const ElasticEnergy>(with_isochoric_share(share));
  }
  return std::make_unique<StageViscoelastic>(*instantaneous_, std::move(elastic), branches_, history,
                                             stage.elapsed);
}

HistoryTerm::Advance ViscoelasticEnergy::advance(const VectorX& history, const VectorX& from,
                                                 const VectorX& to, double duration) const {
  const std::vector<Matrix<3>> stresses = instantaneous_->cauchy_stresses(to);
  const std::vector<Matrix<3>> gradients = instantaneous_->deformation_gradients(to);
  const std::vector<Matrix<3>> before = instantaneous_->deformation_gradients(from);
  const std::vector<double> volumes = instantaneous_->point_volumes();
  Advance result{.history = VectorX(history.size())};
  result.heat =
      parallel_sum<double>(gradients.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
        double heat = 0;
        for (std::size_t point = begin; point < end; ++point) {
          const auto first = static_cast<Eigen::Index>(point) * values_per_point();
          const Matrix<3>&F = gradients[point], &F_n = before[point], inverse = F.inverse();
          const double J = F.determinant();
          const Tensor X =
              tensor_of(std::cbrt(J * J) * J * (inverse * deviator(stresses[point]) * inverse.transpose()));
          const Tensor change = X - history.segment<tensor_size>(first);
          Tensor pull = Tensor::Zero(), pull_before = Tensor::Zero();  // sum_i g_i h_i
          for (std::size_t k = 0; k < branches_.size(); ++k) {
            const PronyBranch& branch = branches_[k];
            const Eigen::Index at = first + tensor_size * static_cast<Eigen::Index>(k + 1);
            const Tensor h_n = history.segment<tensor_size>(at);
            const Tensor h = decay(branch, duration) * h_n + mean_decay(branch, duration) * change;
            result.history.segment<tensor_size>(at) = h;
            pull += branch.share * h;
            pull_before += branch.share * h_n;
          }
          result.history.segment<tensor_size>(first) = X;
          // Work of the nominal stresses P = tau F^-T on F - F_n, the mean of those at both ends.
          const Matrix<3> P = pushed_forward(F, matrix_of(pull)) * inverse.transpose();
          const Matrix<3> P_n = pushed_forward(F_n, matrix_of(pull_before)) * F_n.inverse().transpose();
          heat += volumes[point] * 0.5 * (P + P_n).cwiseProduct(F - F_n).sum();
        }
        return heat;
      });
  return result;
}

double ViscoelasticEnergy::stored_energy(const VectorX& x) const {
  return with_isochoric_share(long_term_share_).value(x, {});
}

double ViscoelasticEnergy::stored_difference(const VectorX& from, const VectorX& to) const {
  return with_isochoric_share(long_term_share_).difference(from, to, {});
}

std::vector<Matrix<3>> ViscoelasticEnergy::cauchy_stresses(const VectorX& x, const VectorX& history) const {
  std::vector<Matrix<3>> stresses = instantaneous_->cauchy_stresses(x);
  const std::vector<Matrix<3>> gradients = instantaneous_->deformation_gradients(x);
  parallel_for(stresses.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t point = begin; point < end; ++point) {
      const auto first = static_cast<Eigen::Index>(point) * values_per_point();
      Tensor pull = Tensor::Zero();
      for (std::size_t k = 0; k < branches_.size(); ++k)
        pull += branches_[k].share *
                history.segment<tensor_size>(first + tensor_size * static_cast<Eigen::Index>(k + 1));
      const Matrix<3> isochoric = deviator(stresses[point]);
      stresses[point] += (long_term_share_ - 1) * isochoric +
                         pushed_forward(gradients[point], matrix_of(pull)) / gradients[point].determinant();
    }
  });
  return stresses;
}

std::vector<double> ViscoelasticEnergy::energy_densities(const VectorX& x) const {
  return with_isochoric_share(long_term_share_).energy_densities(x);
}

}  // namespace resilin
