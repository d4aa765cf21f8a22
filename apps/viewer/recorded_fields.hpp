#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace resilin::viewer {

/// Every field of the frames of a run, computed for the page when it asks: docs/view_protocol.md, "Fields on
/// demand". Used by one thread at a time.
class RecordedFields {
 public:
  explicit RecordedFields(std::filesystem::path folder);
  ~RecordedFields();
  RecordedFields(const RecordedFields&) = delete;
  RecordedFields& operator=(const RecordedFields&) = delete;

  /// Lists the available fields as JSON; an empty list for a run without its scene or frames.
  std::string list();

  /// One field in all frames, as bytes.
  /// @param is_wanted  asked before each frame; the answer is cut short once it says no
  /// @throws InputError  when there is no such field, or what the run has left does not go together
  std::string values(std::string_view name, const std::function<bool()>& is_wanted);

 private:
  struct Run;
  Run* run();

  std::filesystem::path folder_;
  std::unique_ptr<Run> run_;  ///< made when it is first asked for
};

}  // namespace resilin::viewer
