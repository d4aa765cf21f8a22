#pragma once

#include <vector>

#include "resilin/fit/material_test.hpp"
#include "resilin/fit/predicted_values.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

/// A block strained everywhere alike.
struct LoadedState {
  TestMode mode;
  double load;
};

/// Nominal stresses of a law at homogeneous states, many at once, and their slopes by its constants.
///
/// Incompressible: J = 1 and the pressure follows from the stress-free faces, so that with the law's
/// P_i = dPsi/dl_i the stress is P_1 - P_2 l_2/l_1, the slope of Psi along the path of volume-preserving
/// states:
///
///   uniaxial     dW(l, l^-1/2, l^-1/2)/dl      equibiaxial  dW(l, l, l^-2)/dl / 2
///   planar       dW(l, 1/l, 1)/dl              simple shear P_12, on which pressure has no influence
///
/// Energy of J alone cancels exactly: constants of that part have slopes of zero.
///
/// Compressible: the stretch y of the free directions solves P_t(l, y) = 0, and dP = dP_1 - (dP_1/dy)
/// (dP_t/dy)^-1 dP_t gives the slopes.
class HomogeneousModel : public PredictedValues {
 public:
  HomogeneousModel(const LawInfo& law, bool is_compressible, std::vector<LoadedState> states);

  Eigen::Index size() const override { return static_cast<Eigen::Index>(states_.size()); }
  bool evaluate(std::span<const double> constants, std::span<const int> places, VectorX* values,
                DenseMatrix* slopes) const override;

  /// The values, with "not a number" for each state that has none.
  VectorX stresses(std::span<const double> constants) const;

  /// Principal stretches of each state, not a number where there is none. In simple shear 1/l_1, l_1 and 1
  /// with l_1 - 1/l_1 the amount of shear.
  std::vector<Vector3> principal_stretches(std::span<const double> constants) const;

 private:
  using Numbers = std::vector<double>;
  /// The free stretches as in `lateral_`, minus 1; false when a state has none.
  bool solve_lateral(std::span<const double> constants, Numbers& H) const;
  bool lateral_step(std::span<const double> constants, Numbers& H, std::vector<bool>& is_done) const;
  double nominal(std::size_t i, const double* P) const;
  double lateral(std::size_t i, const double* P) const;

  const LawInfo& law_;
  bool is_compressible_;
  std::vector<LoadedState> states_;
  Numbers gradients_;  ///< displacement gradients at J = 1, (states, 3, 3)
  Numbers weights_;    ///< weights of the entries of P in the nominal stress, (states, 9)
};

}  // namespace resilin
