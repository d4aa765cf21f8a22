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
  std::string label;  ///< "displacement z", "Cauchy stress xy, averaged"
  std::string group;  ///< label of those that belong together: "displacement", "Cauchy stress, averaged"

  double at(std::span<const double> values, std::size_t place) const;
};

/// All of them in the order of the catalogue, by cell and on the vertices; of symmetric tensors the entries
/// from the diagonal on, in 2D without what is always zero. Principal directions, of which either sense is
/// meant, have none.
std::vector<ScalarField> scalar_fields(int dimension);

/// Those of them that have a value at each vertex: what a page shows on a surface.
std::vector<ScalarField> vertex_fields(int dimension);

/// The one of this name. @throws InputError  with the nearest name
ScalarField require_scalar_field(std::string_view name, int dimension, const std::string& place);
/// The same of `vertex_fields`.
ScalarField require_vertex_field(std::string_view name, int dimension, const std::string& place);

}  // namespace resilin
