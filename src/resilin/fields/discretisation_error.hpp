#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// How far off a body's displacements are because its cells are of finite size, as a share of them: about 1 -
/// |u_h| / |u|, where they follow from loads; where they are prescribed, the share of the forces.
///
///   eta^2 = int |T* - T|^2 dV / int |T|^2 dV
///
/// T is the stress of the element, turned back with the material, T* a smoother one recovered from it
/// (PatchRecovery), | | the norm of the complementary energy of the small-strain solid. An estimate, no
/// bound. Theory: docs/theory/discretisation.md. Source: Zienkiewicz & Zhu 1987, 1992.
/// @param positions  of all nodes of the world, in equilibrium or in motion [m]
/// @return           nothing for a body that is not strained, or of too few cells to tell
std::optional<double> discretisation_error(const World& world, const Body& body, const VectorX& positions);

/// In place of an estimate that would be wrong with confidence.
constexpr double cannot_tell = std::numeric_limits<double>::infinity();

/// Most of the body's volume is in cells without a vertex inside the body: a strip, a plate or a bar of one
/// layer.
bool is_one_cell_across(const Body& body);

/// The estimate by recovered stress, but `cannot_tell` for a strained body that is one cell across: recovered
/// stress does not see what such cells cannot represent.
std::optional<double> error_by_recovered_stress(const World& world, const Body& body,
                                                const VectorX& positions);

/// The kinds of estimate.
enum class ErrorEstimate {
  richer_space,     ///< a step into a richer space, which sees what the cells cannot represent
  recovered_stress  ///< differences of stresses alone: it may tell many times too little of mixed elements
};
/// Its name in report.json.
std::string_view name(ErrorEstimate estimate);

/// Estimated discretisation error of a body, relative to its solution.
struct DiscretisationError {
  double share = 0;  ///< share of the displacements or forces, or `cannot_tell`
  ErrorEstimate estimate = ErrorEstimate::recovered_stress;

  bool operator==(const DiscretisationError&) const = default;
};

/// The error of each body of the world; empty where there is no estimate.
using DiscretisationErrors = std::vector<std::optional<DiscretisationError>>;
/// Errors by recovered stress.
DiscretisationErrors discretisation_errors(const World& world, const VectorX& positions);

/// int |T|^2 dV [J], the norm above of the solution: twice the strain energy where strains are small, and for
/// mixed elements in general. Nothing for a body that is not strained.
std::optional<double> squared_solution_norm(const Body& body, const VectorX& positions);

/// The share by which a solution is off whose squared norm a richer space changes by `gain` of itself; a
/// mixed element may be too soft, and `gain` negative. Loads find displacements that are off by a share of
/// the exact ones. Prescribed displacements find forces that are off by a share of those found.
double share_missing(double gain, bool is_driven_by_displacements);

/// The estimate above which a body's cells are called too coarse: what is told as 3 % may be 5 % or more.
constexpr double large_discretisation_error = 0.03;

/// One line for each body whose cells are too coarse: how far off it may be, and what to choose. In statics
/// also one for each body of mixed elements where the richer space has failed.
std::vector<std::string> coarseness_texts(const World& world, const DiscretisationErrors& errors);

/// "13 %", "0.3 %"; "unknown: one cell across".
std::string share_text(double share);

}  // namespace resilin
