#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "resilin/fields/catalog.hpp"
#include "resilin/view/shown_surface.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Fields at the vertices of a shown surface, made for every frame of a live scene: at a node the mean of the
/// cells around it, by rest volume. That is neither as smooth nor as exact as the fit of
/// `FieldEvaluator`'s nodal fields, and a hundred times as fast. A skin takes its numbers from the nodes by
/// its weights.
class SurfaceFields {
 public:
  /// @param surface  kept by reference
  SurfaceFields(const World& world, const ShownSurface& surface);

  /// The fields that `evaluate` knows, in the order of the catalogue: scalars of cells, and vectors of nodes,
  /// of which the length is shown.
  static std::vector<const FieldInfo*> known();

  /// One number for each vertex; nan where it is none.
  /// @param world  has the bodies and cells of the surface's world; its materials may be others
  /// @throws InputError  when `name` is not one of `known`
  void evaluate(const World& world, const State& state, std::string_view name, std::span<float> out);

 private:
  double mean_at(std::span<const double> cells, std::size_t node) const;
  static double length_at(std::span<const double> vectors, std::size_t node);

  const ShownSurface& surface_;
  std::vector<double> nodal_;            ///< by node of the world
  std::vector<std::uint32_t> first_;     ///< by node, into the next two
  std::vector<std::uint32_t> cells_at_;  ///< of all bodies, one after another
  std::vector<double> shares_;           ///< of each cell in the node's value
};

}  // namespace resilin
