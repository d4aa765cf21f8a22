#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/sweep/sweep.hpp"

namespace resilin {

/// Final status of a scene of a sweep. All but `done` count as failed.
enum class SceneStatus {
  done,
  not_converged,  ///< the quantities are those of the last converged step
  refused,        ///< the scene is wrong
  failed          ///< memory ran out, a worker died or the program has an error
};
constexpr std::array<std::string_view, 4> spellings(SceneStatus) {
  return {"done", "not_converged", "refused", "failed"};
}

/// Record of a finished scene.
struct SceneRow {
  SceneHash hash;
  std::uint64_t scene = 0;  ///< its number
  SceneStatus status = SceneStatus::done;
  std::string reason;
  std::vector<std::vector<double>> quantities;  ///< as QuantityRecorder has them; empty where nothing was run
  int steps = 0;
  int newton_iterations = 0;
  std::int64_t unknowns = 0;
  double seconds = 0;
  bool is_kept = false;  ///< its folder of results
};

/// One line, which ends with "\n". It begins with the hash and the status, so that both are found without
/// reading the rest.
std::string row_line(const SceneRow& row, const Sweep& sweep);

/// Hash and status of such a line; false for one that is not whole.
bool read_row_head(std::string_view line, SceneHash& hash, SceneStatus& status);

/// A line of a scene that could not be run, such as one whose worker died.
SceneRow failed_row(const Sweep& sweep, std::uint64_t scene, SceneStatus status, const std::string& reason);

}  // namespace resilin
