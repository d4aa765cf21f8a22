#pragma once

#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// A bar of 4 x 1 (x 1) m, clamped at x = 0, under its own weight: what solvers are tested and timed on.
struct BarOptions {
  int dim = 3;
  int cells_per_height = 4;     ///< cubes (squares) along the short edges, each cut into dim! simplices
  double youngs_modulus = 1e6;  ///< [Pa]
  double poissons_ratio = 0.4;
  double density = 1000;  ///< [kg/m^3]
  double time_step = 0;   ///< [s]; above 0 lumped mass / time_step^2 is added
};

struct BarProblem {
  BlockMatrix matrix;      ///< small-strain stiffness [N/m], the clamped unknowns eliminated
  VectorX right_side;      ///< weight [N], zero at the clamp
  VectorX node_positions;  ///< [m]
  std::vector<std::uint8_t> is_fixed;
};

/// Linear triangles or tetrahedra along the paths from corner to corner of every cube (Kuhn).
BarProblem make_bar_problem(const BarOptions& options);

}  // namespace resilin
