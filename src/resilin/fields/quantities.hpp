#pragma once

#include <array>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/fields/catalog.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// The rows of the catalogue. A new quantity is one row in catalog.cpp.
namespace resilin {

/// A domain of a body in one state of a world.
struct DomainState {
  const World& world;
  std::size_t body, number;
  const State& state;

  const Domain& domain() const { return world.bodies[body].domains[number]; }
  const ElasticEnergy& elastic() const { return *domain().energy; }
  const VectorX& positions() const { return state.positions; }
  /// nan for a material with internal variables in a state without history, such as one read from a frame of
  /// results.
  std::vector<Matrix<3>> cauchy_stresses() const {
    if (!domain().history) return elastic().cauchy_stresses(positions());
    if (state.history.size() == 0)
      return std::vector<Matrix<3>>(static_cast<std::size_t>(elastic().num_cells() * elastic().num_points()),
                                    Matrix<3>::Constant(std::numeric_limits<double>::quiet_NaN()));
    return domain().history->cauchy_stresses(positions(),
                                             world.history_of_domain(body, number, state.history));
  }
  std::vector<double> energy_densities() const {
    return domain().history ? domain().history->energy_densities(positions())
                            : elastic().energy_densities(positions());
  }
};

/// Read at the quadrature points of a domain: 1 or 9 numbers for each, those of a cell at [num_points * cell
/// + point].
using Sampler = std::vector<double> (*)(const DomainState& at);

/// A quantity of the cells: samples, and what is read off their mean over a cell or their fit at a vertex.
struct CellQuantity {
  std::string_view name, label, text, unit;
  FieldInfo::Kind kind;
  Sampler sample;
  int sample_components;
  /// From one mean sample to the field's components; null when it is the sample itself.
  void (*derive)(const double* sample, double* values);
  bool is_symmetric = true;  ///< for tensors
};
std::span<const CellQuantity> cell_quantities();

/// A quantity of the vertices: dim numbers for each, or one.
struct NodeQuantity {
  std::string_view name, label, text, unit;
  FieldInfo::Kind kind;
  VectorX (*values)(const World& world, const State& state);
  bool is_motion = false;  ///< all that a rigid body has, at each point that its nodes carry
};
std::span<const NodeQuantity> node_quantities();

/// Prefixes of a cell field that is averaged at, or projected onto, the vertices.
inline constexpr std::string_view averaged_prefix = "averaged_", nodal_prefix = "nodal_";

}  // namespace resilin
