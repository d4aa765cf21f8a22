#include "resilin/fit/homogeneous_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resilin/fit/state_batch.hpp"

namespace resilin {
namespace {

/// Whether each of the three edges is free.
std::array<bool, 3> free_edges(TestMode mode) {
  switch (mode) {
    case TestMode::uniaxial:
      return {false, true, true};
    case TestMode::equibiaxial:
      return {false, false, true};
    case TestMode::planar:
      return {false, true, false};
    default:
      return {false, false, false};
  }
}

bool has_free_edges(TestMode mode) { return free_edges(mode)[1] || free_edges(mode)[2]; }

/// H = F - I at J = 1, by rows; where the mode changes the volume, F itself.
std::array<double, 9> isochoric_state(const LoadedState& state) {
  const double e = state.load - 1, log_stretch = std::log1p(e);
  std::array<double, 9> H{};
  switch (state.mode) {
    case TestMode::uniaxial:
      H = {e, 0, 0, 0, std::expm1(-0.5 * log_stretch), 0, 0, 0, std::expm1(-0.5 * log_stretch)};
      break;
    case TestMode::equibiaxial:
      H = {e, 0, 0, 0, e, 0, 0, 0, std::expm1(-2 * log_stretch)};
      break;
    case TestMode::planar:
      H = {e, 0, 0, 0, std::expm1(-log_stretch), 0, 0, 0, 0};
      break;
    case TestMode::simple_shear:
      H[1] = state.load;
      break;
    case TestMode::volumetric:
      H = {e, 0, 0, 0, e, 0, 0, 0, e};
      break;
    case TestMode::confined:
      H[0] = e;
      break;
  }
  return H;
}

/// How the entries of P make the nominal stress.
std::array<double, 9> stress_weights(const LoadedState& state, bool is_compressible) {
  std::array<double, 9> w{};
  const double l = state.load;
  const double pressure = is_compressible ? 0 : 1;
  switch (state.mode) {
    case TestMode::uniaxial:
      w[0] = 1;
      w[4] = w[8] = -0.5 * pressure / (l * std::sqrt(l));
      break;
    case TestMode::equibiaxial:
      w[0] = w[4] = 0.5;
      w[8] = -pressure / (l * l * l);
      break;
    case TestMode::planar:
      w[0] = 1;
      w[4] = -pressure / (l * l);
      break;
    case TestMode::simple_shear:
      w[1] = 1;
      break;
    case TestMode::volumetric:
      w[0] = w[4] = w[8] = 1.0 / 3;
      break;
    case TestMode::confined:
      w[0] = 1;
      break;
  }
  return w;
}

double weighted_sum(const double* weights, const double* P) {
  double sum = 0;
  for (int k = 0; k < 9; ++k)
    if (weights[k] != 0) sum += weights[k] * P[k];
  return sum;
}

/// d(sum of w P)/dy of a state whose free edges all change by dy; A is dP_ij/dF_kl, 81 numbers by rows.
double slope_by_lateral(const double* weights, const std::array<bool, 3>& is_free, const double* A) {
  double slope = 0;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 3; ++j)
      if (weights[k] != 0 && is_free[static_cast<std::size_t>(j)]) slope += weights[k] * A[9 * k + 4 * j];
  return slope;
}

std::array<double, 9> lateral_weights(TestMode mode) {
  const std::array<bool, 3> is_free = free_edges(mode);
  std::array<double, 9> w{};
  for (std::size_t j = 0; j < 3; ++j) w[4 * j] = is_free[j] ? 1 : 0;
  return w;
}

constexpr int most_lateral_steps = 80;

}  // namespace

HomogeneousModel::HomogeneousModel(const LawInfo& law, bool is_compressible, std::vector<LoadedState> states)
    : law_(law), is_compressible_(is_compressible), states_(std::move(states)) {
  for (const LoadedState& state : states_) {
    const std::array<double, 9> H = isochoric_state(state), w = stress_weights(state, is_compressible);
    gradients_.insert(gradients_.end(), H.begin(), H.end());
    weights_.insert(weights_.end(), w.begin(), w.end());
  }
}

double HomogeneousModel::nominal(std::size_t i, const double* P) const {
  return weighted_sum(weights_.data() + 9 * i, P + 9 * i);
}

double HomogeneousModel::lateral(std::size_t i, const double* P) const {
  return weighted_sum(lateral_weights(states_[i].mode).data(), P + 9 * i);
}

/// One Newton step in the logarithm of each free stretch, at most by half of it; true when all states are
/// done: the last step was lost in round-off.
bool HomogeneousModel::lateral_step(std::span<const double> constants, Numbers& H,
                                    std::vector<bool>& is_done) const {
  Numbers P(H.size()), A(9 * H.size());
  const StateBatch<double> batch = batch_at(law_, constants, H);
  first_piola_kirchhoff_stresses(batch, P.data());
  stress_tangents(batch, Projection::none, A.data());
  bool all_done = true;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (is_done[i]) continue;
    const std::array<bool, 3> is_free = free_edges(states_[i].mode);
    const std::size_t first = is_free[1] ? 1 : 2;
    const double y = 1 + H[9 * i + 4 * first], stress = lateral(i, P.data());
    const double slope = y * slope_by_lateral(lateral_weights(states_[i].mode).data(), is_free, &A[81 * i]);
    double step = -stress / slope;
    if (!(slope > 0)) step = stress > 0 ? -0.2 : 0.2;
    step = std::clamp(step, -0.5, 0.5);
    const double change = y * std::expm1(step);
    for (std::size_t j = 0; j < 3; ++j)
      if (is_free[j]) H[9 * i + 4 * j] += change;
    is_done[i] = slope > 0 && std::abs(step) <= 4e-16 + 1e-13 * std::abs(H[9 * i + 4 * first]);
    all_done = all_done && is_done[i];
  }
  return all_done;
}

bool HomogeneousModel::solve_lateral(std::span<const double> constants, Numbers& H) const {
  H = gradients_;
  if (!is_compressible_) return true;
  std::vector<bool> is_done;
  for (const LoadedState& state : states_) is_done.push_back(!has_free_edges(state.mode));
  for (int step = 0; step < most_lateral_steps; ++step)
    if (lateral_step(constants, H, is_done)) return true;
  // Where Newton's steps have come down to round-off without getting below it, the state is as good.
  Numbers P(H.size()), A(9 * H.size());
  const StateBatch<double> batch = batch_at(law_, constants, H);
  first_piola_kirchhoff_stresses(batch, P.data());
  stress_tangents(batch, Projection::none, A.data());
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const std::array<bool, 3> is_free = free_edges(states_[i].mode);
    const double slope = slope_by_lateral(lateral_weights(states_[i].mode).data(), is_free, &A[81 * i]);
    if (!is_done[i] && !(slope > 0 && std::abs(lateral(i, P.data())) <= 1e-10 * slope)) return false;
  }
  return true;
}

bool HomogeneousModel::evaluate(std::span<const double> constants, std::span<const int> places,
                                VectorX* values, DenseMatrix* slopes) const {
  Numbers H;
  if (!solve_lateral(constants, H)) return false;
  const StateBatch<double> batch = batch_at(law_, constants, H);
  Numbers P(H.size());
  if (values != nullptr) {
    first_piola_kirchhoff_stresses(batch, P.data());
    values->resize(size());
    for (std::size_t i = 0; i < states_.size(); ++i)
      (*values)[static_cast<Eigen::Index>(i)] = nominal(i, P.data());
    if (!values->allFinite()) return false;
  }
  if (slopes == nullptr) return true;
  Numbers A;
  if (is_compressible_) {
    A.resize(9 * H.size());
    stress_tangents(batch, Projection::none, A.data());
  }
  slopes->resize(size(), static_cast<Eigen::Index>(places.size()));
  for (std::size_t k = 0; k < places.size(); ++k) {
    constant_derivatives(batch, static_cast<std::size_t>(places[k]), static_cast<double*>(nullptr), P.data());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      double slope = nominal(i, P.data());
      if (is_compressible_ && has_free_edges(states_[i].mode)) {
        const std::array<bool, 3> is_free = free_edges(states_[i].mode);
        const double* tangent = &A[81 * i];
        slope -= slope_by_lateral(&weights_[9 * i], is_free, tangent) /
                 slope_by_lateral(lateral_weights(states_[i].mode).data(), is_free, tangent) *
                 lateral(i, P.data());
      }
      (*slopes)(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = slope;
    }
  }
  return slopes->allFinite();
}

VectorX HomogeneousModel::stresses(std::span<const double> constants) const {
  VectorX all;
  if (evaluate(constants, {}, &all, nullptr)) return all;
  all = VectorX::Constant(size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < states_.size(); ++i) {
    VectorX one;
    if (HomogeneousModel(law_, is_compressible_, {states_[i]}).evaluate(constants, {}, &one, nullptr))
      all[static_cast<Eigen::Index>(i)] = one[0];
  }
  return all;
}

std::vector<Vector3> HomogeneousModel::principal_stretches(std::span<const double> constants) const {
  Numbers H;
  const bool is_solved = solve_lateral(constants, H);
  std::vector<Vector3> stretches;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (states_[i].mode == TestMode::simple_shear) {
      const double half = 0.5 * states_[i].load, l = half + std::sqrt(1 + half * half);
      stretches.emplace_back(l, 1 / l, 1);
    } else if (is_solved || !has_free_edges(states_[i].mode)) {
      stretches.emplace_back(1 + H[9 * i], 1 + H[9 * i + 4], 1 + H[9 * i + 8]);
    } else if (states_.size() > 1) {
      stretches.push_back(
          HomogeneousModel(law_, is_compressible_, {states_[i]}).principal_stretches(constants)[0]);
    } else {
      stretches.push_back(Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  return stretches;
}

}  // namespace resilin
