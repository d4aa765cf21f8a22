#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/view/frame_codec.hpp"

namespace resilin {

/// A zlib stream of the bytes.
std::string deflated(std::string_view stream);

/// One recorded state of what is drawn.
struct RecordedFrame {
  std::uint32_t number = 0;  ///< number of the frame in report.json
  std::uint32_t step = 0;
  double time = 0;                           ///< [s]
  double load = 0;                           ///< load factor
  std::vector<float> displacements{};        ///< 3 per vertex, from the rest places [m]
  std::vector<std::vector<float>> fields{};  ///< values of each field, 1 per vertex; nan where there is none
  std::vector<float> colliders{};            ///< where they are: see collider_places
};

/// Frames of a recording as differences (docs/view_protocol.md, "Recording"): each vertex moves about as one
/// of its neighbours does, so that what is left to say of it are small numbers, which deflate well.
///
/// Encoder and decoder go through the same states: a codec that has decoded some payloads goes on to encode
/// the same bytes as the one that wrote them.
class RecordingCodec {
 public:
  /// The steps that a field is recorded in.
  static constexpr int field_levels = 4095;

  /// @param num_fields     of each frame
  /// @param extent         of the scene: places are kept to about 1e-5 of it, or of 1/16,000 of what has
  ///                       moved where that is less [m]
  /// @param num_colliders  of each frame
  RecordingCodec(const ShownSurface& surface, std::size_t num_fields, double extent,
                 std::size_t num_colliders = 0);

  /// The payload of the next record. A place that is no number stays where it was.
  std::string encode(const RecordedFrame& frame);

  /// The next frame. @throws InputError  when `payload` is none of this recording
  RecordedFrame decode(std::string_view payload);

 private:
  double quantum_for(std::span<const float> displacements) const;
  std::size_t stream_size() const { return (12 + 2 * num_fields_) * parents_.size(); }

  std::size_t num_fields_, num_colliders_;
  double smallest_quantum_, largest_quantum_;
  double quantum_;                      ///< quantum of the last frame [m]
  std::vector<std::uint32_t> parents_;  ///< a neighbour with a lower number; itself where there is none
  std::vector<double>
      displacements_;  ///< as a reader of the records so far has them, [component][vertex] [m]
};

}  // namespace resilin
