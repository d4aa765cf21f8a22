#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/fields/catalog.hpp"

namespace resilin {

/// One number at each place, which colours can show: a field of the catalogue that is one, the length of a
/// vector or a component.
struct ScalarField {
  const FieldInfo* field;
  int component;  ///< -1: the number itself, or the length of the vector
  std::string
      name;  ///< "von_mises", "displacement", "displacement.z", "cauchy_stress.xy", "principal_stress.1"
  std::string label;  ///< "displacement z"
  std::string group;  ///< label of those that belong together: "displacement"

  double at(std::span<const double> values, std::size_t place) const;
};

/// All of them in the order of the catalogue, by cell and on the vertices; of symmetric tensors the entries
/// from the diagonal on, in 2D without what is always zero. Principal directions, of which either sense is
/// meant, have none.
std::vector<ScalarField> scalar_fields(int dimension);

/// The one of this name. @throws InputError  with the nearest name
ScalarField require_scalar_field(std::string_view name, int dimension, const std::string& place);

}  // namespace resilin
