#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "page_message.hpp"

namespace resilin::viewer {

/// Scene that the pages play with, as the simulation thread sees it. The formats are those of
/// docs/view_protocol.md.
class ServedScene {
 public:
  virtual ~ServedScene() = default;

  virtual nlohmann::json header() const = 0;  ///< "hello" without `client` and `state`
  virtual std::string topology() const = 0;   ///< binary
  virtual std::vector<std::string> field_names() const = 0;
  virtual nlohmann::json state() const = 0;   ///< "state" without `paused`, `grabbed_by`
  virtual nlohmann::json status() const = 0;  ///< "status" without `real_time_ratio`, `surface_ms`

  /// Does what a page says about the scene.
  /// @throws InputError  in one line; the scene is then as before
  virtual void apply(const SceneMessage& message) = 0;
  /// Writes the scene as it is on the page into a new file.
  /// @return one line that says where
  /// @throws InputError  in one line
  virtual std::string save() = 0;
  virtual bool is_grabbed() const = 0;
  virtual bool is_poking() const = 0;

  virtual double time() const = 0;       ///< simulated [s]
  virtual double time_step() const = 0;  ///< [s]
  virtual double speed() const = 0;      ///< simulated over real time
  virtual bool is_at_rest() const = 0;   ///< further steps change nothing
  /// One time step; no new iteration begins after `seconds`.
  virtual void step(double seconds) = 0;

  /// A frame.
  /// @param shown  indices into `field_names`
  /// @param blend  1: the present state; less: that much of the way to it from the state one step before
  virtual std::string frame(std::uint32_t number, std::uint32_t answered_drag, const FieldChoice& shown,
                            double blend) = 0;
};

}  // namespace resilin::viewer
