#pragma once

#include <optional>

#include "resilin/material/curve.hpp"

namespace resilin {

/// A block of material under one load case: its state at a load is the minimum of the energy density over the
/// free stretches. What `stretch_curve` follows.
class LoadedBlock {
 public:
  /// Stretches of the free directions, less one: 0, 1 or 2 unknowns.
  using Free = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2, 1>;
  struct State {
    double load;  ///< the stretch, or the amount of shear
    Free free;
  };

  LoadedBlock(const Material& material, LoadCase load_case);

  State rest() const { return {rest_load(), Free::Zero(free_.cols())}; }
  double rest_load() const { return load_case_ == LoadCase::shear ? 0 : 1; }

  /// The state at `load`, found from the state `from` nearby; nothing when there is none.
  std::optional<State> solve(double load, const State& from) const;

  Stability stability(const State& state) const;

  /// The diagonal of F; P and sigma; Psi; J.
  Vector3 stretches(const State& state) const;
  double nominal_stress(const State& state) const;
  double cauchy_stress(const State& state) const;
  double energy_density(const State& state) const;
  double volume_ratio(const State& state) const { return stretches(state).prod(); }

 private:
  using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 2>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2, 2>;
  struct Derivatives {
    Free gradient;   ///< dPsi/dfree [Pa]
    Square hessian;  ///< [Pa]
  };

  Matrix<3> displacement_gradient(const State& state) const;
  Matrix<3> deformation_gradient(const State& state) const;
  Matrix<3> stress(const State& state) const;
  TangentMatrix<3> tangent(const State& state) const;
  Derivatives derivatives(const State& state) const;
  State predict(double load, const State& from) const;
  bool descend(State& state, const Derivatives& slope) const;
  bool polish(State& state) const;
  double component(const Matrix<3>& stress) const;
  double scale(const State& state) const;

  const Material& material_;
  LoadCase load_case_;
  Vector3 loaded_;   ///< the directions that are stretched by the load
  Directions free_;  ///< a column for each unknown
};

}  // namespace resilin
