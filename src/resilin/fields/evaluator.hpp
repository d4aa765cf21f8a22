#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resilin/fields/catalog.hpp"
#include "resilin/fields/cell_averages.hpp"
#include "resilin/fields/nodal_fit.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The values of a field in one state: `field->components()` numbers for each node of the world, or for each
/// cell of all bodies one after another. Those of a rigid body are those of its control nodes and their cell.
struct FieldValues {
  const FieldInfo* field;
  std::vector<double> values;
};

/// Evaluates fields of a world's states and keeps what smoothing needs between them.
///
/// By cell: the mean over the cell's rest volume. `averaged_...`: at a node the mean of the cells' values
/// (`CellAverages`). `nodal_...`: the L2 projection (`NodalFit`), each body for itself. von Mises stress,
/// pressure and principal values are those of the mean or smoothed Cauchy stress, so that they agree with the
/// tensor beside them; averaged ones are means of the cells' von Mises stresses, and so on, and stay within
/// their range. A rigid body has displacements and velocities, of all other fields nan.
class FieldEvaluator {
 public:
  /// @param world     kept by reference
  /// @param averages  of a world with the same cells, where they are there already
  explicit FieldEvaluator(const World& world, std::shared_ptr<const CellAverages> averages = nullptr);

  /// In the order of the names. Throws InputError for a name that is no field.
  std::vector<FieldValues> evaluate(const State& state, std::span<const std::string> names);

 private:
  NodalFit& fit_of(std::size_t body);
  const CellAverages& averages();

  const World& world_;
  std::shared_ptr<const CellAverages> averages_;  ///< made when asked for
  std::vector<std::unique_ptr<NodalFit>> fits_;   ///< one for each body, made when asked for
};

}  // namespace resilin
