#include "resilin/element/catalog.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"

namespace resilin {
namespace {

template <class Element>
ElementInfo info() {
  static const auto nodes = Element::nodes();
  return {Element::name,
          Element::text,
          Element::shape,
          dimension(Element::shape),
          Element::num_nodes,
          Element::degree,
          has_mean_volume<Element>,
          Element::quadrature,
          nodes,
          Element::shape_values,
          Element::shape_gradients};
}

template <class... Element>
std::vector<ElementInfo> all_infos(ElementList<Element...>) {
  return {info<Element>()...};
}

const std::vector<ElementInfo>& infos() {
  static const std::vector<ElementInfo> table = all_infos(Elements{});
  return table;
}

constexpr std::string_view axisymmetric_suffix = " axisymmetric";

/// The twins of the plane elements, in their order.
const std::vector<ElementInfo>& axisymmetric_infos() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const ElementInfo& element : infos())
      if (element.dim == 2) all.push_back(axisymmetric_name(element.name));
    return all;
  }();
  static const std::vector<ElementInfo> table = [] {
    std::vector<ElementInfo> all;
    for (const ElementInfo& element : infos()) {
      if (element.dim != 2) continue;
      ElementInfo twin = element;
      twin.name = names[all.size()];
      all.push_back(twin);
    }
    return all;
  }();
  return table;
}

}  // namespace

std::string axisymmetric_name(std::string_view element) {
  return std::string(element) + std::string(axisymmetric_suffix);
}

bool has_axisymmetric_name(std::string_view element) { return element.ends_with(axisymmetric_suffix); }

std::string plane_name(std::string_view element) {
  if (has_axisymmetric_name(element)) element.remove_suffix(axisymmetric_suffix.size());
  return std::string(element);
}

bool is_axisymmetric(const ElementInfo& element) {
  return element.dim == 2 && has_axisymmetric_name(element.name);
}

const ElementInfo& axisymmetric_element(const ElementInfo& plane) {
  return require_element(axisymmetric_name(plane.name), 2, "element");
}

std::vector<const ElementInfo*> elements() {
  std::vector<const ElementInfo*> all;
  for (const ElementInfo& element : infos()) all.push_back(&element);
  return all;
}

const ElementInfo* find_element(std::string_view name, int dim) {
  for (const ElementInfo& element : infos())
    if (element.name == name && element.dim == dim) return &element;
  for (const ElementInfo& element : axisymmetric_infos())
    if (element.name == name && element.dim == dim) return &element;
  return nullptr;
}

const ElementInfo* find_element(int dim, bool of_simplices, int degree, bool has_mean_volume) {
  for (const ElementInfo& element : infos()) {
    if (element.dim == dim && resilin::is_simplex(element.shape) == of_simplices &&
        element.degree == degree && element.has_mean_volume == has_mean_volume)
      return &element;
  }
  return nullptr;
}

const ElementInfo& corner_element(const ElementInfo& element) {
  for (const ElementInfo& candidate : infos())
    if (candidate.shape == element.shape && candidate.num_nodes == element.num_corners()) return candidate;
  return element;
}

const ElementInfo& require_element(std::string_view name, int dim, const std::string& place) {
  if (const ElementInfo* element = find_element(name, dim)) return *element;
  std::vector<std::string> names;
  for (const ElementInfo& element : infos())
    if (element.dim == dim) names.emplace_back(element.name);
  throw InputError(place, "one of " + join(names), "\"" + std::string(name) + "\"");
}

}  // namespace resilin
