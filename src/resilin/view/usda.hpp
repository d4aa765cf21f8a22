#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "resilin/view/shown_surface.hpp"

namespace resilin {

/// Writes a motion as USD text (.usda): for each body one mesh whose points move, its skin where it has one,
/// else the surface of its cells. For Blender, Houdini and whatever else reads USD.
///
/// The points of the frames wait in a file of their own, as floats, until `write` puts them together; a run
/// that goes on later finds them there.
class UsdaWriter {
 public:
  /// @param points_path  where the points wait; begun by `keep`
  /// @param world        kept by reference
  /// @param up           direction against gravity; the nearer of y and z becomes the stage's up axis
  UsdaWriter(std::filesystem::path points_path, const World& world, const Vector3& up);

  /// Keeps the first `count` frames of what the file holds, fewer when it holds fewer.
  void keep(std::size_t count);
  std::size_t num_frames() const { return num_frames_; }

  /// Appends a frame. @param time  [s]; of statics the number of the frame
  /// @throws FileError  when it cannot be written
  void record(const VectorX& positions, double time);

  /// The whole stage. @param codes_per_second  of the time codes: frames at k / codes_per_second have the
  /// code
  /// k
  void write(std::ostream& stream, const std::string& title, double codes_per_second) const;

  void remove_points() const;  ///< when there is nothing more to come

 private:
  std::size_t frame_size() const;

  std::filesystem::path path_;
  const World& world_;
  ShownSurface surface_;
  Vector3 up_;
  std::size_t num_frames_ = 0;
};

/// A name that USD takes: letters, digits and underscores, not beginning with a digit.
std::string usd_identifier(std::string_view name);

}  // namespace resilin
