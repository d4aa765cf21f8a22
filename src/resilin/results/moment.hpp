#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// For a state alone: "1.25 s"; at rest "load 0.667", and nothing at full load, where a run usually ends.
std::string words_of_moment(const World& world, const State& state);

/// For the frames of one run: "0.070 s", "12.5 ms"; at rest "load 0.667". All in as many digits, so that
/// nothing jumps in a film: those that err by a tenth of the time between frames at most.
class MomentsOfFrames {
 public:
  /// @param times [s], loads  of all frames that are known
  MomentsOfFrames(std::vector<double> times, std::vector<double> loads);

  /// Empty for a frame that is not known.
  std::string words(std::size_t frame) const;

 private:
  std::vector<double> times_, loads_;
  bool is_motion_ = false;
  double factor_ = 1;  ///< from seconds
  const char* unit_ = "s";
  int decimals_ = 3;
};

}  // namespace resilin
