#pragma once

#include <filesystem>
#include <string_view>

#include "resilin/results/report.hpp"

namespace resilin {

/// Data that a restart takes from the earlier report.
struct SavedReport {
  Json frames = Json::array();  ///< each with a step, rising, a time and a load
  double total_seconds = 0;     ///< run time so far [s]
};

/// Throws InputError naming the file, and the frame where one is to blame, for anything that is not a report.
SavedReport read_report(const std::filesystem::path& path);

/// The reason of a report that was written while the run went on.
inline constexpr std::string_view running_reason = "the run had not ended when this was written";
/// Says in such a report that an error has ended the run, in its own bytes: also where no new ones can be
/// written, as on a full disk.
void mark_as_failed(const std::filesystem::path& path) noexcept;

}  // namespace resilin
