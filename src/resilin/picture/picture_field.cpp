#include "resilin/picture/picture_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

const VtuValues* find(const std::vector<VtuValues>& arrays, std::string_view name) {
  const auto found = std::ranges::find(arrays, name, &VtuValues::name);
  return found == arrays.end() ? nullptr : &*found;
}

/// Names of single components, in their order.
std::vector<std::string> component_names(const VtuValues& array) {
  if (array.components == 9) return {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  if (array.components == 3 && !array.name.ends_with("principal_stress")) return {"x", "y", "z"};
  std::vector<std::string> numbers;
  for (int i = 1; i <= array.components; ++i) numbers.push_back(std::to_string(i));
  return numbers;
}

std::vector<double> column(const VtuValues& array, std::size_t component) {
  std::vector<double> values;
  for (std::size_t i = component; i < array.values.size(); i += static_cast<std::size_t>(array.components))
    values.push_back(array.values[i]);
  return values;
}

std::vector<double> lengths(const VtuValues& array) {
  std::vector<double> values;
  for (std::size_t i = 0; i < array.values.size(); i += 3)
    values.push_back(std::hypot(array.values[i], array.values[i + 1], array.values[i + 2]));
  return values;
}

}  // namespace

std::vector<std::string> picture_field_names(const VtuContent& frame) {
  std::vector<std::string> names;
  for (const auto* arrays : {&frame.point_data, &frame.cell_data})
    for (const VtuValues& array : *arrays) names.push_back(array.name);
  return names;
}

PictureField pick_field(const VtuContent& frame, const std::string& name, const std::string& place) {
  // The name of an array may have dots itself, as a whole it goes first.
  std::vector<std::array<std::string, 2>> readings = {{name, ""}};
  if (const std::size_t dot = name.rfind('.'); dot != name.npos)
    readings.push_back({std::string(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(dot)),
                        std::string(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end())});
  for (auto& [array_name, component] : readings) {
    const bool is_on_points = find(frame.point_data, array_name) != nullptr;
    const VtuValues* array = find(is_on_points ? frame.point_data : frame.cell_data, array_name);
    if (array == nullptr) continue;
    const std::vector<std::string> components = component_names(*array);
    if (component.empty() && array->components == 1) return {array_name, "", is_on_points, array->values};
    if (component.empty() && components[0] == "x") return {array_name, "", is_on_points, lengths(*array)};
    if (component.empty() && components.size() == 3) component = components[0];
    const auto found = std::ranges::find(components, component);
    if (found != components.end() && array->components > 1)
      return {array_name, component, is_on_points,
              column(*array, static_cast<std::size_t>(found - components.begin()))};
    throw InputError(place, "a component of " + printable(array_name) + " (" + join(components) + ")",
                     component.empty() ? "none" : '"' + printable(component) + '"',
                     array->components > 1 ? "such as " + array_name + "." + components[0]
                                           : "it is one number: leave it out");
  }
  const std::vector<std::string> names = picture_field_names(frame);
  throw InputError(place, "a field of the frame (" + join(names) + ")", '"' + printable(name) + '"',
                   "`output.fields` of the scene says what frames hold");
}

}  // namespace resilin
