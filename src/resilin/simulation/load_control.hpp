#pragma once

#include "resilin/simulation/state.hpp"
#include "resilin/simulation/step.hpp"

namespace resilin {

/// One load step from `state`, as large as converges: the load increment of the state, halved until an
/// equilibrium is found. Moves the state there; leaves it alone when the report says anything but converged
/// (the load increment keeps what was learnt).
///
/// The search starts from the secant through the last two equilibria or from the last one, whichever has the
/// lower energy. After a quick success the next increment grows, up to the one that the scene asks for.
StepReport step_in_load(const World& world, Newton& newton, State& state, const NewtonObserver& observer);

}  // namespace resilin
