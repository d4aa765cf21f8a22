#pragma once

#include <string>
#include <string_view>

#include "resilin/element/element.hpp"

namespace resilin {

// Each plane element has a twin of axisymmetric solids (docs/theory/axisymmetry.md): x is the radius r, y the
// axis z. Its weights are those of the whole ring, and its states have the hoop strain u_r/R. The twins are
// no entries of `elements()`; `find_element` knows their names.

/// Name of the twin: "P2 axisymmetric".
std::string axisymmetric_name(std::string_view element);
/// The element's own name from that of its twin; others as they are.
std::string plane_name(std::string_view element);
bool has_axisymmetric_name(std::string_view element);

bool is_axisymmetric(const ElementInfo& element);
/// The twin of a plane element.
const ElementInfo& axisymmetric_element(const ElementInfo& plane);

}  // namespace resilin
