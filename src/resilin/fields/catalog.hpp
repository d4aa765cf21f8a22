#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// Fields of a state, by name: the scene's `output.fields`, Python's `result.fields` and the
/// command line's pictures. Every quantity of the cells is there under three names, which mean three things:
/// by cell, as `averaged_...` the mean of the cells around a vertex, and as `nodal_...` smooth on the
/// vertices.
struct FieldInfo {
  /// How a quantity of the cells has come to be where it is.
  enum class Source {
    vertices,  ///< it is known there
    cells,     ///< mean of a cell
    averages,  ///< at a vertex the mean of the cells around it, by rest volume
    fit        ///< at the vertices the L2 projection
  };
  enum class Kind {
    scalar,
    vector,            ///< 3 numbers
    principal_values,  ///< 3 numbers, from the largest to the smallest
    tensor             ///< 9 numbers, row by row
  };
  std::string name;
  std::string label;  ///< at a colour bar, different for each: "von Mises stress, averaged"
  std::string text;   ///< description
  std::string unit;   ///< empty when it has none
  Kind kind;
  Source source;
  bool is_symmetric = true;  ///< for tensors

  bool is_on_nodes() const { return source != Source::cells; }
  /// Whether it is a vector that has a length but no sense.
  bool is_direction() const { return kind == Kind::vector && unit.empty(); }
  int components() const { return kind == Kind::scalar ? 1 : kind == Kind::tensor ? 9 : 3; }
};

/// Suffix of the label of a quantity: ", by cell", ", averaged", ", smooth" or nothing.
std::string_view label_suffix(FieldInfo::Source source);

/// All fields, in the order of the documentation.
const std::vector<FieldInfo>& fields();
std::vector<std::string> field_names();

/// Throws InputError(place, ...) with the nearest name when there is no such field.
const FieldInfo& require_field(std::string_view name, const std::string& place);

}  // namespace resilin
