#include "resilin/picture/animation.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

struct Chunk {
  std::string name, data;
};

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// The chunks of a PNG file, whose check sums are right.
std::vector<Chunk> chunks_of(const std::string& bytes) {
  std::vector<Chunk> chunks;
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t size = number_at(bytes, at);
    const std::string body = bytes.substr(at + 4, 4 + size);
    const auto sum =
        static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size()));
    EXPECT_EQ(number_at(bytes, at + 8 + size), sum);
    chunks.push_back({body.substr(0, 4), body.substr(4)});
    at += 12 + size;
  }
  return chunks;
}

/// Rows of pixels without their filters: pictures here are of one colour, and all filters but the first row's
/// differences vanish, so that the sum of bytes tells them apart.
std::string inflated(const std::string& stream, std::size_t expected) {
  std::string bytes(expected, '\0');
  auto size = static_cast<uLongf>(expected);
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(stream.data()), static_cast<uLong>(stream.size())),
            Z_OK);
  EXPECT_EQ(size, expected);
  return bytes;
}

Image plain(Color color) { return {.width = 5, .height = 4, .pixels = std::vector<Color>(20, color)}; }

TEST(AnimatedPng, HoldsEveryFrameInTurn) {
  const TemporaryFolder folder;
  const std::vector<Color> colors = {{255, 0, 0}, {0, 255, 0}, {10, 20, 30}};
  ApngWriter writer(folder / "film.png", 3, 25);
  for (const Color& color : colors) writer.add(plain(color));
  EXPECT_FALSE(exists(folder / "film.png")) << "not before it is whole";
  writer.finish();
  const std::string bytes = folder.read("film.png");
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  const std::vector<Chunk> chunks = chunks_of(bytes);
  std::string order;
  std::uint32_t sequence = 0;
  std::size_t frame = 0;
  for (const auto& [name, data] : chunks) {
    order += name + " ";
    if (name == "acTL") {
      EXPECT_EQ(number_at(data, 0), 3u);
      EXPECT_EQ(number_at(data, 4), 0u) << "plays for ever";
    }
    if (name == "fcTL") {
      EXPECT_EQ(number_at(data, 0), sequence++);
      EXPECT_EQ(number_at(data, 4), 5u);
      EXPECT_EQ(number_at(data, 8), 4u);
      EXPECT_EQ(number_at(data, 20) >> 16, 40u) << "milliseconds";
    }
    if (name == "fdAT") {
      EXPECT_EQ(number_at(data, 0), sequence++);
    }
    if (name == "IDAT" || name == "fdAT") {
      const std::string rows = inflated(name == "IDAT" ? data : data.substr(4), 4 * (1 + 3 * 5));
      // The first pixel of the first row is filtered by nothing before it.
      EXPECT_EQ(static_cast<unsigned char>(rows[1]), colors[frame].red);
      EXPECT_EQ(static_cast<unsigned char>(rows[2]), colors[frame].green);
      EXPECT_EQ(static_cast<unsigned char>(rows[3]), colors[frame].blue);
      ++frame;
    }
  }
  EXPECT_EQ(order, "IHDR acTL fcTL IDAT fcTL fdAT fcTL fdAT IEND ");
}

TEST(AnimatedPng, LeavesNothingWhenItIsNotFinished) {
  const TemporaryFolder folder;
  {
    ApngWriter writer(folder / "film.png", 2, 10);
    writer.add(plain({1, 2, 3}));
    EXPECT_THROW(writer.add({.width = 4, .height = 4, .pixels = std::vector<Color>(16)}), InputError);
    EXPECT_THROW(writer.finish(), InputError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace resilin::testing
