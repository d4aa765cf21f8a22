#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "resilin/core/output_file.hpp"
#include "resilin/picture/image.hpp"

namespace resilin {

/// Writes pictures of one size as an animated PNG, which browsers, GitHub and most viewers play, frame by
/// frame: no more than one picture is in memory. Beside and renamed by `finish`; what is not finished leaves
/// nothing.
///
/// Source: W3C, Portable Network Graphics (third edition) 2025, 11.3.4 (acTL, fcTL, fdAT).
class ApngWriter {
 public:
  /// @param frames_per_second  above 0
  ApngWriter(std::filesystem::path path, int num_frames, double frames_per_second);
  ~ApngWriter();
  ApngWriter(const ApngWriter&) = delete;
  ApngWriter& operator=(const ApngWriter&) = delete;

  /// @throws InputError  for a picture of another size than the first
  void add(const Image& image);
  /// @throws InputError  when other than the promised number of pictures were added
  void finish();

 private:
  void chunk(const char* name, const std::string& data);

  std::filesystem::path path_, partial_;
  int num_frames_, num_added_ = 0, width_ = 0, height_ = 0;
  std::uint32_t sequence_ = 0;  ///< sequence of fcTL and fdAT
  std::uint16_t delay_;         ///< delay of a frame [1/1000 s]
  std::unique_ptr<OutputFile> file_;
};

}  // namespace resilin
