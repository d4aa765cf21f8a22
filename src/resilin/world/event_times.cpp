#include "resilin/world/event_times.hpp"

#include <algorithm>

namespace resilin {

bool follows_time(const Description& description) {
  const auto moves = [](const auto& entry) { return !entry.velocity.isZero(0); };
  const auto varies = [&](const auto& entry) { return moves(entry) || !entry.time_function.is_constant(); };
  const auto is_windowed = [](const LoadDescription& load) { return load.from > 0 || load.until; };
  return std::ranges::any_of(description.fixes, varies) || std::ranges::any_of(description.loads, varies) ||
         std::ranges::any_of(description.loads, is_windowed) ||
         std::ranges::any_of(description.colliders, moves);
}

std::vector<double> event_times(const Description& description) {
  std::vector<double> times;
  const auto add = [&times](const auto& entry) {
    const std::vector<double> kinks = entry.time_function.kinks();
    times.insert(times.end(), kinks.begin(), kinks.end());
    if (entry.until) times.push_back(*entry.until);
  };
  for (const FixDescription& fix : description.fixes) add(fix);
  for (const ColliderDescription& collider : description.colliders)
    if (collider.until) times.push_back(*collider.until);
  for (const LoadDescription& load : description.loads) {
    add(load);
    times.push_back(load.from);
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace resilin
