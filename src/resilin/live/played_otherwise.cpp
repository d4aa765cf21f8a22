#include "resilin/live/played_otherwise.hpp"

#include <algorithm>

#include "resilin/core/text.hpp"
#include "resilin/live/live_controls.hpp"
#include "resilin/world/event_times.hpp"

namespace resilin {

std::vector<std::string> played_otherwise(const Description& scene) {
  if (!scene.is_dynamic)
    return {follows_time(scene) ? "a static run continues dynamically; its loads continue along their path"
                                : "a static run continues dynamically, at the load factor of the frame"};
  std::vector<std::string> lines;
  const std::string steps = "backward Euler's steps of " + format_short(scene.time_step) + " s";
  if (scene.adaptive)
    lines.push_back(steps + " in place of adaptive ones of " + scene.integrator);
  else if (scene.integrator != "backward_euler")
    lines.push_back(steps + " in place of those of " + scene.integrator);
  if (std::ranges::any_of(scene.bodies,
                          [](const BodyDescription& body) { return body.mass == MassKind::consistent; }))
    lines.emplace_back("masses are lumped, not consistent");
  const double damping = scene.bodies.front().damping.mass;
  if (std::ranges::any_of(scene.bodies,
                          [damping](const BodyDescription& body) { return body.damping.mass != damping; }))
    lines.emplace_back("all bodies have the mass damping of the first");
  return lines;
}

}  // namespace resilin
