#pragma once

#include <filesystem>

#include "resilin/results/report.hpp"

namespace resilin {

/// What a run that goes on takes from the report of the run before.
struct SavedReport {
  Json frames = Json::array();  ///< each with a step, rising, a time and a load
  double total_seconds = 0;     ///< that the run had taken
};

/// Throws InputError naming the file, and the frame where one is to blame, for anything that is not a report.
SavedReport read_report(const std::filesystem::path& path);

}  // namespace resilin
