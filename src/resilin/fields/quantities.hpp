#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/fields/catalog.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// The rows of the catalogue. A new quantity is one row in catalog.cpp.
namespace resilin {

/// Read at the quadrature points of a body: 1 or 9 numbers for each, those of a cell at [num_points * cell +
/// point].
using Sampler = std::vector<double> (*)(const ElasticEnergy& elastic, const VectorX& x);

/// A quantity of the cells: samples, and what is read off their mean over a cell or their fit at a vertex.
struct CellQuantity {
  std::string_view name, label, text, unit;
  FieldInfo::Kind kind;
  Sampler sample;
  int sample_components;
  /// From one mean sample to the field's components; null when it is the sample itself.
  void (*derive)(const double* sample, double* values);
  bool is_symmetric = true;  ///< of tensors
};
std::span<const CellQuantity> cell_quantities();

/// A quantity of the vertices: dim numbers for each, or one.
struct NodeQuantity {
  std::string_view name, label, text, unit;
  FieldInfo::Kind kind;
  VectorX (*values)(const World& world, const State& state);
};
std::span<const NodeQuantity> node_quantities();

inline constexpr std::string_view averaged_prefix = "averaged_", nodal_prefix = "nodal_";

}  // namespace resilin
