#pragma once

#include <string>
#include <vector>

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Unphysical results of converged steps, one line each: inverted elements, static forces that rounding
/// leaves unbalanced, bodies that overlap and did not at the start.
std::vector<std::string> oddities(const World& world, const State& state);

/// Cells of a body with J <= 0, or no number, at a quadrature point.
struct InvertedCells {
  Index count = 0;
  Index worst = -1;  ///< the cell with the least J ...
  double ratio = 1;  ///< ... which is this
};
InvertedCells inverted_cells(const Body& body, const VectorX& x);

/// Number over all bodies, in a state that was reached: one that shows a mode of vibration is drawn.
Index num_inverted_cells(const World& world, const State& state);

/// Cells with J > 0 at all quadrature points and J <= 0 elsewhere (jacobian_sign).
InvertedCells folded_cells(const Body& body, const World& world, const VectorX& x);

}  // namespace resilin
