#pragma once

#include <vector>

#include "resilin/fit/scene_experiment.hpp"
#include "resilin/scene/key.hpp"

namespace resilin {

/// Reads what was measured of one kind: a table of the file. Throws InputError.
MeasuredTable read_measurements(const SceneNode& node, MeasuredKind kind);

/// The pages of these tables.
std::vector<TableDoc> measurement_docs();

}  // namespace resilin
