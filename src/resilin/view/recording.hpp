#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "resilin/view/header.hpp"
#include "resilin/view/recording_codec.hpp"
#include "resilin/view/surface_fields.hpp"

namespace resilin {

/// The fields that the recordings of a world hold besides the displacement: three that are always there, and
/// those that its output asks for.
std::vector<ScalarField> recorded_fields(const World& world);

/// Writes recording.bin, frame by frame: a file that is cut off at any byte holds all frames before
/// (docs/view_protocol.md, "Recording").
class Recorder {
 public:
  /// Begins the file, or goes on with one of the same scene; `num_frames() == 0` until `keep`.
  /// @param world   kept by reference
  /// @param header  its fields become those of `recorded_fields`
  Recorder(std::filesystem::path path, const World& world, ViewHeader header);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Goes on after the frames with numbers below `end` that the file holds; those behind them, and what is
  /// left of a torn one, are cut off. Zero begins anew, as does a file of another scene.
  void keep(std::uint32_t end);

  /// Appends a frame. @throws FileError  when it cannot be written
  void record(std::uint32_t number, const State& state);

  std::uint32_t next_number() const { return next_number_; }  ///< one more than that of the last frame

 private:
  void begin();
  RecordingCodec new_codec() const;
  void append(std::string_view bytes);

  std::filesystem::path path_;
  const World& world_;
  ShownSurface surface_;
  std::vector<ShownCollider> colliders_;
  std::vector<ScalarField> recorded_;
  SurfaceFields fields_;
  FieldEvaluator evaluator_;
  std::string header_;
  RecordingCodec codec_;
  std::uint32_t next_number_ = 0;
};

/// A recording as it comes out of a file.
struct Recording {
  std::string header;    ///< JSON
  std::string topology;  ///< see decode_topology in the page
  struct Record {
    std::size_t begin;         ///< begin of its payload, in the file
    std::string_view payload;  ///< into the bytes that were read
  };
  std::vector<Record> records;  ///< whole ones with the right check sum, up to the first that is not
  std::size_t end = 0;          ///< end of the last whole record, in the file
};

/// Takes the bytes of a file apart; `bytes` must outlive the result.
/// @throws InputError naming `place` when it has no whole header and topology
Recording parse_recording(std::string_view bytes, const std::string& place);

}  // namespace resilin
