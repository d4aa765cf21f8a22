#pragma once

#include "resilin/core/members.hpp"
#include "resilin/simulation/frame.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Part of the kinetic energy; strain energy below it is what the tolerance of the steps leaves, and
/// tells nothing.
constexpr double least_share_of_strain_energy = 1e-6;

/// Where a motion has had the most strain energy so far, restarts included: the state that tells how much the
/// size of the cells matters.
struct MostStrained {
  double energy = 0;    ///< [J]
  VectorX positions{};  ///< [m]; empty: nothing was strained

  void note(const Frame& frame, const State& state) {
    if (!(frame.elastic_energy > energy)) return;
    if (frame.elastic_energy < least_share_of_strain_energy * frame.kinetic_energy) return;
    energy = frame.elastic_energy;
    positions = state.positions;
  }
};
RESILIN_MEMBERS(MostStrained, energy, positions)

}  // namespace resilin
