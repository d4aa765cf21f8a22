#include "resilin/fit/drucker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/dense.hpp"
#include "resilin/material/batch.hpp"

namespace resilin {
namespace {

constexpr double furthest_stretch = 12, furthest_shear = 12;
constexpr int num_search_states = 240;
constexpr double bisection_tolerance = 1e-10;  ///< bisection tolerance of the load

/// Columns: orthonormal directions of h.
DenseMatrix strain_directions(bool is_compressible) {
  if (is_compressible) return DenseMatrix::Identity(3, 3);
  DenseMatrix B(3, 2);
  B << std::sqrt(0.5), std::sqrt(1.0 / 6), -std::sqrt(0.5), std::sqrt(1.0 / 6), 0, -std::sqrt(2.0 / 3);
  return B;
}

DenseMatrix hessian_of(const Vector3& l, const double* P, const double* A) {
  DenseMatrix M(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) M(i, j) = l[i] * A[9 * 4 * i + 4 * j] * l[j] + (i == j ? l[i] * P[4 * i] : 0);
  return M / l.squaredNorm();
}

bool is_stable_at(const LawInfo& law, bool is_compressible, std::span<const double> constants, TestMode mode,
                  double load) {
  return smallest_stiffness(stability_hessians(law, is_compressible, constants, {{mode, load}}).front()) > 0;
}

/// The first load between rest and `end` at which the law is not stable, to the last digits; nothing when it
/// is stable at all of them.
std::optional<double> first_loss(const LawInfo& law, bool is_compressible, std::span<const double> constants,
                                 TestMode mode, double end) {
  const std::vector<LoadedState> states = states_between(mode, rest_load(mode), end, num_search_states);
  const std::vector<DenseMatrix> hessians = stability_hessians(law, is_compressible, constants, states);
  const auto lost = std::ranges::find_if(
      hessians, [](const DenseMatrix& hessian) { return !(smallest_stiffness(hessian) > 0); });
  if (lost == hessians.end()) return std::nullopt;
  if (lost == hessians.begin()) return rest_load(mode);
  const auto at = static_cast<std::size_t>(lost - hessians.begin());
  double stable = states[at - 1].load, unstable = states[at].load;
  while (std::abs(unstable - stable) > bisection_tolerance * std::abs(unstable)) {
    const double middle = 0.5 * (stable + unstable);
    if (middle == stable || middle == unstable) break;
    (is_stable_at(law, is_compressible, constants, mode, middle) ? stable : unstable) = middle;
  }
  return stable;
}

}  // namespace

std::vector<LoadedState> states_between(TestMode mode, double from, double to, int count) {
  std::vector<LoadedState> states;
  for (int i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / (count - 1);
    const double load = mode == TestMode::simple_shear
                            ? from + part * (to - from)
                            : std::exp((1 - part) * std::log(from) + part * std::log(to));
    states.push_back({mode, i == 0 ? from : i + 1 == count ? to : load});
  }
  return states;
}

std::vector<DenseMatrix> stability_hessians(const LawInfo& law, bool is_compressible,
                                            std::span<const double> constants,
                                            const std::vector<LoadedState>& states) {
  const HomogeneousModel model(law, is_compressible, states);
  const std::vector<Vector3> stretches = model.principal_stretches(constants);
  std::vector<double> H, P(9 * states.size()), A(81 * states.size());
  for (const Vector3& l : stretches)
    for (const double entry : {l[0] - 1, 0.0, 0.0, 0.0, l[1] - 1, 0.0, 0.0, 0.0, l[2] - 1})
      H.push_back(entry);
  StateBatch<double> batch{.law = &law,
                           .dim = 3,
                           .count = states.size(),
                           .deformation_gradients = H.data(),
                           .holds_displacement_gradients = true,
                           .constants = {}};
  for (const double& constant : constants) batch.constants.push_back({&constant, 0});
  first_piola_kirchhoff_stresses(batch, P.data());
  stress_tangents(batch, Projection::none, A.data());
  const DenseMatrix B = strain_directions(is_compressible);
  std::vector<DenseMatrix> hessians;
  for (std::size_t i = 0; i < states.size(); ++i)
    hessians.push_back(B.transpose() * hessian_of(stretches[i], &P[9 * i], &A[81 * i]) * B);
  return hessians;
}

double smallest_stiffness(const DenseMatrix& hessian) {
  if (!hessian.allFinite()) return -std::numeric_limits<double>::infinity();
  if (hessian.rows() == 2) {
    const double mean = 0.5 * (hessian(0, 0) + hessian(1, 1)), half = 0.5 * (hessian(0, 0) - hessian(1, 1));
    return mean - std::hypot(half, hessian(0, 1));
  }
  return dense::symmetric_eigenvalues(hessian)[0];
}

StabilityRange find_stability_range(const LawInfo& law, bool is_compressible,
                                    std::span<const double> constants, TestMode mode, double data_load) {
  StabilityRange range{mode, std::nullopt, std::nullopt};
  if (mode == TestMode::simple_shear) {
    const double end = std::max(furthest_shear, std::abs(data_load));
    range.above = first_loss(law, is_compressible, constants, mode, end);
  } else {
    const double end = std::max({furthest_stretch, data_load, 1 / data_load});
    range.below = first_loss(law, is_compressible, constants, mode, 1 / end);
    range.above = first_loss(law, is_compressible, constants, mode, end);
  }
  return range;
}

}  // namespace resilin
