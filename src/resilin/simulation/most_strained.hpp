#pragma once

#include <limits>

#include "resilin/core/members.hpp"
#include "resilin/simulation/frame.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Part of the kinetic energy; strain energy below it is what the tolerance of the steps leaves, and
/// tells nothing.
constexpr double least_share_of_strain_energy = 1e-6;

/// The least volume ratio J that a cell has had at the end of a step so far, and where; restarts included.
struct SmallestVolume {
  double ratio = std::numeric_limits<double>::infinity();
  int body = 0;
  Index cell = -1;  ///< in its body
  int step = 0;
  double time = 0, load = 0;

  void note(const Frame& frame) {
    if (!(frame.min_volume_ratio < ratio)) return;
    *this = {.ratio = frame.min_volume_ratio,
             .body = frame.worst_body,
             .cell = frame.worst_cell,
             .step = frame.step,
             .time = frame.time,
             .load = frame.load};
  }
};
RESILIN_MEMBERS(SmallestVolume, ratio, body, cell, step, time, load)

/// Where a motion has had the most strain energy so far, restarts included: the state that tells how much the
/// size of the cells matters.
struct MostStrained {
  double energy = 0;                 ///< [J]
  VectorX positions{};               ///< [m]; empty: nothing was strained
  SmallestVolume smallest_volume{};  ///< in statics, too

  void note(const Frame& frame, const State& state) {
    if (!(frame.elastic_energy > energy)) return;
    if (frame.elastic_energy < least_share_of_strain_energy * frame.kinetic_energy) return;
    energy = frame.elastic_energy;
    positions = state.positions;
  }
};
RESILIN_MEMBERS(MostStrained, energy, positions, smallest_volume)

}  // namespace resilin
