#include "resilin/picture/image.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {

Color mix(Color a, Color b, double t) {
  const auto channel = [t](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround((1 - t) * from + t * to));
  };
  return {channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue)};
}

Image see_through(const Image& on_black, const Image& on_white) {
  Image image = on_black;
  image.opacity.resize(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Color dark = on_black.pixels[i], bright = on_white.pixels[i];
    const int seen = (bright.red - dark.red + bright.green - dark.green + bright.blue - dark.blue) / 3;
    const int opacity = std::clamp(255 - seen, 0, 255);
    image.opacity[i] = static_cast<std::uint8_t>(opacity);
    if (opacity == 0) continue;
    const auto own = [opacity](std::uint8_t channel) {
      return static_cast<std::uint8_t>(std::min(255, (255 * channel + opacity / 2) / opacity));
    };
    image.pixels[i] = {own(dark.red), own(dark.green), own(dark.blue)};
  }
  return image;
}

std::vector<std::uint8_t> channels(const Image& image) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(static_cast<std::size_t>(num_channels(image)) * image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Color& color = image.pixels[i];
    bytes.insert(bytes.end(), {color.red, color.green, color.blue});
    if (!image.opacity.empty()) bytes.push_back(image.opacity[i]);
  }
  return bytes;
}

std::string encode_png(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = image.opacity.empty() ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, channels(image).data(), 0, nullptr) == 0)
    throw std::runtime_error(std::string("the picture cannot be encoded: ") + header.message);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const std::string extension = path.extension().string();
  if (extension != ".png" && extension != ".PNG")
    throw InputError(one_line(path.string()), "a name that ends in .png",
                     extension.empty() ? "none" : '"' + one_line(extension) + '"');
  const std::string bytes = encode_png(image);
  write_atomically(path, [&bytes](std::ostream& stream) { stream << bytes; });
}

}  // namespace resilin
