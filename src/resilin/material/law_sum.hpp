#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/material/law.hpp"

/// Sums of laws. A sum is a law: its energy is the sum of those of its parts, its constants are those of one
/// part after another, and so are its families of fibres, as many of each part as that can have. `find_law`
/// knows it by the names of the parts, joined by " + ". In a sum each modulus may be zero or left out.
namespace resilin {

/// A summand of a law; a law of the catalogue is its own.
struct LawPart {
  const LawInfo* law;
  std::size_t first_constant;  ///< its constants among those of the law
  std::size_t first_family;    ///< its families of fibres likewise
};

std::vector<LawPart> parts_of(const LawInfo& law);

/// How many of the families of fibres of a law the part has where `given` of them are given.
inline std::size_t num_own_families(const LawPart& part, std::size_t given) {
  const auto most = static_cast<std::size_t>(part.law->max_fibres);
  return given < part.first_family ? 0 : std::min(most, given - part.first_family);
}

constexpr std::size_t most_in_sum = 9;

inline bool is_sum(const LawInfo& law) { return !law.parts.empty(); }

/// "yeoh + exponential_fibre"
std::string sum_name(std::span<const std::string> laws);

/// "sum[1].c10": a constant of a part of a sum.
std::string sum_constant(std::size_t part, std::string_view constant);

/// The sum of these laws of the catalogue, which is made once and stays; null where one cannot be a part.
const LawInfo* find_sum(std::string_view name);

}  // namespace resilin
