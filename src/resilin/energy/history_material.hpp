#pragma once

#include <vector>

#include "resilin/energy/history_term.hpp"

namespace resilin {

/// Strain energy of a body whose material has internal variables, as fields ask for it.
class HistoryMaterial : public HistoryTerm {
 public:
  /// By quadrature point [Pa], as ElasticEnergy has them; at the positions that the history has led to.
  virtual std::vector<Matrix<3>> cauchy_stresses(const VectorX& x, const VectorX& history) const = 0;
  /// Stored energy by quadrature point [J/m^3].
  virtual std::vector<double> energy_densities(const VectorX& x) const = 0;
};

}  // namespace resilin
