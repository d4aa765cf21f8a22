#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A colour of 8 bits per channel.
struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// The mix of two colours: `a` for t = 0, `b` for t = 1.
Color mix(Color a, Color b, double t);

/// Pixels row by row, from the top left corner.
struct Image {
  int width = 0, height = 0;
  std::vector<Color> pixels;
  std::vector<std::uint8_t> opacity =
      {};  ///< opacity of each pixel, 0 to 255; empty: nothing is seen through
  /// From where what was drawn, for pictures that are to match.
  struct View {
    Vector3 toward = Vector3::UnitZ(), up = Vector3::UnitY();
    Vector3 low = Vector3::Zero(), high = Vector3::Zero();  ///< corners of the box of what is seen [m]
    std::array<double, 2> extremes{};                       ///< extremes of the field
  };
  View view = {};
  std::string legend = {};  ///< text about the colours: "von Mises stress, averaged [kPa]: min 0.6   max 8.6"

  Color& at(int x, int y) { return pixels[offset(x, y)]; }
  const Color& at(int x, int y) const { return pixels[offset(x, y)]; }

 private:
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// From the same picture on black and on white: what differs is how far one sees through.
Image see_through(const Image& on_black, const Image& on_white);

/// 3, or 4 where there is an opacity.
inline int num_channels(const Image& image) { return image.opacity.empty() ? 3 : 4; }

/// Red, green, blue and, where there is one, the opacity of one pixel after the other.
std::vector<std::uint8_t> channels(const Image& image);

/// The bytes of a PNG file: the same for the same image.
std::string encode_png(const Image& image);

/// Beside and renamed. Throws FileError when the file cannot be written, InputError for another extension
/// than .png, which would not be what the file holds.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace resilin
