#include "resilin/core/hash.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

namespace resilin {
namespace {

TEST(Hash, ChangesWithEveryByteEveryLengthAndTheSeed) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 40; ++size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::uint64_t hash = hash_of(bytes);
    EXPECT_EQ(hash_of(std::string(bytes)), hash);
    EXPECT_NE(hash_of(bytes, 1), hash);
    EXPECT_NE(hash_of(bytes + '\0'), hash);
    for (std::size_t at = 0; at < size; ++at) {
      for (int change = 1; change < 256; ++change) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(change));
        ASSERT_NE(hash_of(changed), hash) << size << " " << at << " " << change;
      }
    }
  }
}

TEST(Hash, TellsManyShortTextsApart) {
  std::set<std::uint64_t> hashes;
  for (int i = 0; i < 100000; ++i) hashes.insert(hash_of(std::to_string(i)));
  EXPECT_EQ(hashes.size(), 100000u);
}

}  // namespace
}  // namespace resilin
