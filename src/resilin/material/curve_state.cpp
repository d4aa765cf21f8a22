#include "resilin/material/curve_state.hpp"

#include <cmath>
#include <limits>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

constexpr double smallest_stretch = 1e-6, largest_stretch = 1e6;

bool has_fibres(const Material& material) { return !material.fibres.empty(); }

/// dP_ii/dF_kk: the Hessian of Psi in the stretches.
Matrix<3> stretch_hessian(const TangentMatrix<3>& A) {
  Matrix<3> M;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) M(i, k) = A(4 * i, 4 * k);
  return M;
}

double smallest_eigenvalue(const Eigen::MatrixXd& matrix) { return dense::symmetric_eigenvalues(matrix)[0]; }

/// The smallest eigenvalue of the acoustic tensor Q_ik = A_ijkl n_j n_l for n along the axes.
double smallest_wave_modulus(const TangentMatrix<3>& A) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) smallest = std::min(smallest, smallest_eigenvalue(A.block<3, 3>(3 * j, 3 * j)));
  return smallest;
}

}  // namespace

LoadedBlock::LoadedBlock(const Material& material, LoadCase load_case)
    : material_(material), load_case_(load_case), loaded_(Vector3::Zero()), free_(3, 0) {
  switch (load_case) {
    case LoadCase::uniaxial:
      loaded_ = Vector3::UnitX();
      free_.resize(3, has_fibres(material) ? 2 : 1);
      if (has_fibres(material))
        free_ << 0, 0, 1, 0, 0, 1;
      else
        free_ << 0, 1, 1;
      break;
    case LoadCase::equibiaxial:
      loaded_ = Vector3(1, 1, 0);
      free_.resize(3, 1);
      free_ << 0, 0, 1;
      break;
    case LoadCase::planar:
      loaded_ = Vector3::UnitX();
      free_.resize(3, 1);
      free_ << 0, 1, 0;
      break;
    case LoadCase::volumetric:
      loaded_ = Vector3::Ones();
      break;
    case LoadCase::shear:
      break;
  }
}

Vector3 LoadedBlock::stretches(const State& state) const { return deformation_gradient(state).diagonal(); }

Matrix<3> LoadedBlock::displacement_gradient(const State& state) const {
  Matrix<3> H = Matrix<3>::Zero();
  H.diagonal() = free_ * state.free;
  if (load_case_ == LoadCase::shear)
    H(0, 1) = state.load;
  else
    H.diagonal() += (state.load - 1) * loaded_;
  return H;
}

Matrix<3> LoadedBlock::deformation_gradient(const State& state) const {
  Matrix<3> F = displacement_gradient(state) + Matrix<3>::Identity();
  for (int i = 0; i < 3; ++i)
    if (loaded_[i] != 0) F(i, i) = state.load;  // a stretch of 1e-20 is not 1 + (1e-20 - 1)
  return F;
}

// The displacement gradient keeps the digits of small strains, F those of a block that is nearly flat.

Matrix<3> LoadedBlock::stress(const State& state) const {
  const Matrix<3> H = displacement_gradient(state);
  return H.cwiseAbs().maxCoeff() < 0.5
             ? from_displacement_gradient::first_piola_kirchhoff_stress<3>(material_, H)
             : first_piola_kirchhoff_stress<3>(material_, deformation_gradient(state));
}

TangentMatrix<3> LoadedBlock::tangent(const State& state) const {
  const Matrix<3> H = displacement_gradient(state);
  return H.cwiseAbs().maxCoeff() < 0.5 ? from_displacement_gradient::stress_tangent<3>(material_, H)
                                       : stress_tangent<3>(material_, deformation_gradient(state));
}

double LoadedBlock::energy_density(const State& state) const {
  const Matrix<3> H = displacement_gradient(state);
  return H.cwiseAbs().maxCoeff() < 0.5 ? from_displacement_gradient::energy_density<3>(material_, H)
                                       : resilin::energy_density<3>(material_, deformation_gradient(state));
}

double LoadedBlock::component(const Matrix<3>& stress) const {
  if (load_case_ == LoadCase::shear) return stress(0, 1);
  return load_case_ == LoadCase::volumetric ? stress.trace() / 3 : stress(0, 0);
}

double LoadedBlock::nominal_stress(const State& state) const { return component(stress(state)); }

double LoadedBlock::cauchy_stress(const State& state) const {
  const Matrix<3> P = stress(state);
  if (material_.law->kind == LawKind::small_strain) return component(P);
  return component(P * deformation_gradient(state).transpose() / volume_ratio(state));
}

LoadedBlock::Derivatives LoadedBlock::derivatives(const State& state) const {
  return {free_.transpose() * stress(state).diagonal(),
          free_.transpose() * stretch_hessian(tangent(state)) * free_};
}

/// Scale of the unknowns: the strain of the state.
double LoadedBlock::scale(const State& state) const {
  return std::max(state.free.cwiseAbs().maxCoeff(), std::abs(state.load - rest_load()));
}

/// The state that the tangent at `from` promises: d free = -K_ff^-1 K_fl d load.
LoadedBlock::State LoadedBlock::predict(double load, const State& from) const {
  const Matrix<3> M = stretch_hessian(tangent(from));
  const Square K = free_.transpose() * M * free_;
  const Free change = dense::solve(K, free_.transpose() * M * loaded_) * (from.load - load);
  State state{load, from.free + change};
  if (!change.allFinite() || state.free.minCoeff() <= smallest_stretch - 1) state.free = from.free;
  return state;
}

/// A Newton step with the absolute values of the Hessian's eigenvalues, shortened until the energy falls;
/// false when no step does.
bool LoadedBlock::descend(State& state, const Derivatives& slope) const {
  const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(slope.hessian);
  const Square vectors = eigen.vectors;
  const Free moduli = eigen.values.cwiseAbs();
  const Free direction = -(vectors * (vectors.transpose() * slope.gradient).cwiseQuotient(moduli));
  if (!direction.allFinite()) return false;
  double step = 1;
  for (Eigen::Index k = 0; k < direction.size(); ++k) {  // no stretch changes more than fivefold
    const double stretch = 1 + state.free[k], limit = direction[k] < 0 ? 0.8 * stretch : 4 * stretch;
    if (std::abs(direction[k]) > limit) step = std::min(step, limit / std::abs(direction[k]));
  }
  const double energy = energy_density(state), fall = slope.gradient.dot(direction);
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * std::abs(energy);
  for (; step > 1e-10; step /= 2) {
    const State next{state.load, state.free + step * direction};
    if (energy_density(next) <= energy + 1e-4 * step * fall + rounding) {
      state = next;
      return true;
    }
  }
  return false;
}

/// Plain Newton steps as long as they lower the stress on the free faces; true when what is left of it is
/// round-off and the state is a minimum.
bool LoadedBlock::polish(State& state) const {
  Derivatives now = derivatives(state);
  for (int i = 0; i < 5; ++i) {
    const State next{state.load, state.free - dense::solve(now.hessian, now.gradient)};
    const Derivatives then = derivatives(next);
    if (!(then.gradient.norm() < now.gradient.norm())) break;
    state = next;
    now = then;
  }
  if (!now.hessian.allFinite() || !(smallest_eigenvalue(now.hessian) > 0)) return false;
  const Free left = dense::solve(now.hessian, now.gradient);
  return left.cwiseAbs().maxCoeff() <= 1e-8 * scale(state);
}

std::optional<LoadedBlock::State> LoadedBlock::solve(double load, const State& from) const {
  State state = free_.cols() == 0 ? State{load, from.free} : predict(load, from);
  if (!std::isfinite(energy_density(state))) state.free = from.free;
  if (!std::isfinite(energy_density(state)) || !stress(state).allFinite()) return std::nullopt;
  if (free_.cols() == 0) return state;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Derivatives slope = derivatives(state);
    if (!slope.gradient.allFinite() || !slope.hessian.allFinite()) return std::nullopt;
    const State before = state;
    if (!descend(state, slope)) break;
    const Free stretch = Free::Ones(state.free.size()) + state.free;
    if (stretch.minCoeff() < smallest_stretch || stretch.maxCoeff() > largest_stretch) return std::nullopt;
    if ((state.free - before.free).cwiseAbs().maxCoeff() <= 1e-9 * scale(state)) break;
  }
  if (!polish(state)) return std::nullopt;
  return state;
}

Stability LoadedBlock::stability(const State& state) const {
  const TangentMatrix<3> A = tangent(state);
  if (!A.allFinite()) return Stability::no_state;
  const double round_off = 1e-12 * A.cwiseAbs().maxCoeff();
  if (load_case_ == LoadCase::shear) {
    if (!(A(3, 3) > round_off)) return Stability::stress_drops;
  } else {
    Matrix<3> M = stretch_hessian(A);
    // Dead loads, but for a pressure p, which follows the faces and has the potential -p J.
    if (load_case_ == LoadCase::volumetric && material_.law->kind != LawKind::small_strain)
      M -= cauchy_stress(state) * state.load * (Matrix<3>::Ones() - Matrix<3>::Identity());
    const Vector3 stiffness = M * loaded_;
    double condensed = loaded_.dot(stiffness);
    if (free_.cols() > 0) {
      const Free coupling = free_.transpose() * stiffness;
      condensed -= coupling.dot(dense::solve(free_.transpose() * M * free_, coupling));
    }
    if (!(condensed > round_off)) return Stability::stress_drops;
    const int moving = load_case_ == LoadCase::planar ? 2 : 3;
    if (!(smallest_eigenvalue(M.topLeftCorner(moving, moving)) > round_off))
      return Stability::directions_part;
  }
  return smallest_wave_modulus(A) > round_off ? Stability::stable : Stability::not_elliptic;
}

}  // namespace resilin
