#include "resilin/sweep/sampling.hpp"

#include <array>
#include <bit>

namespace resilin {
namespace {

/// Bits that look random, of a number: the finaliser of SplitMix64 (Steele, Lea & Flood 2014).
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

std::uint64_t scrambled(std::uint64_t a, std::uint64_t b, std::uint64_t c = 0) {
  return scrambled(scrambled(scrambled(a) ^ b) ^ c);
}

/// In [0, 1), of the upper bits.
double unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// A primitive polynomial over two elements, its coefficients as bits, and the first direction numbers.
struct Direction {
  std::uint32_t polynomial;
  std::array<std::uint32_t, 7> first;
};

constexpr std::array<Direction, most_sobol_dimensions> directions = {{
    {1, {1}},
    {3, {1}},
    {7, {1, 3}},
    {11, {1, 3, 1}},
    {13, {1, 1, 1}},
    {19, {1, 1, 3, 3}},
    {25, {1, 3, 5, 13}},
    {37, {1, 1, 5, 5, 17}},
    {41, {1, 1, 5, 5, 5}},
    {47, {1, 1, 7, 11, 19}},
    {55, {1, 1, 5, 1, 1}},
    {59, {1, 1, 1, 3, 11}},
    {61, {1, 3, 5, 5, 31}},
    {67, {1, 3, 3, 9, 7, 49}},
    {91, {1, 1, 1, 15, 21, 21}},
    {97, {1, 3, 1, 13, 27, 49}},
    {103, {1, 1, 1, 15, 7, 5}},
    {109, {1, 3, 1, 15, 13, 25}},
    {115, {1, 1, 5, 5, 19, 61}},
    {131, {1, 3, 7, 11, 23, 15, 103}},
    {137, {1, 3, 7, 13, 13, 15, 69}},
    {143, {1, 1, 3, 13, 7, 35, 63}},
    {145, {1, 3, 5, 9, 1, 25, 53}},
    {157, {1, 3, 1, 13, 9, 35, 107}},
    {167, {1, 3, 1, 5, 27, 61, 31}},
    {171, {1, 1, 5, 11, 19, 41, 61}},
    {185, {1, 3, 5, 3, 3, 13, 69}},
    {191, {1, 1, 7, 13, 1, 19, 1}},
    {193, {1, 3, 7, 5, 13, 19, 59}},
    {203, {1, 1, 3, 9, 25, 29, 41}},
    {211, {1, 3, 5, 13, 23, 1, 55}},
    {213, {1, 3, 7, 3, 13, 59, 17}},
}};

using DirectionBits = std::array<std::uint32_t, 32>;

/// v_k = m_k / 2^k as bits from the top, with the recurrence of Joe & Kuo 2008, eq. 2 and 3:
/// m_k = 2 a_1 m_(k-1) xor ... xor 2^(s-1) a_(s-1) m_(k-s+1) xor 2^s m_(k-s) xor m_(k-s).
constexpr DirectionBits direction_bits(const Direction& direction) {
  DirectionBits v{};
  const int s = static_cast<int>(std::bit_width(direction.polynomial)) - 1;
  for (int k = 0; k < 32; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (s == 0) {
      v[at] = std::uint32_t{1} << (31 - k);
    } else if (k < s) {
      v[at] = direction.first[at] << (31 - k);
    } else {
      const std::uint32_t last = v[static_cast<std::size_t>(k - s)];
      v[at] = last ^ (last >> s);
      for (int i = 1; i < s; ++i)
        if (((direction.polynomial >> (s - i)) & 1) != 0) v[at] ^= v[static_cast<std::size_t>(k - i)];
    }
  }
  return v;
}

constexpr auto all_direction_bits = [] {
  std::array<DirectionBits, most_sobol_dimensions> all{};
  for (std::size_t d = 0; d < directions.size(); ++d) all[d] = direction_bits(directions[d]);
  return all;
}();

std::uint32_t sobol_bits(std::uint64_t i, std::size_t dimension) {
  std::uint32_t bits = 0;
  std::uint64_t gray = i ^ (i >> 1);
  for (std::size_t k = 0; gray != 0; ++k, gray >>= 1)
    if ((gray & 1) != 0) bits ^= all_direction_bits[dimension][k];
  return bits;
}

}  // namespace

std::uint64_t permuted(std::uint64_t i, std::uint64_t count, std::uint64_t key) {
  if (count < 2) return i;
  const int half = static_cast<int>(std::bit_width(count - 1) + 1) / 2;
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  do {
    std::uint64_t left = i >> half, right = i & mask;
    for (std::uint64_t round = 0; round < 6; ++round) {
      const std::uint64_t mixed = left ^ (scrambled(key, round, right) & mask);
      left = right;
      right = mixed;
    }
    i = left << half | right;
  } while (i >= count);
  return i;
}

double latin_hypercube(std::uint64_t i, std::size_t dimension, std::uint64_t count, std::uint64_t seed) {
  const std::uint64_t key = scrambled(seed, dimension);
  const double place = static_cast<double>(permuted(i, count, key)) + unit(scrambled(key, i, 1));
  const double x = place / static_cast<double>(count);
  return x < 1 ? x : 1 - 0x1p-53;  // the sum may have been rounded up
}

double sobol(std::uint64_t i, std::size_t dimension) {
  return static_cast<double>(sobol_bits(i, dimension)) * 0x1p-32;
}

double shifted_sobol(std::uint64_t i, std::size_t dimension, std::uint64_t seed) {
  // The digits below those of the sequence are random and the same for all points.
  const std::uint64_t bits = std::uint64_t{sobol_bits(i, dimension)} << 32;
  return unit(bits ^ scrambled(seed, dimension, 2));
}

}  // namespace resilin
