#include "resilin/picture/animation.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {
namespace {

constexpr std::size_t signature_size = 8;

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}
std::string big_endian(std::uint16_t value) {
  return {static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::uint32_t read_big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// The data of all chunks of this name in a PNG file, one after another.
std::string chunks_of(std::string_view png, std::string_view name) {
  std::string data;
  for (std::size_t at = signature_size; at + 12 <= png.size();) {
    const std::size_t size = read_big_endian(png, at);
    if (png.substr(at + 4, 4) == name) data += png.substr(at + 8, size);
    at += 12 + size;
  }
  return data;
}

std::filesystem::path partial_of(std::filesystem::path path) {
  path += partial_ending;
  return path;
}

}  // namespace

ApngWriter::ApngWriter(std::filesystem::path path, int num_frames, double frames_per_second)
    : path_(std::move(path)),
      partial_(partial_of(path_)),
      num_frames_(num_frames),
      delay_(static_cast<std::uint16_t>(std::clamp(std::lround(1000 / frames_per_second), 10L, 60000L))),
      file_(std::make_unique<OutputFile>(partial_, OutputFile::Mode::truncate, path_)) {}

ApngWriter::~ApngWriter() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void ApngWriter::chunk(const char* name, const std::string& data) {
  const std::string body = name + data;
  const auto sum =
      static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size()));
  file_->stream() << big_endian(static_cast<std::uint32_t>(data.size())) << body << big_endian(sum);
}

void ApngWriter::add(const Image& image) {
  const std::string png = encode_png(image);
  if (num_added_ == 0) {
    width_ = image.width;
    height_ = image.height;
    file_->stream() << png.substr(0, signature_size);
    chunk("IHDR", chunks_of(png, "IHDR"));
    chunk("acTL", big_endian(static_cast<std::uint32_t>(num_frames_)) + big_endian(std::uint32_t{0}));
  } else if (image.width != width_ || image.height != height_) {
    throw InputError(one_line(path_.string()),
                     std::to_string(width_) + " x " + std::to_string(height_) + " pixels",
                     std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  const std::uint32_t at_corner = 0;
  chunk("fcTL", big_endian(sequence_++) + big_endian(static_cast<std::uint32_t>(width_)) +
                    big_endian(static_cast<std::uint32_t>(height_)) + big_endian(at_corner) +
                    big_endian(at_corner) + big_endian(delay_) + big_endian(std::uint16_t{1000}) +
                    std::string(2, '\0'));
  if (num_added_ == 0) {
    chunk("IDAT", chunks_of(png, "IDAT"));
  } else {
    const std::string number = big_endian(sequence_++);
    chunk("fdAT", number + chunks_of(png, "IDAT"));
  }
  ++num_added_;
}

void ApngWriter::finish() {
  if (num_added_ != num_frames_)
    throw InputError(one_line(path_.string()), std::to_string(num_frames_) + " frames",
                     std::to_string(num_added_));
  chunk("IEND", "");
  file_->close();
  file_.reset();
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw FileError(path_.string(), "cannot be written: " + reason_of_failed_write(error.value()));
}

}  // namespace resilin
