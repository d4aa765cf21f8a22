#pragma once

#include <cstddef>
#include <cstdint>

/// Points of the unit cube by their number: any of them at once, in memory that does not grow with their
/// count.
namespace resilin {

/// Where `i` goes in a random permutation of [0, count) that `key` chooses.
///
/// A network of Feistel's on the least even number of bits that hold `count`, walked until it leads back into
/// the range (Black & Rogaway 2002, "cycle walking").
std::uint64_t permuted(std::uint64_t i, std::uint64_t count, std::uint64_t key);

/// Coordinate `dimension` of point `i` of a Latin hypercube of `count` points, in [0, 1): each of `count`
/// equal slices of each coordinate holds one point, at a random place in it.
///
/// Source: McKay, Beckman & Conover 1979.
double latin_hypercube(std::uint64_t i, std::size_t dimension, std::uint64_t count, std::uint64_t seed);

/// So many coordinates the sequence of Sobol' has here, and so many points.
inline constexpr std::size_t most_sobol_dimensions = 32;
inline constexpr std::uint64_t most_sobol_points = std::uint64_t{1} << 32;

/// Coordinate `dimension` of point `i` of the sequence of Sobol', in [0, 1), in the order of Antonov and
/// Saleev; point 0 is the origin.
///
/// Direction numbers: Joe & Kuo 2008 (new-joe-kuo-6.21201).
double sobol(std::uint64_t i, std::size_t dimension);

/// The same, all points shifted by one random point (digit by digit, in base 2), which keeps how evenly they
/// fill the cube and takes them off its corners. Source: Cranley & Patterson 1976, L'Ecuyer & Lemieux 2002.
double shifted_sobol(std::uint64_t i, std::size_t dimension, std::uint64_t seed);

}  // namespace resilin
