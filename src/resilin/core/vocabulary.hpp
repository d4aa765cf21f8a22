#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// Words of other programs and of the literature for a key or a value, and what stands for it here.
struct ForeignWord {
  std::vector<std::string_view> words;   ///< small letters, "_" for blanks and hyphens
  std::vector<std::string_view> called;  ///< keys or values that mean it here; empty where nothing does
  std::string_view home;                 ///< where to find a value, for a place that has none of `called`
  std::string_view limit = {};           ///< words of docs/limits.md about a feature that is not available
  std::string_view advice = {};          ///< the cure, where no key stands for the word
};

/// Keys and values by their names in other programs, and everything that is asked for and not available.
std::span<const ForeignWord> vocabulary();

/// The cure of a word that is none of `known`: "it is called "half_space" here", or "not available
/// (docs/limits.md)". Empty for a word that the table does not have.
std::string foreign_word_cure(std::string_view word, std::span<const std::string> known = {});

/// As `did_you_mean`, and for the words of the table what they are here.
std::string cure_of_word(std::string_view word, std::span<const std::string> known);

/// As `refuse_word`, of a list of our own words, not of names that users give.
[[noreturn]] void refuse_own_word(const std::string& place, std::string_view word,
                                  std::span<const std::string> known);

}  // namespace resilin
