#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// What a state can be asked for, by name: the scene's `output.fields`, Python's `result.fields` and the
/// command line's pictures. Every quantity of the cells is there twice: by cell, and as `nodal_...` on the
/// vertices.
struct FieldInfo {
  enum class Kind {
    scalar,
    vector,            ///< 3 numbers
    principal_values,  ///< 3 numbers, from the largest to the smallest
    tensor             ///< 9 numbers, row by row
  };
  std::string name;
  std::string label;  ///< at a colour bar: "von Mises stress"
  std::string text;   ///< what it is
  std::string unit;   ///< empty when it has none
  Kind kind;
  bool is_on_nodes;
  bool is_symmetric = true;  ///< of tensors

  int components() const { return kind == Kind::scalar ? 1 : kind == Kind::tensor ? 9 : 3; }
};

/// All fields, in the order of the documentation.
const std::vector<FieldInfo>& fields();
std::vector<std::string> field_names();

/// Throws InputError(place, ...) with the nearest name when there is no such field.
const FieldInfo& require_field(std::string_view name, const std::string& place);

}  // namespace resilin
