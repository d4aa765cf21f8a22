#pragma once

#include <array>
#include <string_view>

/// Calls of the program ffmpeg, and what they need of it.
namespace resilin::cli {

/// A kind of film that ffmpeg writes.
struct Encoding {
  std::string_view extension, encoder;
};

inline constexpr std::array<Encoding, 4> encodings = {
    {{".gif", "gif"}, {".webp", "libwebp"}, {".mp4", "libx264"}, {".webm", "libvpx-vp9"}}};

inline constexpr std::string_view how_to_install_ffmpeg = "apt-get install ffmpeg";

}  // namespace resilin::cli
