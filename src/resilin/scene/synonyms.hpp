#pragma once

#include <span>
#include <string>
#include <string_view>

namespace resilin {

/// The known key for a word of other programs and of the literature: "dirichlet" and "bc" are `fix`, "mu" is
/// `friction`. Upper and lower case are the same. Empty without one among `known`.
std::string key_for_synonym(std::string_view word, std::span<const std::string> known);

}  // namespace resilin
