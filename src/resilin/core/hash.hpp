#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace resilin {

/// A number by which equal bytes are known again: to notice damage and change, not to withstand malice.
/// Bytes that differ in one place only never share it.
///
/// The mixing of Fowler, Noll and Vo (FNV-1a), eight bytes at a time.
inline std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed = 14695981039346656037ULL) {
  constexpr std::uint64_t prime = 1099511628211ULL;
  std::uint64_t hash = seed ^ bytes.size();
  const auto mix = [&hash](std::uint64_t word) {
    hash = (hash ^ word) * prime;
    hash ^= hash >> 32;
  };
  for (; bytes.size() >= sizeof(std::uint64_t); bytes.remove_prefix(sizeof(std::uint64_t))) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), sizeof(word));
    mix(word);
  }
  for (const char byte : bytes) mix(static_cast<unsigned char>(byte));
  return hash;
}

}  // namespace resilin
