#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "resilin/fields/evaluator.hpp"
#include "resilin/fields/scalar_field.hpp"
#include "resilin/view/shown_surface.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Fields at the vertices of a shown surface, of those that have a value at each node (`vertex_fields`). A
/// skin takes its numbers from the nodes by its weights, and none beyond those of its body's nodes: a vertex
/// that stands out of the cells has no more than what is in them. At rigid bodies vectors are those of the
/// motion, which their control nodes carry exactly.
class SurfaceFields {
 public:
  /// @param surface  kept by reference
  SurfaceFields(const World& world, const ShownSurface& surface);

  /// Those of `vertex_fields` that are quick enough for every frame of a live scene: all but the smooth ones.
  static std::vector<ScalarField> quick(int dimension);

  /// One number for each vertex; nan where it is none.
  /// @param world  has the bodies and cells of the surface's world; its materials may be others
  /// @param name   of one of `vertex_fields`
  /// @throws InputError  when it is not
  void evaluate(const World& world, const State& state, std::string_view name, std::span<float> out);

  /// The same for several fields, which share what they are computed from.
  void evaluate(FieldEvaluator& evaluator, const State& state, std::span<const ScalarField> fields,
                std::span<std::vector<float>> out);

 private:
  void carry(const ScalarField& field, const FieldValues& values, std::span<float> out);
  /// Lengths of vectors at rigid bodies: what is carried are components.
  void carry_lengths(const FieldValues& values, std::span<float> out);
  void keep_skins_within_their_bodies(std::span<float> out) const;

  struct NodeRange {
    std::size_t begin, end;
    bool is_rigid;
  };
  const ShownSurface& surface_;
  std::vector<NodeRange> nodes_of_;  ///< by body
  bool has_rigid_bodies_ = false;
  std::vector<double> nodal_;  ///< by node of the world
  std::shared_ptr<const CellAverages> averages_;
};

}  // namespace resilin
