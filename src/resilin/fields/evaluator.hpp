#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resilin/fields/catalog.hpp"
#include "resilin/fields/nodal_fit.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The values of a field in one state: `field->components()` numbers for each node of the world, or for each
/// cell of all bodies one after another.
struct FieldValues {
  const FieldInfo* field;
  std::vector<double> values;
};

/// Evaluates fields of a world's states and keeps what smoothing needs between them.
///
/// By cell: the mean over the cell's rest volume. On the nodes: the L2 projection (`NodalFit`), each body for
/// itself. von Mises stress, pressure and principal values are those of the mean or smoothed Cauchy stress,
/// so that they agree with the tensor beside them.
class FieldEvaluator {
 public:
  /// @param world  kept by reference
  explicit FieldEvaluator(const World& world);

  /// In the order of the names. Throws InputError for a name that is no field.
  std::vector<FieldValues> evaluate(const State& state, std::span<const std::string> names);

 private:
  NodalFit& fit_of(std::size_t body);

  const World& world_;
  std::vector<std::unique_ptr<NodalFit>> fits_;  ///< one for each body, made when asked for
};

}  // namespace resilin
