#pragma once

#include <iosfwd>

#include "resilin/sweep/sweep_folder.hpp"

namespace resilin {

/// The rows of a folder as a table in CSV (RFC 4180), a line for each scene that has been run, in their
/// order: scene, hash, the parameters, status, the quantities, steps, newton_iterations, unknowns, seconds,
/// kept, reason. Lists are written as in JSON; what is no number is an empty cell.
void write_csv(const SweepFolder& folder, std::ostream& stream);

}  // namespace resilin
