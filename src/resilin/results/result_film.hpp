#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "resilin/picture/picture.hpp"

namespace resilin {

/// A film of what a run has left: all its pictures from one place, with one range of colours.
struct FilmOptions {
  PictureOptions picture;
  int every = 1;  ///< takes each n-th frame
  int mode = 0;   ///< number of the vibration that swings; 0: the first that is not rigid
  std::optional<double> frames_per_second;  ///< default: of motion as time passes, else 10; vibrations 30
  double speed = 1;                         ///< simulated over shown time, of motion
  double turn = 0;                          ///< how far the camera goes around the scene meanwhile [degrees]
};

/// Frames of a film, and their rate.
struct FilmPlan {
  struct Shot {
    int frame;                ///< frame of the run
    double swing = 1;         ///< factor on its displacements
    double turned = 0;        ///< about up, from the first [rad]
    std::string moment = {};  ///< in words
  };
  std::vector<Shot> shots;
  double frames_per_second = 10;
  PictureOptions picture;  ///< with range, direction and what is to be seen set for all
  Vector3 toward = Vector3::UnitZ();
  std::filesystem::path folder;
};

/// Ends of the colours of a film. One blow may be many times what is seen all the rest of the time, and would
/// leave that all one colour: where the greatest value of all frames is more than twice that of nine frames
/// in ten, the bar ends there, pointed.
/// @param extremes  least and greatest value of each frame
std::array<double, 2> film_range(std::vector<std::array<double, 2>> extremes);

/// Looks through the frames of a run. `is_wanted` is asked now and then; what is not goes on no further.
/// @throws InputError  for a folder without frames, or options that cannot be
FilmPlan plan_film(const std::filesystem::path& folder, const FilmOptions& options,
                   const std::function<void(std::size_t done, std::size_t all)>& progress = {});

/// Draws one picture of the film, `shot` from 0.
Image draw_shot(const FilmPlan& plan, std::size_t shot);

}  // namespace resilin
