#pragma once

#include <string>
#include <string_view>

namespace resilin {

/// Tables and lists inside one another, as deep as a scene may go; a scene that means something needs eight.
inline constexpr int deepest_nesting = 64;

/// Throws InputError "NAME:LINE: ..." where a TOML text goes deeper: by brackets, by the parts of its headers
/// and dotted keys, or by all of them together. A parser that calls itself for each level would end the
/// process.
///
/// Texts that are no TOML pass, up to the depth that a parser meets before it sees that.
void refuse_deep_toml(std::string_view text, const std::string& name);

}  // namespace resilin
