#pragma once

#include <vector>

#include "scenes.hpp"

namespace resilin::bench {

/// Cost of derivatives of runs beside the runs, processor time: the height of one corner by Young's modulus
/// of each cell. At rest the bar with n cells across by a direct solver and by multigrid, and with four kinds
/// of parameters more; in motion the cube with n cells along an edge and the bar with 9 across.
std::vector<Measurement> measure_gradients(int n, bool is_dynamic);

}  // namespace resilin::bench
