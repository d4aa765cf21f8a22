#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "resilin/fields/evaluator.hpp"
#include "resilin/fields/scalar_field.hpp"
#include "resilin/view/shown_surface.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Fields at the vertices of a shown surface, made for every frame of a live scene: of what is known by cell,
/// at a node the mean of the cells around it, by rest volume. That is neither as smooth nor as exact as the
/// fit of `FieldEvaluator`'s nodal fields, and a hundred times as fast. A skin takes its numbers from the
/// nodes by its weights.
class SurfaceFields {
 public:
  /// @param surface  kept by reference
  SurfaceFields(const World& world, const ShownSurface& surface);

  /// Those of `scalar_fields` that are quick enough for every frame of a live scene: all but the smooth ones.
  static std::vector<ScalarField> quick(int dimension);

  /// One number for each vertex; nan where it is none.
  /// @param world  has the bodies and cells of the surface's world; its materials may be others
  /// @param name   of one of `scalar_fields`
  /// @throws InputError  when it is not
  void evaluate(const World& world, const State& state, std::string_view name, std::span<float> out);

  /// The same for several fields, which share what they are computed from.
  void evaluate(FieldEvaluator& evaluator, const State& state, std::span<const ScalarField> fields,
                std::span<std::vector<float>> out);

 private:
  void carry(const ScalarField& field, const FieldValues& values, std::span<float> out);
  double mean_at(const ScalarField& field, std::span<const double> values, std::size_t node) const;

  const ShownSurface& surface_;
  std::vector<double> nodal_;            ///< by node of the world
  std::vector<std::uint32_t> first_;     ///< by node, into the next two
  std::vector<std::uint32_t> cells_at_;  ///< of all bodies, one after another
  std::vector<double> shares_;           ///< of each cell in the node's value
};

}  // namespace resilin
