#pragma once

#include <string>
#include <vector>

#include "resilin/fit/scene_experiment.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin {

/// The rows of a table by the names of its columns:
///
///   X, Y, Z     where a marker is at rest, or x, y, z where its displacement is told [m]
///   ux, uy, uz  its displacement, or x, y, z beside X, Y, Z: where it has gone [m]
///   fx, fy, fz  of a reaction or a section [N]; mx, my, mz its moment [N m]
///   energy, volume, stress
///   sigma       standard deviation of the row
///   load, time  which equilibrium at rest, or which instant of a motion
///   id          a number, passed over
///
/// Some measured components may be missing. Throws InputError at `place`.
/// @param file  as messages name it
std::vector<MeasuredRow> measured_rows(MeasuredKind kind, const NumberTable& table, int dim, bool is_dynamic,
                                       const std::string& file, const std::string& place);

}  // namespace resilin
