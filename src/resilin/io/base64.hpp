#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace resilin {

/// The bytes that a text of base64 (RFC 4648, section 4) stands for, blanks and line ends passed over: groups
/// of four digits until `most` bytes are there, the text ends or a digit is wrong. Padding ends a group, not
/// the text: some programs encode a header and the data behind it one after the other.
std::string decode_base64(std::string_view text, std::size_t most);

}  // namespace resilin
