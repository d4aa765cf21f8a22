#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace resilin {

/// How a number is kept in a binary file.
struct BinaryType {
  std::size_t size;  ///< bytes: 1, 2, 4 or 8
  bool is_real;      ///< for 4 or 8 bytes
  bool is_signed;
};

inline constexpr BinaryType binary_float32{4, true, true};
inline constexpr BinaryType binary_uint32{4, false, false};

/// One number of `type.size` bytes; integers beyond 2^53 lose digits, which no index that is right has.
inline double decoded(std::string_view bytes, const BinaryType& type, std::endian order) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < type.size; ++i) {
    const char c = bytes[order == std::endian::big ? i : type.size - 1 - i];
    bits = bits << 8 | static_cast<unsigned char>(c);
  }
  if (type.is_real && type.size == 8) return std::bit_cast<double>(bits);
  if (type.is_real) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  if (!type.is_signed) return static_cast<double>(bits);
  const auto shift = static_cast<int>(64 - 8 * type.size);
  return static_cast<double>(std::bit_cast<std::int64_t>(bits << shift) >> shift);
}

}  // namespace resilin
