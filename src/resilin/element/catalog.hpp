#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/element/bilinear_quadrilateral.hpp"
#include "resilin/element/element.hpp"
#include "resilin/element/linear_tetrahedron.hpp"
#include "resilin/element/linear_triangle.hpp"
#include "resilin/element/mean_volume.hpp"
#include "resilin/element/quadratic_tetrahedron.hpp"
#include "resilin/element/quadratic_triangle.hpp"
#include "resilin/element/trilinear_hexahedron.hpp"

namespace resilin {

/// A list of element types.
template <class... Element>
struct ElementList {};

/// Every element. The scene reader, the documentation and the property tests walk this list.
using Elements = ElementList<LinearTriangle, LinearTetrahedron, QuadraticTriangle, QuadraticTetrahedron,
                             QuadraticTriangleP0, QuadraticTetrahedronP0, BilinearQuadrilateral,
                             TrilinearHexahedron, BilinearQuadrilateralP0, TrilinearHexahedronP0>;

/// The largest number of nodes of an element in the list.
template <class... Element>
constexpr std::size_t most_nodes(ElementList<Element...>) {
  return std::max({static_cast<std::size_t>(Element::num_nodes)...});
}
/// Nodes of the largest element: what has a place for each node of any one cell has as many.
inline constexpr std::size_t max_element_nodes = most_nodes(Elements{});

/// All elements, in the order of the catalogue.
std::vector<const ElementInfo*> elements();

/// The element of this name in this dimension, or nullptr.
const ElementInfo* find_element(std::string_view name, int dim);

/// The element with these properties, or nullptr: of tetrahedra and triangles or not, the degree of its shape
/// functions, constant pressure per cell or none.
const ElementInfo* find_element(int dim, bool of_simplices, int degree, bool has_mean_volume);

/// The element of degree 1 whose nodes are the corners of this one.
const ElementInfo& corner_element(const ElementInfo& element);

/// The element of this name in this dimension; throws InputError(place, ...) that lists them when there is
/// none.
const ElementInfo& require_element(std::string_view name, int dim, const std::string& place);

}  // namespace resilin
