#include "resilin/fields/scalar_field.hpp"

#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/types.hpp"

namespace resilin {
namespace {

constexpr std::string_view axes = "xyz";

/// Components that say something, with their names.
std::vector<std::pair<int, std::string>> components_of(const FieldInfo& field, int dimension) {
  std::vector<std::pair<int, std::string>> components;
  switch (field.kind) {
    case FieldInfo::Kind::scalar:
      break;
    case FieldInfo::Kind::vector:
      for (int i = 0; i < dimension; ++i)
        components.emplace_back(i, axes.substr(static_cast<std::size_t>(i), 1));
      break;
    case FieldInfo::Kind::principal_values:
      for (int i = 0; i < 3; ++i) components.emplace_back(i, std::to_string(i + 1));
      break;
    case FieldInfo::Kind::tensor:
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = field.is_symmetric ? i : 0; j < 3; ++j) {
          const bool leaves_plane = dimension == 2 && (i == 2) != (j == 2);
          if (!leaves_plane)
            components.emplace_back(static_cast<int>(3 * i + j), std::string{axes[i], axes[j]});
        }
  }
  return components;
}

/// "Cauchy stress xy, averaged".
std::string label_of(const FieldInfo& field, const std::string& component) {
  const std::string_view suffix = label_suffix(field.source);
  return field.label.substr(0, field.label.size() - suffix.size()) + " " + component + std::string(suffix);
}

ScalarField require_one_of(std::vector<ScalarField> fields, std::string_view name, const std::string& place) {
  std::vector<std::string> names;
  for (ScalarField& field : fields) {
    if (field.name == name) return std::move(field);
    names.push_back(field.name);
  }
  refuse_word(place, name, names);
}

}  // namespace

double ScalarField::at(std::span<const double> values, std::size_t place) const {
  const auto width = static_cast<std::size_t>(field->components());
  const double* first = values.data() + place * width;
  if (component >= 0) return first[component];
  return width == 1 ? *first : Eigen::Map<const Vector3>(first).norm();
}

std::vector<ScalarField> scalar_fields(int dimension) {
  std::vector<ScalarField> all;
  for (const FieldInfo& field : fields()) {
    if (field.is_direction()) continue;
    const bool is_number = field.kind == FieldInfo::Kind::scalar || field.kind == FieldInfo::Kind::vector;
    if (is_number) all.push_back({&field, -1, field.name, field.label, field.label});
    for (const auto& [component, suffix] : components_of(field, dimension))
      all.push_back({&field, component, field.name + "." + suffix, label_of(field, suffix), field.label});
  }
  return all;
}

std::vector<ScalarField> vertex_fields(int dimension) {
  std::vector<ScalarField> all = scalar_fields(dimension);
  std::erase_if(all, [](const ScalarField& field) { return !field.field->is_on_nodes(); });
  return all;
}

ScalarField require_scalar_field(std::string_view name, int dimension, const std::string& place) {
  return require_one_of(scalar_fields(dimension), name, place);
}

ScalarField require_vertex_field(std::string_view name, int dimension, const std::string& place) {
  return require_one_of(vertex_fields(dimension), name, place);
}

}  // namespace resilin
