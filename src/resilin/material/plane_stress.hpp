#pragma once

#include <string>
#include <string_view>

#include "resilin/material/batch.hpp"
#include "resilin/material/law.hpp"

/// Laws in plane stress. Each law of the catalogue has a twin of two dimensions, which `find_law` knows by
/// `plane_stress_name` and `laws` does not list: its Psi is the least over the thickness, where P33 = 0. In
/// three dimensions a twin is the law itself, so that a batch or a material of dim = 3 means the solid.
namespace resilin {

/// "neo_hookean in plane stress"
std::string plane_stress_name(std::string_view law);

/// Whether the constitutive model is the plane-stress twin of another one.
bool is_plane_stress(const LawInfo& law);

/// The law of which this one is the twin, or itself.
const LawInfo& solid_law(const LawInfo& law);

/// F33 - 1 of states in the plane, dim = 2, of a law in plane stress; not a number where there is none.
void thickness_strains(const StateBatch<double>& states, double* strains);

}  // namespace resilin
