#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/view/recording.hpp"
#include "resilin/view/usda.hpp"

namespace resilin {

/// The files of a result folder that are looked at without ParaView: `recording.bin` and `result.html`, one
/// page that needs no network, and `result.usda`. Frames are kept as they come; page and stage are made of
/// them by `finish`.
class ShownResults {
 public:
  /// A recording above this size is not put into a page, for browsers refuse such pages; `resilin view` shows
  /// the folder.
  static constexpr std::uintmax_t largest_embedded = std::uintmax_t{128} << 20;
  /// Vertices times frames up to which a page has every field with it, which takes about 2 MB then; larger
  /// ones have the recorded fields, and `resilin view` computes the others.
  static constexpr std::size_t most_values_of_a_field = 20000;

  /// Removes what an earlier run into the folder has left of formats that are not asked for.
  /// @param world  kept by reference
  ShownResults(std::filesystem::path folder, const World& world);

  /// Records the frame with this number of the report; frames with this and higher numbers are dropped first.
  void record(std::size_t number, const State& state);

  /// Makes result.html and result.usda.
  /// @param num_frames  of the report
  /// @param report      text of report.json
  /// @return  name and size of each file that was made [bytes]
  std::vector<std::pair<std::string, std::uintmax_t>> finish(std::size_t num_frames,
                                                             const std::string& report);

  /// Removes what a run that goes on would need: the checkpoint says that there is nothing left to do.
  void remove_leftovers();

 private:
  void keep(std::size_t num_frames);

  std::filesystem::path folder_;
  const World& world_;
  std::string title_;
  std::unique_ptr<Recorder> recorder_;  ///< null: no page is wanted
  std::unique_ptr<UsdaWriter> usda_;    ///< null: no stage is wanted
  double codes_per_second_ = 24;        ///< codes per second of the stage
  bool counts_frames_ = false;          ///< statics: the stage counts frames, not seconds
};

/// A state and its number among the frames of a report.
struct NumberedState {
  std::size_t number;
  const State* state;
};

/// The page result.html of some frames, their numbers rising; it has the fields of a recording.
/// @param folder  where the recording is made; it may be removed afterwards
/// @param report  text of report.json
std::string recorded_page(const std::filesystem::path& folder, const World& world,
                          std::span<const NumberedState> frames, std::string_view report);

/// A page with a recording and its report inside, and with fields beside those of the recording, as JSON
/// (docs/view_protocol.md, "Addresses").
/// @param more  scripts that the page has besides
std::string page_with_recording(std::string_view recording, std::string_view report,
                                std::string_view fields = "[]", std::string_view more = "");

/// The fields of such a page, where they are small together: those of the frames in a folder that its
/// recording does not hold.
std::string fields_beside_recording(const std::filesystem::path& folder, const World& world,
                                    std::size_t num_frames);

/// JSON in a script of a page: no "<" can end the script or begin a comment.
std::string escaped_for_page(std::string_view json);

/// The bytes in base64 (RFC 4648), without line ends.
std::string base64(std::string_view bytes);

}  // namespace resilin
