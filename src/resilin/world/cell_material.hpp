#pragma once

#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// The law's constants in its order: one set, or one for each cell when some constant differs from cell to
/// cell.
std::vector<double> constants_of_cells(const LawInfo& law, const MaterialDescription& material,
                                       Index num_cells);

/// Unit directions of the fibres, once or for one cell after another, as ElasticEnergy takes them; turned
/// with the body by `rotation`.
FibreDirections fibres_of_cells(const LawInfo& law, const MaterialDescription& material,
                                const std::optional<Rotation>& rotation, Index num_cells);

/// The largest small-strain Poisson's ratio of sets of constants, from the tangent at rest (fibres are slack
/// there).
double largest_poissons_ratio(const LawInfo& law, const std::vector<double>& constants);

/// The turn of a body; the identity when there is none.
Eigen::Matrix3d rotation_matrix(const std::optional<Rotation>& rotation);

}  // namespace resilin
